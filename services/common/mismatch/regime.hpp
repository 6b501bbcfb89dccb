// Where a term acts, in one sentence: from the share of its energy (squares over time) in each regime against the
// share of the time that the recordings spend there.
//   motion     at rest or moving, one direction or both: by the site's speed (current, flow)
//   signals    the narrowest range of speed, pressure, position, ... that holds it while it acts, or the widest that
//              holds nothing of it; of the signals that its size goes by: eta2, the share of the variance of its size
//              between the values of a signal, within 0.2 of the largest
//   time       first or last third of the recording
//   active     share of the time in which its size is above a tenth of what it hardly exceeds (its 99 % quantile)
// A regime is named when it holds at least 90 % of the energy in at most 65 % of the time.
#pragma once

#include "services/common/mismatch/site_words.hpp"
#include "services/common/mismatch/term_path.hpp"

namespace sealwatch::mismatch {

/// "piston position above 52 mm, 12 % of the time"; "throughout" where it acts nearly always and no regime stands out,
/// "nowhere in these recordings" where it stays 0; "" without any path. `whole`: paths are whole recordings, not
/// windows of them, so that the first third means something.
[[nodiscard]] std::string regime_of(std::span<const TermPath> recordings, SiteKind kind,
                                    const std::array<SignalWords, kSiteSignals>& signals, bool whole = true);
[[nodiscard]] std::string regime_of(std::span<const TermPath> recordings, SiteKind kind);

/// The signals of a term: those of its site, of a sensor what it measures.
[[nodiscard]] std::array<SignalWords, kSiteSignals> signals_of(const PlantSimulation& simulation,
                                                               const std::string& element, SiteKind kind);

/// Which of the site's signals move the law anywhere on these paths, by its derivatives; the position too where it
/// remembers the piston's way. What else correlates with a force may be what it causes: a chamber's pressure.
[[nodiscard]] std::array<bool, kSiteSignals> signals_seen(std::span<const TermPath> recordings, const Law& law,
                                                          std::span<const double> parameters,
                                                          const PlantDescription& plant);

/// Index of the site's signal that the term goes by: of those `seen`, that of the largest eta2 of its value, the first
/// of nearly equal.
[[nodiscard]] std::size_t deciding_signal(std::span<const TermPath> recordings, SiteKind kind,
                                          const std::array<bool, kSiteSignals>& seen);

}  // namespace sealwatch::mismatch
