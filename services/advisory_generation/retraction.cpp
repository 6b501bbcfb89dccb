// What the retraction of tests does to the advice: the next test is judged with those that still count.
#include "services/advisory_generation/advisory_generation.hpp"
#include "services/advisory_generation/advisory_revision.hpp"

namespace sealwatch::advisory_generation {
namespace {

/// Five years of monthly tests: the rules against flapping look back over far fewer.
constexpr std::size_t kMostJudged = 60;

}  // namespace

void AdvisoryGeneration::remember(Judged judged, Asset& asset) {
  asset.retracted.know(judged.pst_id, judged.time);
  asset.judged.push_back(std::move(judged));
  if (asset.judged.size() > kMostJudged) asset.judged.erase(asset.judged.begin());
}

void AdvisoryGeneration::apply(const Retraction& retraction, Asset& asset) const {
  asset.retracted.apply(retraction);
  asset.memory = {};
  asset.last_test.reset();
  for (const Judged& test : asset.judged) {
    if (!asset.retracted.counts(test.pst_id)) continue;
    (void)asset.memory.judge(test.verdict, test.time, options_);
    if (test.time) asset.last_test = test.time;
  }
}

Conclusion AdvisoryGeneration::retracted(const MaintenanceEvent& event) {
  Conclusion conclusion{.outputs = {}, .consumed = {event.header.message_id}};
  const auto retraction = retraction_of(event.asset_id, event.header.message_id);
  if (!retraction) return conclusion;
  Asset& asset = assets_[event.asset_id];
  apply(*retraction, asset);
  if (asset.current) put_out(after_retraction(*asset.current, event, *retraction), conclusion);
  return conclusion;
}

}  // namespace sealwatch::advisory_generation
