// Laws that are not in the model, each as a direction in which the simulation would change: the sensitivity of all
// outputs to the law's strength at strength 0. Hidden states follow the plant's signals beside the simulation.
#pragma once

#include <vector>

#include "sealwatch/model/physics.hpp"
#include "sealwatch/model/simulation.hpp"

namespace sealwatch {

/// One strength of a law at an element, its other parameters at given values.
struct LawColumn {
  const Law* law = nullptr;
  std::vector<std::size_t> sites;  ///< of the plant
  std::vector<double> parameters;  ///< of the law; strengths count as 0
  std::size_t strength = 0;        ///< which parameter is the strength
  double unit = 1.0;               ///< the column is the change for this much of it
  double hidden = 0.0;             ///< initial hidden state
};

class LawColumns final : public InjectedColumns {
 public:
  LawColumns(std::vector<LawColumn> laws, const PlantDescription& plant);
  [[nodiscard]] std::size_t columns() const override { return laws_.size(); }
  [[nodiscard]] std::span<const Entry> entries() const override { return entries_; }
  [[nodiscard]] const std::vector<LawColumn>& laws() const { return laws_; }
  void weigh(double t, Signals signals, std::span<double> weights) override;
  /// After a run: not a number in the columns of laws that gave no finite number somewhere, the laws' columns being the
  /// last ones.
  void mark_not_finite(RowMatrix& sensitivities) const;

 private:
  /// Columns of one law with one shape: they share its hidden state and its evaluation at each site.
  struct Shape {
    struct Strength {
      std::size_t parameter = 0;  ///< of the law
      double unit = 1.0;
      std::size_t first_entry = 0;  ///< of its sites
    };
    const Law* law = nullptr;
    std::vector<std::size_t> sites;
    LawInput at;                 ///< parameters and hidden state as they are; signals as last evaluated
    double hidden_before = 0.0;  ///< at the begin of the last step
    std::vector<Strength> strengths;
    bool finite = true;  ///< everywhere so far
    [[nodiscard]] double finite_or_none(double weight);
  };
  [[nodiscard]] Shape& shape_of(const LawColumn& column, const PlantDescription& plant);
  void advance(Shape& shape, double step_s, Signals signals);
  void take_back_last_step();

  std::vector<LawColumn> laws_;
  std::vector<Shape> shapes_;
  std::vector<Entry> entries_;
  /// When the last step ended, and the signals there.
  struct End {
    double time = 0.0;
    std::vector<std::array<double, kSiteSignals>> signals;
  };
  End last_, before_;
  bool started_ = false;
};

}  // namespace sealwatch
