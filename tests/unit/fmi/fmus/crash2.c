/* Follows a null pointer at its first derivative after t = 0.5 s. */
#define DERIVATIVES_BEGIN if (t > 0.5) *(volatile int*)0 = 1;
#include "spring_return2.c"
