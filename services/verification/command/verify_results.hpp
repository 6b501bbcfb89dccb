// What `sealwatch verify` writes: results.json (schema sealwatch.verification/1), report.html, and a table for people.
#pragma once

#include <string>

#include "services/verification/lives/life_store.hpp"
#include "services/verification/lives/summary.hpp"

namespace sealwatch::cli {

/// No time, no thread and no folder in it: the same lives give the same text.
[[nodiscard]] std::string verification_json(const verification::LifeCollection& lives,
                                            const verification::Summary& summary);
/// Self-contained; reads the lives that it draws again. Depends on the lives alone too.
[[nodiscard]] Result<std::string> verification_page(const verification::LifeCollection& lives,
                                                    const verification::Summary& summary);
[[nodiscard]] std::string verification_table(const verification::Summary& summary);

}  // namespace sealwatch::cli
