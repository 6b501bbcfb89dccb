#include "services/common/equations/site_curves.hpp"

#include <algorithm>
#include <utility>

#include "services/common/equations/own_law.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch::equations {
namespace {

// Shares of the site's size: of a strength that is usual, from which one matters, and beyond which none goes.
constexpr double kUsualShare = 0.1, kMatters = 0.01, kLargest = 10.0;
constexpr const char* kCornerSquared = "4e-4";  // of (s / S)^2: kCorner of power_law.hpp

// A signal by its usual size, as it is written in equations and as people read it.
struct Ratio {
  std::string written, read;
};
Ratio ratio_of(const TextSignal& signal) {
  const std::string size = text::general(*signal.size);
  if (signal.unit == "1") return {"(" + signal.name + "/" + size + ")", signal.name + " / " + size};
  return {"(" + signal.name + "/" + size + "[" + signal.unit + "])", signal.name + " / " + size + " " + signal.unit};
}

std::string even_power(const Ratio& ratio, const std::string& exponent) {
  return "exp(0.5*(" + exponent + ")*log(" + ratio.written + "^2 + " + kCornerSquared + "))";
}

TextLawParameter shape(std::string name, std::string unit, std::vector<double> start, double min, double max) {
  std::string meaning = unit == "1" ? "exponent" : "width";
  return {.name = std::move(name),
          .unit = std::move(unit),
          .meaning = std::move(meaning),
          .start = std::move(start),
          .min = min,
          .max = max};
}

// The curves of one site.
class Curves {
 public:
  Curves(const TextSite& site, const TextPlant& plant, const Faults& faults)
      : site_(site), plant_(plant), faults_(faults) {}

  std::vector<Law> all() {
    for (const TextSignal& signal : site_.signals) {
      const Ratio ratio = ratio_of(signal);
      const std::string name = name_of(signal), k = "k_" + name, a = "a_" + name, b = "b_" + name, w = "w_" + name;
      add(name + "_power", k, shape(a, "1", {2.0, 0.5, 3.0}, 0.2, 5.0),
          k + "*" + ratio.written + "*" + even_power(ratio, a + " - 1"),
          k + " sgn(" + signal.name + ") abs(" + ratio.read + ")^" + a, "a power of " + signal.name);
      add(name + "_even_power", k, shape(b, "1", {2.0, 1.0}, 0.5, 5.0), k + "*" + even_power(ratio, b),
          k + " abs(" + ratio.read + ")^" + b, "a power of " + signal.name + ", the same in both directions");
      const double size = *signal.size;
      add(name + "_saturation", k, shape(w, signal.unit, {0.1 * size, 0.01 * size}, 1e-3 * size, 2.0 * size),
          k + "*tanh(" + signal.name + "/" + w + ")", k + " tanh(" + signal.name + " / " + w + ")",
          "grows with " + signal.name + " up to a constant size");
      for (const TextSignal& other : site_.signals) {
        if (&other == &signal) continue;
        const Ratio by = ratio_of(other);
        const std::string exponent = "b_" + name_of(other);
        add(name + "_by_" + name_of(other), k, shape(exponent, "1", {1.0, 2.0}, 0.2, 5.0),
            k + "*" + ratio.written + "*" + even_power(by, exponent),
            k + " (" + ratio.read + ") abs(" + by.read + ")^" + exponent,
            "in proportion to " + signal.name + " and to a power of " + other.name);
      }
    }
    return std::move(laws_);
  }

 private:
  // Parameters tell the laws of one id apart, whatever their sites.
  std::string name_of(const TextSignal& signal) const {
    const auto has_it = [&](const TextSite& other) {
      return &other != &site_ && other.kind == SiteKind::own &&
             std::ranges::find(other.signals, signal.name, &TextSignal::name) != other.signals.end();
    };
    return std::ranges::any_of(plant_.sites, has_it) ? site_.element + "_" + signal.name : signal.name;
  }

  void add(const std::string& form, const std::string& strength, TextLawParameter of_shape, const std::string& equation,
           const std::string& read, const std::string& meaning) {
    const double size = *site_.size;
    TextLaw text;
    text.id = "unlisted";
    text.element = site_.element;
    text.equation = equation;
    text.meaning = meaning;
    text.energy = "of any sign: what does this is not known";
    text.kind = SiteKind::own;
    text.key = site_.key;
    text.parameters.push_back({.name = strength,
                               .unit = site_.unit,
                               .meaning = "strength",
                               .start = {kUsualShare * size},
                               .min = -kLargest * size,
                               .max = kLargest * size,
                               .significant = kMatters * size,
                               .strength = true});
    text.parameters.push_back(std::move(of_shape));
    std::optional<Law> law = build_law(text, plant_, faults_);
    if (!law) return;
    law->form = kept(form);
    law->equation = kept(read);
    law->source = kept("closed form, dimensionally consistent, for what no other law describes");
    law->closed_form = true;
    laws_.push_back(std::move(*law));
  }

  const TextSite& site_;
  const TextPlant& plant_;
  const Faults& faults_;
  std::vector<Law> laws_;
};

}  // namespace

bool has_curves(const TextSite& site) {
  return site.kind == SiteKind::own && site.size &&
         std::ranges::all_of(site.signals, [](const TextSignal& signal) { return signal.size.has_value(); });
}

std::vector<Law> curves_at_sites(const TextPlant& plant, const Faults& faults) {
  std::vector<Law> laws;
  for (const TextSite& site : plant.sites) {
    if (has_curves(site)) std::ranges::move(Curves(site, plant, faults).all(), std::back_inserter(laws));
  }
  return laws;
}

}  // namespace sealwatch::equations
