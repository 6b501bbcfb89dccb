#include "services/common/model/native_plant.hpp"
#include "services/common/model/plants/eha_switched/model.hpp"

namespace sealwatch {

PlantDescription describe_eha_switched();

namespace plants {

NativePlant eha_switched() { return native_plant<EhaSwitchedModel>(describe_eha_switched()); }

}  // namespace plants
}  // namespace sealwatch
