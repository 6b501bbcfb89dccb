// How advisories follow each other: revisions of the same recommendation, superseding, acknowledgements. Pure
// functions.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sealwatch/message/advisory_generation.hpp"
#include "sealwatch/message/retraction.hpp"
#include "sealwatch/message/state_detection.hpp"
#include "services/advisory_generation/recommendation.hpp"

namespace sealwatch::advisory_generation {

/// The next advisory after `current`: a higher revision when action and priority stay (an acknowledgement stays too,
/// unless the latest-by date comes earlier or falls away), else a new one that names the one it supersedes. Reasons and
/// sources are not filled.
[[nodiscard]] Advisory revision_of(const std::optional<Advisory>& current, const std::string& asset_id,
                                   const Recommendation& recommendation, const Header& cause);

/// `old` as it is published once `successor` takes its place.
[[nodiscard]] Advisory superseded(Advisory old, const Advisory& successor);

/// Under which id an advisory that was acknowledged any number of times came about; `before` is that of the one before.
[[nodiscard]] std::string id_without_acknowledgements(const Advisory& advisory, const std::string& before);
/// `current`, which came about under `current_id`, acknowledged; with a remark when the acknowledgement names another
/// advisory; none when it is acknowledged already.
[[nodiscard]] std::optional<Advisory> with_acknowledgement(const Advisory& current, const std::string& current_id,
                                                           const Acknowledgement& acknowledgement);

/// The call for an overdue test: its own advisory, or a reason more where something at least as urgent stands.
[[nodiscard]] Advisory with_overdue_test(const std::optional<Advisory>& current, const StateReport& report);

/// The advice in force stands until it is renewed; the retraction (or what it withdraws) is named, with who and why.
[[nodiscard]] Advisory after_retraction(const Advisory& current, const MaintenanceEvent& event,
                                        const Retraction& retraction);
/// The cause of the advice that is renewed from the tests that count after a retraction.
[[nodiscard]] std::string renewed_id(const std::string& retraction_id);
[[nodiscard]] std::optional<Retraction> retraction_of_renewed(const Advisory& advisory);
/// Which retraction the advisory answers; nothing for others.
[[nodiscard]] std::optional<Retraction> answered_retraction(const Advisory& advisory);

/// The fresh start after a replacement.
[[nodiscard]] Advisory after_replacement(const std::optional<Advisory>& current, const MaintenanceEvent& event);
/// After a replacement that was reported when later tests were known already: what was advised stands until the next
/// test, which is judged with the tests since.
[[nodiscard]] Advisory after_late_replacement(const Advisory& current, const MaintenanceEvent& event);
[[nodiscard]] bool is_answer_to_replacement(const Advisory& advisory);
/// Whether it asks for a test that is overdue, and came about by that alone.
[[nodiscard]] bool is_of_overdue_test(const Advisory& advisory);

/// Message ids behind an advisory, down to the window with the waveform; each once.
[[nodiscard]] std::vector<std::string> source_ids(const Evidence& evidence);

}  // namespace sealwatch::advisory_generation
