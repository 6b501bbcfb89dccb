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
  /// What makes each layer for an asset, in the order of the chain; this object must outlive what they make.
  [[nodiscard]] const std::vector<LayerMaker>& makers() const { return makers_; }
  /// Topics that each layer reads, by the layer's name.
  [[nodiscard]] std::map<std::string, std::vector<std::string>> inputs_by_layer() const;

 private:
  std::shared_ptr<const Simulator> simulator_;
  std::shared_ptr<const Estimator> estimator_;
  std::vector<LayerMaker> makers_;
};

}  // namespace sealwatch::cli
