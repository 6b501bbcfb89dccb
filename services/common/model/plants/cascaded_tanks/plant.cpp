#include "services/common/model/native_plant.hpp"
#include "services/common/model/plants/cascaded_tanks/model.hpp"

namespace sealwatch {

PlantDescription describe_cascaded_tanks();

namespace plants {

NativePlant cascaded_tanks() { return native_plant<CascadedTanksModel>(describe_cascaded_tanks()); }

}  // namespace plants
}  // namespace sealwatch
