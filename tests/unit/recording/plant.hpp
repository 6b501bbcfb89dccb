// A small plant and a scratch folder for the tests of recordings.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "sealwatch/model/plant_description.hpp"

namespace sealwatch {

inline PlantDescription test_plant() {
  PlantDescription plant;
  plant.name = "test_plant";
  for (const auto& [name, unit] : {std::pair{"motor_voltage", "V"},
                                   {"pressure_a", "Pa"},
                                   {"pressure_b", "Pa"},
                                   {"flow", "m3/s"},
                                   {"position", "m"},
                                   {"shaft_speed", "rad/s"},
                                   {"fluid_temperature", "K"},
                                   {"valve_state", "1"}})
    plant.channels.push_back({.name = name, .unit = unit, .meaning = "of the test"});
  return plant;
}

/// A folder of its own for each test, gone at its end.
class ScratchFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* const test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(::testing::TempDir()) /
              (std::string("sealwatch_recording_") + test->test_suite_name() + "_" + test->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
    return path(name);
  }

 private:
  std::filesystem::path folder_;
};

}  // namespace sealwatch
