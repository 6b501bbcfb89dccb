#include "services/virtual_bench/simulated_actuator.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sealwatch/model/plant_description.hpp"
#include "services/virtual_bench/random.hpp"

namespace sealwatch::bench {
namespace {

constexpr const char* kAbortReason = "MCS command had priority";

/// The valve is closed and opened again.
Profile closing_profile(double open_m, double closed_m, double speed_m_s) {
  Profile profile = move_profile(open_m, closed_m, speed_m_s, TestKind::full_stroke);
  const Profile back = move_profile(closed_m, open_m, speed_m_s, TestKind::full_stroke);
  profile.pieces.insert(profile.pieces.end(), back.pieces.begin() + 1, back.pieces.end());
  return profile;
}

double stroke_m(const AssetConfig& asset) {
  if (const auto own = asset.parameters.find("x_C"); own != asset.parameters.end()) return own->second.value;
  const Result<const PlantDescription*> plant = find_plant("eha");
  return (*plant)->find_parameter("x_C")->value;
}

}  // namespace

SimulatedActuator::SimulatedActuator(AssetConfig asset, const ActuatorSetting& setting)
    : asset_(std::move(asset)),
      setting_(setting),
      seal_(sub_seed(setting.seed, asset_.asset_id + " seal"), setting.degradation),
      chance_(sub_seed(setting.seed, asset_.asset_id + " chance")),
      installed_(setting.installed),
      next_test_(add_months(setting.installed, asset_.pst.interval_months)) {
  draw_command(setting.installed);
}

void SimulatedActuator::draw_command(UtcTime after) {
  if (!(setting_.commands_per_month > 0.0)) return;
  // Waiting time of a Poisson process.
  own_command_ = add_months(after, -std::log(1.0 - chance_.unit()) / setting_.commands_per_month);
}

void SimulatedActuator::request(const PstRequest& request, UtcTime now) {
  if (request.header.message_id == last_request_ && !last_request_.empty()) return;
  last_request_ = request.header.message_id;
  requested_by_ = request.header.message_id;
  next_test_ = std::max(UtcTime{request.due_time_ns}, now);
}

void SimulatedActuator::command(UtcTime when) {
  commands_.insert(std::upper_bound(commands_.begin(), commands_.end(), when), when);
}

void SimulatedActuator::maintain(const MaintenanceEvent& event) {
  seal_ = forecast::Degradation(sub_seed(setting_.seed, event.header.message_id), setting_.degradation);
  installed_ = UtcTime{event.header.event_time_ns};
}

std::optional<UtcTime> SimulatedActuator::next_command() const {
  if (commands_.empty()) return own_command_;
  return own_command_ ? std::min(*own_command_, commands_.front()) : commands_.front();
}

Result<std::vector<RawSamples>> SimulatedActuator::advance(UtcTime now) {
  std::vector<RawSamples> out;
  for (;;) {
    // A command waits only for another command; a test waits for whatever runs.
    std::optional<UtcTime> command = next_command();
    if (command && running_ && running_->kind() == TestKind::full_stroke) command = std::max(*command, running_->end());
    const UtcTime test = running_ ? std::max(next_test_, running_->end()) : next_test_;
    const UtcTime next = command ? std::min(*command, test) : test;
    send_until(std::min(next, now), out);
    if (next > now) return out;
    const Status status = command && *command <= test ? start_command(*command, out) : start_test(test);
    if (!status) return fail(status.error());
  }
}

void SimulatedActuator::send_until(UtcTime time, std::vector<RawSamples>& out) {
  if (!running_) return;
  for (RawSamples& block : running_->take_until(time)) out.push_back(std::move(block));
  if (running_->finished()) running_.reset();
}

Status SimulatedActuator::start_command(UtcTime time, std::vector<RawSamples>& out) {
  if (!commands_.empty() && commands_.front() <= time)
    commands_.erase(commands_.begin());
  else
    draw_command(time);
  const bool aborts = running_.has_value();
  if (aborts) out.push_back(running_->abort(time, kAbortReason));
  const double speed = stroke_m(asset_) / setting_.closing_time_s;
  if (Status status = start(closing_profile(asset_.pst.start_m, setting_.closed_m, speed), time, {}); !status)
    return status;
  const UtcTime free_again = add_seconds(running_->end(), setting_.deferral_s);
  next_test_ = aborts ? free_again : std::max(next_test_, free_again);
  return {};
}

Status SimulatedActuator::start_test(UtcTime time) {
  std::vector<std::string> source_ids;
  if (!requested_by_.empty()) source_ids.push_back(std::exchange(requested_by_, ""));
  next_test_ = add_months(time, asset_.pst.interval_months);
  return start(pst_profile(asset_.pst), time, std::move(source_ids));
}

Status SimulatedActuator::start(const Profile& profile, UtcTime time, std::vector<std::string> source_ids) {
  while (seal_.month() + 1 <= months_between(installed_, time)) seal_.advance();
  TestConditions conditions;
  conditions.load_factor = chance_.between(-setting_.load_range, setting_.load_range);
  if (asset_.condition) {
    // Long after its failure the line of theta would cross zero; a seal that is gone still leaves a gap.
    const double least = 0.1 * asset_.condition->at_60;
    conditions.parameters["R_CL"] = std::max(asset_.condition->value(seal_.condition()), least);
  }
  const std::string kind = profile.kind == TestKind::pst ? "PST" : "MCS";
  TestSetting test = setting_.test;
  test.seed = sub_seed(setting_.seed, asset_.asset_id + format_utc(time));
  Result<Recording> recording = simulate_test(asset_, profile, conditions, test);
  if (!recording) return fail(recording.error());
  recording->start_time = time;
  recording->recording_id = format_utc(time) + "-" + kind + "-" + asset_.asset_id;
  running_.emplace(std::move(*recording), std::move(source_ids), setting_.block_s);
  return {};
}

}  // namespace sealwatch::bench
