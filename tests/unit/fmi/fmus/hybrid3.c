#include "hybrid3.h"
