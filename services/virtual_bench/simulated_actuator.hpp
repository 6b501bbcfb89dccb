// One actuator at sea with its Master Control System (MCS), which moves the valve and decides when it is tested.
//
// The MCS runs a partial stroke test once an interval by its own schedule. A request for a test replaces the scheduled
// time. Its own commands to the valve have priority: a test that is running is aborted, a test that falls due
// meanwhile is deferred until `deferral_s` after the command was carried out.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sealwatch/forecast/degradation.hpp"
#include "sealwatch/message/topics.hpp"
#include "services/virtual_bench/running_test.hpp"
#include "services/virtual_bench/simulate_life.hpp"

namespace sealwatch::bench {

struct ActuatorSetting {
  std::uint64_t seed = 1;
  UtcTime installed = {};
  double load_range = 0.2;          ///< Phi is uniform in +- this
  double commands_per_month = 1.0;  ///< the MCS closes the valve and opens it again so often, at random times
  double closed_m = 2e-3;           ///< where the valve counts as closed: at the cushion
  double closing_time_s = 50.0;     ///< of a full stroke; the valve must close in 60 s
  double deferral_s = 3600.0;
  double block_s = 1.0;  ///< length of a published block
  forecast::DegradationSetting degradation = {};
  TestSetting test = {};
};

class SimulatedActuator {
 public:
  SimulatedActuator(AssetConfig asset, const ActuatorSetting& setting);

  /// Somebody asks for a test. A request that was taken before changes nothing.
  void request(const PstRequest& request, UtcTime now);
  /// The MCS closes the valve and opens it again at `when`, besides what it does by itself.
  void command(UtcTime when);
  /// A new actuator or seal: its condition starts anew.
  void maintain(const MaintenanceEvent& event);
  /// Lets time pass; returns what was recorded meanwhile, in order. `now` must not go back.
  [[nodiscard]] Result<std::vector<RawSamples>> advance(UtcTime now);

  [[nodiscard]] const AssetConfig& asset() const { return asset_; }
  [[nodiscard]] double condition() const { return seal_.condition(); }  ///< theta at the last test
  [[nodiscard]] UtcTime next_test() const { return next_test_; }

 private:
  void send_until(UtcTime time, std::vector<RawSamples>& out);
  [[nodiscard]] Status start(const Profile& profile, UtcTime time, std::vector<std::string> source_ids);
  [[nodiscard]] Status start_command(UtcTime time, std::vector<RawSamples>& out);
  [[nodiscard]] Status start_test(UtcTime time);
  [[nodiscard]] std::optional<UtcTime> next_command() const;
  void draw_command(UtcTime after);

  AssetConfig asset_;
  ActuatorSetting setting_;
  forecast::Degradation seal_;
  forecast::UniformRandom chance_;  ///< loads and the MCS's commands
  UtcTime installed_;
  UtcTime next_test_;
  std::string requested_by_;            ///< message id of the request behind next_test_, "" when by schedule
  std::vector<UtcTime> commands_;       ///< asked for by command()
  std::optional<UtcTime> own_command_;  ///< the next by itself
  std::optional<RunningTest> running_;
  std::string last_request_;
};

}  // namespace sealwatch::bench
