#include "services/common/model/plants/eha_switched/estimation/closed_valves.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "sealwatch/model/eha_switched.hpp"
#include "services/common/text/numbers.hpp"
#include "services/common/text/readable.hpp"

namespace sealwatch {
namespace {

constexpr double kSettling_s = 0.3;  // after the valves close, their line's flow stops
constexpr double kShortest_s = 1.0;
constexpr double kSeen = 3.0;  // standard errors from which a leak counts as seen
constexpr double kOneSided95 = 1.645;

using Plant = EhaSwitched;

EhaSwitchedParameters<double> parameters_of(const AssetConfig& asset) {
  EhaSwitchedParameters<double> p{};
  std::remove_cvref_t<decltype(p)>::visit(
      [&](std::string_view name, double& value) {
        if (const auto found = asset.parameters.find(std::string(name)); found != asset.parameters.end())
          value = found->second.value;
      },
      p);
  return p;
}

struct Line {
  double mean = 0.0, slope = 0.0, slope_std = 0.0;
};

Line line_through(std::span<const double> time_s, std::span<const double> values) {
  const auto n = static_cast<double>(values.size());
  double t = 0.0, tt = 0.0, ty = 0.0;
  Line line;
  for (std::size_t k = 0; k < values.size(); ++k) t += time_s[k] / n, line.mean += values[k] / n;
  for (std::size_t k = 0; k < values.size(); ++k) {
    tt += (time_s[k] - t) * (time_s[k] - t);
    ty += (time_s[k] - t) * (values[k] - line.mean);
  }
  line.slope = ty / tt;
  double squares = 0.0, products = 0.0, last = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double left = values[k] - line.mean - line.slope * (time_s[k] - t);
    squares += left * left;
    if (k > 0) products += left * last;
    last = left;
  }
  const double correlation = squares > 0.0 ? std::clamp(products / squares, 0.0, 0.95) : 0.0;
  line.slope_std = std::sqrt(squares / (n - 2.0) / tt * (1.0 + correlation) / (1.0 - correlation));
  return line;
}

// Weighted mean of all that the stretches say.
struct Sum {
  double weights = 0.0, weighted = 0.0;
  void add(double value, double error) {
    if (!(error > 0.0) || !std::isfinite(value)) return;
    weights += 1.0 / (error * error);
    weighted += value / (error * error);
  }
};

}  // namespace

std::optional<ClosedValveLeakage> closed_valve_leakage(const AssetConfig& asset, const TimeSeries& samples) {
  const Series *valves = samples.find("valve_state"), *a = samples.find("pressure_a"), *b = samples.find("pressure_b"),
               *position = samples.find("position");
  if (asset.model != "eha_switched" || valves == nullptr || a == nullptr || b == nullptr || position == nullptr)
    return std::nullopt;
  const EhaSwitchedParameters<double> p = parameters_of(asset);
  ClosedValveLeakage leakage;
  Sum sum;
  const std::vector<double>& time_s = samples.time_s;
  for (std::size_t begin = 0, end = 0; begin < time_s.size(); begin = end) {
    ++end;  // a stretch has one sample at least, whatever it compares like
    while (end < time_s.size() && valves->values[end] == valves->values[begin]) ++end;
    std::size_t first = begin;
    while (begin > 0 && first < end && time_s[first] < time_s[begin] + kSettling_s) ++first;
    if (valves->values[begin] != 0.0 || end - first < 8 || time_s[end - 1] - time_s[first] < kShortest_s) continue;
    const auto stretch = [&](const std::vector<double>& values) {
      return std::span(values).subspan(first, end - first);
    };
    const Line p_A = line_through(stretch(time_s), stretch(a->values)),
               p_B = line_through(stretch(time_s), stretch(b->values));
    const double x = position->values[first], difference = p_A.mean - p_B.mean;
    const double pipe = p.V_0 + Plant::pipe_volume(p.l_chamber, p);
    const double C_A = (pipe + p.A_A * x) / Plant::bulk_modulus(p_A.mean, p),
                 C_B = (pipe + p.A_B * (p.x_C - x)) / Plant::bulk_modulus(p_B.mean, p);
    sum.add(-C_A * p_A.slope / difference, std::abs(C_A * p_A.slope_std / difference));
    sum.add(C_B * p_B.slope / difference, std::abs(C_B * p_B.slope_std / difference));
    leakage.duration_s += time_s[end - 1] - time_s[first];
    leakage.largest_difference_Pa = std::max(leakage.largest_difference_Pa, std::abs(difference));
  }
  if (!(sum.weights > 0.0)) return std::nullopt;
  leakage.conductance = sum.weighted / sum.weights;
  leakage.conductance_std = 1.0 / std::sqrt(sum.weights);
  return leakage;
}

std::string in_words(const ClosedValveLeakage& leakage) {
  std::string text = "while the valves were closed (";
  text.append(text::significant(leakage.duration_s)).append(" s, pressures up to ");
  text.append(text::readable(leakage.largest_difference_Pa, "Pa")).append(" apart) ");
  const double G = leakage.conductance, error = leakage.conductance_std;
  if (G > kSeen * error)
    return text.append("R_CL was ")
        .append(text::readable_with_error(1.0 / G, error / (G * G), "Pa s/m3"))
        .append(", with the asset's own compliance of the chambers");
  return text.append("no internal leakage was seen: with the asset's own compliance of the chambers R_CL is above ")
      .append(text::readable(1.0 / (std::max(G, 0.0) + kOneSided95 * error), "Pa s/m3"))
      .append(" (95 %)");
}

}  // namespace sealwatch
