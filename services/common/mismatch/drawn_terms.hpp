// What is drawn and said of where each law acts.
#pragma once

#include "sealwatch/mismatch/explanation.hpp"
#include "services/common/mismatch/refits.hpp"

namespace sealwatch::mismatch {

/// Into `result`: the missing term of each effect of `best` (without the law where `result` claims none), over the
/// recording in which its law can be read best, as it is largest in means over short times (all its windows), and the
/// regime of each found effect. `whole`: `data` are recordings, not windows of them.
void draw_missing_terms(const FittedModel& baseline, const Trial& best, const Data& data, bool whole,
                        Explanation& result);

}  // namespace sealwatch::mismatch
