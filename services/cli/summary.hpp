// Messages and assets in words, for the terminal: one line a message, one screen an asset.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sealwatch/message/topics.hpp"

namespace sealwatch::cli {

/// One line of what a message says: event date, asset, topic, the figures that matter with units.
[[nodiscard]] std::string one_line(const Message& message);
[[nodiscard]] std::string one_line(const ServiceStatus& status);

/// The last word of every layer on one asset, and the history of what wears.
class AssetView {
 public:
  void take(const Message& message);
  /// One screen: condition of what wears and its history, forecasts with intervals, advisory with its reasons, where to look
  /// further. Where no services run (any more) nobody could take an acknowledgement, so the hint to give one is left
  /// out.
  [[nodiscard]] std::string screen(bool services_run = true) const;
  /// What the advice asks for: "HIGH, book vessel, latest by 2018-05-31"; "" where it asks for nothing.
  [[nodiscard]] std::string call() const;
  /// The same for machines: the last message of each topic (schema sealwatch.asset/1).
  [[nodiscard]] std::string json() const;
  /// Tests seen, and those whose estimate took part in the forecast.
  [[nodiscard]] std::size_t tests() const { return estimates_.size(); }

 private:
  [[nodiscard]] std::string seal_lines() const;
  [[nodiscard]] std::string history_chart() const;
  [[nodiscard]] std::string forecast_lines() const;
  [[nodiscard]] std::string advisory_lines(bool services_run) const;
  [[nodiscard]] std::string model_lines() const;
  /// Which version is accepted, and from which test on; "" where none was since the last replacement.
  [[nodiscard]] std::string acceptance_line() const;
  [[nodiscard]] std::string left_out_lines() const;
  /// Whether this is about the actuator or seal that is there now.
  [[nodiscard]] bool is_of_now(const Header& header) const;
  /// Tests since the last replacement.
  [[nodiscard]] std::vector<const LeakageEstimate*> estimates_of_now() const;

  std::string asset_id_;
  std::map<std::string, LeakageEstimate> estimates_;  ///< by PST id
  std::optional<RemainingLife> life_;
  std::optional<std::int64_t> replaced_ns_;  ///< when actuator or seal was replaced, as far as is known
  std::optional<HealthReport> health_;
  std::optional<StateReport> state_;
  std::optional<Advisory> advisory_;
  std::optional<ModelDiscrepancy> discrepancy_;
  std::optional<ModelAcceptance> acceptance_;
};

}  // namespace sealwatch::cli
