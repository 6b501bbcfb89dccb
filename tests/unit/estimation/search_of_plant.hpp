// A plant as text, and the search for its parameters in one recording.
#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <stdexcept>
#include <string>

#include "services/common/estimation/pem_search.hpp"
#include "services/common/runtime/plant_file.hpp"
#include "tests/unit/model/recording_for_tests.hpp"

namespace sealwatch {

struct SearchOfPlant {
  PemProblem problem;
  ActuatorFitOptions options;
  PemOptimum optimum;

  [[nodiscard]] double value(std::string_view parameter) const {
    for (std::size_t k = 0; k < problem.shared.size(); ++k)
      if (problem.shared[k].name == parameter) return problem.shared[k].to_value(optimum.point.shared[k]);
    throw std::runtime_error("no unknown is called " + std::string(parameter));
  }
};

/// From the plant's own values. Throws what goes wrong, which fails the test.
inline SearchOfPlant search_of_plant(const std::string& name, const std::string& plant, const TimeSeries& samples) {
  const auto must = [](auto&& result, const auto& describe) {
    if (!result) throw std::runtime_error(describe(result.error()));
    return std::move(*result);
  };
  const auto describe = [](const Error& error) { return error.describe(); };
  const std::string file = ::testing::TempDir() + name + ".yaml";
  std::ofstream(file) << plant;
  must(load_plant(file), [&](const auto& errors) { return describe(errors.front()); });
  SearchOfPlant search{
      .problem = must(make_pem_problem(nominal_asset(name), {&samples, 1}), describe), .options = {}, .optimum = {}};
  search.problem.simulation_options = simulation_options({&samples, 1}, search.options);
  search.optimum = must(sealwatch::search(search.problem, start_point(search.problem, 1.0), search.options), describe);
  return search;
}

}  // namespace sealwatch
