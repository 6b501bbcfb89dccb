// All six layers in this process, in the order of the chain, with the mathematics they need.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sealwatch/config/configuration.hpp"
#include "sealwatch/port/estimator.hpp"
#include "sealwatch/port/layer.hpp"

namespace sealwatch::cli {

class LayerSet {
 public:
  /// Keeps a reference to `configuration`.
  [[nodiscard]] static Result<LayerSet> make(const Configuration& configuration);
  /// The layers, to be run by somebody else; this object must outlive them.
  [[nodiscard]] std::vector<std::unique_ptr<Layer>> release() { return std::move(layers_); }
  /// Topics that each layer reads, by the layer's name.
  [[nodiscard]] std::map<std::string, std::vector<std::string>> inputs_by_layer() const;

 private:
  std::shared_ptr<const Simulator> simulator_;
  std::shared_ptr<const Estimator> estimator_;
  std::vector<std::unique_ptr<Layer>> layers_;
};

}  // namespace sealwatch::cli
