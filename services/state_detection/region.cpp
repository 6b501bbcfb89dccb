#include "services/state_detection/region.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

namespace sealwatch {

Status RegionOptions::validate() const {
  const auto at_least_one = [](const char* key, int value) -> Status {
    if (value >= 1) return {};
    return fail(Error{{}, key, std::to_string(value), "must be at least 1", "1 means at once"});
  };
  if (Status status = at_least_one("worsen_after_tests", worsen_after_tests); !status) return status;
  if (Status status = at_least_one("recover_after_tests", recover_after_tests); !status) return status;
  if (margin >= 0.0 && margin < 1.0) return {};
  return fail(Error{{}, "margin", std::to_string(margin), "must be in [0, 1)", "a share of the step between limits"});
}

AlertRegion region_of(double value, const AlertLimits& limits) {
  const bool downwards = limits.alarm < limits.advisory;
  const auto beyond = [&](double limit) { return downwards ? value <= limit : value >= limit; };
  if (beyond(limits.alarm)) return AlertRegion::alarm;
  if (beyond(limits.warning)) return AlertRegion::warning;
  if (beyond(limits.advisory)) return AlertRegion::advisory;
  return AlertRegion::normal;
}

void RegionFilter::update(RegionJudgement& judgement) {
  const AlertLimits limits{judgement.advisory_limit, judgement.warning_limit, judgement.alarm_limit};
  const double step = options_.margin * (limits.warning - limits.advisory);  // signed: points away from normal
  const AlertLimits eased{limits.advisory - step, limits.warning - step, limits.alarm - step};
  const Regions now{region_of(judgement.value, limits), region_of(judgement.value, eased)};

  const bool same = !recent_.empty() && recent_.back().raw == now.raw;
  tests_in_raw_region_ = same ? tests_in_raw_region_ + 1 : 1;
  recent_.push_back(now);
  const auto keep = static_cast<std::size_t>(std::max(options_.worsen_after_tests, options_.recover_after_tests));
  if (recent_.size() > keep) recent_.erase(recent_.begin());
  follow();
  judgement.raw_region = now.raw;
  judgement.region = region_;
  judgement.tests_in_raw_region = tests_in_raw_region_;
}

void RegionFilter::look(RegionJudgement& judgement) const {
  judgement.raw_region =
      region_of(judgement.value, {judgement.advisory_limit, judgement.warning_limit, judgement.alarm_limit});
  judgement.region = region_;
  judgement.tests_in_raw_region = 0;
}

void RegionFilter::follow() {
  const auto last = [this](int count) {
    const auto size = static_cast<std::size_t>(count);
    return size <= recent_.size() ? std::span(recent_).last(size) : std::span<Regions>{};
  };
  const auto by_raw = [](const Regions& a, const Regions& b) { return a.raw < b.raw; };
  const auto by_eased = [](const Regions& a, const Regions& b) { return a.eased < b.eased; };
  if (const auto tests = last(options_.worsen_after_tests); !tests.empty()) {
    const AlertRegion mildest = std::min_element(tests.begin(), tests.end(), by_raw)->raw;
    if (mildest > region_) {
      region_ = mildest;
      return;
    }
  }
  if (const auto tests = last(options_.recover_after_tests); !tests.empty())
    region_ = std::min(region_, std::max_element(tests.begin(), tests.end(), by_eased)->eased);
}

}  // namespace sealwatch
