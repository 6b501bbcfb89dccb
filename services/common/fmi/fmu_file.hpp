// An FMU, opened: its archive unpacked, its description read, its binary for this platform found.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "services/common/fmi/fmu_archive.hpp"
#include "services/common/fmi/fmu_process.hpp"
#include "services/common/fmi/model_description.hpp"

namespace sealwatch::fmi {

/// Variables by which an FMU is driven, read and changed. Inputs whose type or variability lets them change at events
/// only stand behind the others: FmuFile::setup() orders them.
struct Selection {
  std::vector<std::size_t> parameters, inputs, outputs;  ///< indices of whole variables
};

/// Which of its interfaces a unit is run by.
enum class Choice { model_exchange_first, model_exchange, co_simulation };

/// Before a setting's name: the place of an Error that is its fault.
inline constexpr const char* kSettingPlace = "setting ";

[[nodiscard]] bool is_number(FmiType type);
/// Whether a variable may change between events.
[[nodiscard]] bool changes_between_events(const Variable& variable);

class FmuFile {
 public:
  /// An Error when it cannot be run here.
  [[nodiscard]] static Result<std::shared_ptr<const FmuFile>> open(const std::string& file,
                                                                   const Settings& settings = {},
                                                                   Choice choice = Choice::model_exchange_first);
  [[nodiscard]] const ModelDescription& description() const { return description_; }
  [[nodiscard]] const std::string& name() const { return unpacked_.file; }
  /// Whether it is run for Co-Simulation: then nothing can be added to its derivatives.
  [[nodiscard]] bool co_simulation() const { return !description_.model_exchange; }
  [[nodiscard]] const Settings& settings() const { return settings_; }
  /// The settings in numbers, where they are no texts: items of enumerations may be set by their names.
  [[nodiscard]] const Settings& set_values() const { return values_; }
  [[nodiscard]] const Interface& interface() const;
  /// What its process must know; `selection` is put in order.
  [[nodiscard]] Result<Setup> setup(Selection& selection) const;
  [[nodiscard]] const UnpackedFmu& unpacked() const { return unpacked_; }

 private:
  FmuFile(UnpackedFmu unpacked, ModelDescription description, Settings settings)
      : unpacked_(std::move(unpacked)), description_(std::move(description)), settings_(std::move(settings)) {}
  [[nodiscard]] Status find_binary();
  /// Every setting names a variable that can be set, and has a value for it.
  [[nodiscard]] Status take_settings();
  [[nodiscard]] Status check_states() const;
  void put_settings(Setup& setup) const;
  [[nodiscard]] Error refusal(std::string rule, std::string advice, std::string value = {}) const;

  UnpackedFmu unpacked_;
  ModelDescription description_;
  Settings settings_, values_;
  std::string binary_;  ///< member
};

}  // namespace sealwatch::fmi
