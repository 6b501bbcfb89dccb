/* Never comes back from a derivative after t = 0.5 s. */
static volatile int for_ever = 1;
#define DERIVATIVES_BEGIN while (t > 0.5 && for_ever) {}
#include "spring_return2.c"
