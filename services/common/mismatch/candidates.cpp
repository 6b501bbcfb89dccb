#include "services/common/mismatch/candidates.hpp"

#include <algorithm>

#include "sealwatch/model/law_sizes.hpp"
#include "services/common/equations/site_table.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr std::size_t kLargestGrid = 12;
constexpr Eigen::Index kClipped = 5;  // samples in a row at the largest value of a recording: a sensor at its end
constexpr double kBiasShare = 0.01;   // usual bias of a sensor, of the range of its channel in the recording

// In the sizes of the plant; a place also on the other side of zero, where the plant may have it.
std::vector<double> starts_of(const LawParameter& parameter, const PlantDescription& plant) {
  std::vector<double> starts;
  for (std::size_t k = 0; k < (parameter.strength ? 1 : parameter.start.size()); ++k) {
    starts.push_back(law_start(plant, parameter, k));
    if (parameter.place && law_bounds(plant, parameter).min < 0.0) starts.push_back(-starts.back());
  }
  return starts;
}

// All combinations of the start values; for many, the first values of each parameter with the usual ones of the others.
std::vector<std::vector<double>> shape_grid(const Law& law, const PlantDescription& plant) {
  std::vector<std::vector<double>> grid(1);
  std::size_t largest = kLargestGrid;
  for (const LawParameter& parameter : law.parameters) {
    const std::vector<double> starts = starts_of(parameter, plant);
    if (!parameter.strength && starts.size() > parameter.start.size()) largest = 2 * kLargestGrid;
    std::vector<std::vector<double>> next;
    for (std::size_t k = 0; k < starts.size() && next.size() < largest; ++k)
      for (const std::vector<double>& point : grid) {
        next.push_back(point);
        next.back().push_back(starts[k]);
      }
    grid = std::move(next);
  }
  if (grid.size() > largest) grid.resize(largest);
  return grid;
}

// A law or one that contains it: beside each other the two would share one effect between them at will.
bool present_already(const std::vector<PhysicsTerm>& present, const Law& law, std::string_view element) {
  return std::ranges::any_of(present, [&](const PhysicsTerm& term) {
    if (term.element != element) return false;
    return std::ranges::any_of(all_laws(),
                               [&](const Law& other) { return other.id == term.id && overlap(other, law); });
  });
}

// With a load of each recording's own, a constant force is no mismatch.
bool pointless(const Law& law, const PlantSimulation& simulation) {
  return law.id == "constant_force" && simulation.plant().has_load();
}

void add_at_sites(const Law& law, const PlantSimulation& simulation, const std::vector<PhysicsTerm>& present,
                  std::vector<Candidate>& candidates) {
  std::vector<Candidate> found;
  for (std::size_t k = 0; k < simulation.sites().size(); ++k) {
    const Site& site = simulation.sites()[k];
    if (!fits(law, site) || (law.plant.empty() && equations::is_inert(law, site))) continue;
    if (!found.empty() && found.back().element == site.element) {
      found.back().sites.push_back(k);
      continue;
    }
    if (present_already(present, law, site.element) || pointless(law, simulation)) continue;
    found.push_back({.law = &law,
                     .element = std::string(site.element),
                     .sites = {k},
                     .channel = {},
                     .grid = shape_grid(law, simulation.plant())});
  }
  candidates.insert(candidates.end(), found.begin(), found.end());
}

// Of a channel in the recording: the law's usual size is a share of its range.
double bias_scale(const Law& law, double least, double largest) {
  return kBiasShare * std::max(largest - least, 1e-12) / law.parameters.front().start.front();
}

// A channel that stays at its largest value shows the end of its sensor's range. Without that there is nothing to see.
bool clipped(const Eigen::Ref<const Eigen::VectorXd>& column) {
  const double end = column.maxCoeff();
  if (end - column.minCoeff() <= 0.0) return false;
  Eigen::Index longest = 0, now = 0;
  for (const double value : column) longest = std::max(longest, now = value == end ? now + 1 : 0);
  return longest >= kClipped;
}

