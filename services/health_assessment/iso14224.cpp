#include "services/health_assessment/iso14224.hpp"

namespace sealwatch {

FailureCode failure_code(FaultKind kind) {
  switch (kind) {
    case FaultKind::internal_leakage:
      return {"INL", "1.1 Leakage"};  // internal leakage of utility fluid
    case FaultKind::friction:
      return {"DOP", "1.6 Sticking"};  // delayed operation
    case FaultKind::pump:
      return {"LOO", "2.4 Wear"};  // low output
    case FaultKind::sensor:
      return {"AIR", "3.3 Faulty signal/indication/alarm"};  // abnormal instrument reading
    case FaultKind::load:
      return {"OTH", "5.3 Miscellaneous external influences"};  // the valve or the well, not the actuator
    case FaultKind::driver:
      return {"DOP", "4.4 Faulty power/voltage"};
  }
  return {"UNK", "6.4 Unknown"};
}

}  // namespace sealwatch
