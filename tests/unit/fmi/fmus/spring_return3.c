#include "spring_return.h"
#include "fmi3_shell.h"