void add_at_sensors(const Law& law, const PlantSimulation& simulation, const std::vector<PhysicsTerm>& present,
                    std::vector<Candidate>& candidates) {
  for (std::size_t c = 0; c < simulation.channels().size(); ++c) {
    const std::string element = "sensor:" + simulation.channels()[c];
    if (present_already(present, law, element)) continue;
    Candidate candidate{.law = &law,
                        .element = element,
                        .sites = {},
                        .channel = simulation.channels()[c],
                        .grid = shape_grid(law, simulation.plant())};
    const Eigen::VectorXd column = simulation.recorded().col(static_cast<Eigen::Index>(c));
    if (law.kind == SiteKind::sensor_saturation) {
      if (!clipped(column)) continue;
      for (std::vector<double>& point : candidate.grid) point[1] = column.maxCoeff();
    }
    if (is_bias(law.kind)) candidate.strength_scale = bias_scale(law, column.minCoeff(), column.maxCoeff());
    candidates.push_back(std::move(candidate));
  }
}

// What the plant describes as measured, and drives this simulation: its sensor is asked, not the record.
bool is_measured(const PlantSimulation& simulation, const std::string& input) {
  const ChannelDescription* channel = simulation.plant().find_channel(input);
  return channel != nullptr && !channel->input;
}

// An input that never changes shows nothing of itself.
void add_of_recording(const Law& law, const PlantSimulation& simulation, const std::vector<PhysicsTerm>& present,
                      std::vector<Candidate>& candidates) {
  const auto add = [&](const std::string& element, const std::string& input, double strength_scale) {
    if (!present_already(present, law, element))
      candidates.push_back({.law = &law,
                            .element = element,
                            .sites = {},
                            .channel = input,
                            .grid = shape_grid(law, simulation.plant()),
                            .strength_scale = strength_scale});
  };
  if (law.kind == SiteKind::clock_rate) return add("clock", {}, 1.0);
  for (std::size_t k = 0; k < simulation.inputs().size(); ++k) {
    const auto [least, largest] = simulation.input_range(k);
    const std::string& input = simulation.inputs()[k];
    if (largest > least && is_measured(simulation, input) == is_sensor(law.kind))
      add((is_sensor(law.kind) ? "sensor:" : "input:") + input, input,
          is_bias(law.kind) ? bias_scale(law, least, largest) : 1.0);
  }
}

}  // namespace

std::vector<Candidate> find_candidates(const PlantSimulation& simulation, const std::vector<PhysicsTerm>& present,
                                       Laws which) {
  std::vector<Candidate> candidates;
  if (which == Laws::all) {
    candidates = find_candidates(simulation, present, Laws::listed);
    std::ranges::move(find_candidates(simulation, present, Laws::closed_forms), std::back_inserter(candidates));
    return candidates;
  }
  for (const Law& law : all_laws()) {
    if (law.closed_form != (which == Laws::closed_forms) || !is_of_plant(law, simulation.plant().name)) continue;
    if (is_of_recording(law.kind) || (is_sensor(law.kind) && law.kind < SiteKind::sensor_drift))
      add_of_recording(law, simulation, present, candidates);
    if (is_of_recording(law.kind)) continue;
    if (is_sensor(law.kind))
      add_at_sensors(law, simulation, present, candidates);
    else
      add_at_sites(law, simulation, present, candidates);
  }
  return candidates;
}

double significant_size(const Candidate& candidate, const PlantDescription& plant) {
  const LawParameter& strength = candidate.law->parameters[strengths_of(*candidate.law).front()];
  if (is_bias(candidate.law->kind)) return candidate.strength_scale * strength.start.front();
  return sealwatch::significant_size(plant, strength);
}

std::vector<std::size_t> strengths_of(const Law& law) {
  std::vector<std::size_t> strengths;
  for (std::size_t k = 0; k < law.parameters.size(); ++k)
    if (law.parameters[k].strength) strengths.push_back(k);
  return strengths;
}

bool overlap(const Law& a, const Law& b) { return a.id == b.id || a.limit == b.id || b.limit == a.id; }

std::string unit_of(const LawParameter& parameter, std::string_view element, const PlantDescription& plant) {
  if (parameter.unit != "channel") return std::string(parameter.unit);
  return plant.find_channel(std::string(element.substr(element.find(':') + 1)))->unit;
}

}  // namespace sealwatch::mismatch
