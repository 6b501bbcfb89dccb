// What the separate process costs: one request there and back, of a model whose own work takes nanoseconds.
// Goal: a derivative within 10 microseconds where two cores are free.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <vector>

#include "services/common/fmi/fmu_file.hpp"
#include "tests/unit/fmi/fmu_builder.hpp"

namespace {

using namespace sealwatch::fmi;

double median_us(FmuProcess& process, const EvaluationRequest& wanted) {
  constexpr int kBlocks = 50, kCalls = 400;
  std::vector<double> blocks;
  for (int block = 0; block < kBlocks; ++block) {
    const auto begin = std::chrono::steady_clock::now();
    for (int call = 0; call < kCalls; ++call)
      if (!process.evaluate(1e-3 * call, std::array{0.01, 0.1}, std::array{3.0}, wanted)) return -1.0;
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - begin;
    blocks.push_back(took.count() / kCalls);
  }
  std::ranges::sort(blocks);
  return blocks[kBlocks / 2];
}

}  // namespace

int main() {
  const TestFolder folder;
  const auto file = FmuFile::open(folder.build(spring_return("fmu_spring_return2")));
  if (!file) return 2;
  Selection selection{.parameters = {}, .inputs = {4}, .outputs = {9}};
  const auto setup = (*file)->setup(selection);
  const auto process = FmuProcess::start("model.fmu", *setup, 1);
  constexpr std::array kSteps = {1e-7, 1e-7};
  constexpr std::array kInput = {0.0};
  if (!process ||
      !(*process)->begin(
          {.state_steps = kSteps, .input_steps = std::span(kSteps).first(1), .inputs = kInput, .parameters = {}}))
    return 2;
  const double values = median_us(**process, {}), all = median_us(**process, {1, 1, 0});
  std::printf("values of a model of 2 states: %.1f us a request; with all its derivatives: %.1f us\n", values, all);
  return values < 10.0 ? 0 : 1;
}
