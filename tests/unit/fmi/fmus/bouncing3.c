#include "bouncing.h"
#include "fmi3_shell.h"
