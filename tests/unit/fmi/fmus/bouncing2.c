#include "bouncing.h"
#include "services/common/fmi/export/fmi2_shell.c"
