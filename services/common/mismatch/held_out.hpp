// Two models on recordings that took no part in their fit: each keeps its shared parameters, only a recording's own
// load and initial state are estimated. Where no recording was kept aside, the fitted ones are left out in turn, one of
// up to four or a third of more (in their order: what lies together is alike), and the model is fitted to the others
// anew.
#pragma once

#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "sealwatch/mismatch/explain.hpp"
#include "services/common/mismatch/proof.hpp"
#include "services/common/mismatch/refits.hpp"

namespace sealwatch::mismatch {

/// Of each recording that took no part, or in turn takes none.
using Predictions = std::vector<Result<FittedModel>>;

/// Predictions that were made once, of the same recordings: a prediction in turn refits the model.
struct KeptPredictions {
  struct Predicted {
    std::shared_ptr<const Predictions> models;
    bool cut = false;  ///< by the time limit, which may be further off when they are asked for again
  };
  std::map<std::pair<std::shared_ptr<const FittedModel>, bool>, Predicted> of;  ///< model; in turn or not
};

/// Of an analysis that outlives it.
struct HeldOut {
  const Data& fit;
  const Data& holdout;    ///< may be empty
  double window_s = 0.0;  ///< predictions of windows of this length; 0: of whole recordings
  const ExplainOptions& options;
  std::shared_ptr<KeptPredictions> kept = std::make_shared<KeptPredictions>();  ///< shared by copies

  /// Blocks of the model `after` against `before`; none with a single recording in all. Each recording's comparison is
  /// added to `kept`, of whole recordings from one initial state even where predictions are of windows. A recording on
  /// which the model before cannot be simulated is not compared; where the one after cannot, that is an Error, unless
  /// comparisons are kept: then it is not compared either.
  [[nodiscard]] Result<BlockGains> gains(const Trial& before, const Trial& after,
                                         std::vector<RecordingComparison>* compared = nullptr) const;
  [[nodiscard]] Result<BlockGains> gains(const Predictions& before, const Predictions& after,
                                         const FittedModel& model_after,
                                         std::vector<RecordingComparison>* compared = nullptr) const;
  [[nodiscard]] std::shared_ptr<const Predictions> predictions(const Trial& trial) const;

 private:
  [[nodiscard]] bool in_turn() const { return holdout.samples.empty(); }
  [[nodiscard]] const Data& predicted() const { return in_turn() ? fit : holdout; }
};

[[nodiscard]] Data in_windows(const Data& data, double window_s);

/// One whole recording from one initial state, all parameters as the model has them.
[[nodiscard]] Result<FittedModel> free_run(const FittedModel& model, const Data& data, std::size_t recording);

/// Likelihood gain of a recording with its interval, by the dispersion of the model after.
void add_gain(RecordingComparison& comparison, const BlockGains& blocks, const FittedModel& after, std::uint64_t seed);

}  // namespace sealwatch::mismatch
