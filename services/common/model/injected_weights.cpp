#include "services/common/model/injected_weights.hpp"

#include <algorithm>

namespace sealwatch {

InjectedWeights::InjectedWeights(InjectedColumns* columns) : columns_(columns) {
  const std::size_t size = columns == nullptr ? 0 : columns->entries().size();
  for (Node& node : nodes_) node.weights.assign(size, 0.0);
  between_.assign(size, 0.0);
}

std::span<const double> InjectedWeights::weigh(double t, InjectedColumns::Signals signals) {
  if (known_ > 0 && t < nodes_.front().time) known_ = 0;
  if (known_ == 0 || t > nodes_.front().time) {
    std::ranges::rotate(nodes_, nodes_.end() - 1);
    known_ = std::min(known_ + 1, kNodes);
  }
  nodes_.front().time = t;
  columns_->weigh(t, signals, nodes_.front().weights);
  return nodes_.front().weights;
}

std::span<const double> InjectedWeights::at(double t) {
  if (known_ < 2 || t >= nodes_.front().time) return nodes_.front().weights;
  std::ranges::fill(between_, 0.0);
  for (std::size_t j = 0; j < known_; ++j) {
    double factor = 1.0;
    for (std::size_t i = 0; i < known_; ++i)
      if (i != j) factor *= (t - nodes_[i].time) / (nodes_[j].time - nodes_[i].time);
    for (std::size_t e = 0; e < between_.size(); ++e) between_[e] += factor * nodes_[j].weights[e];
  }
  return between_;
}

}  // namespace sealwatch
