// The layer's settings: those of the configuration.
#pragma once

#include "sealwatch/config/advice.hpp"

namespace sealwatch::advisory_generation {

using Options = AdviceOptions;

}  // namespace sealwatch::advisory_generation
