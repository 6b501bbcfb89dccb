/* Ends its program, after a word, at a derivative after t = 0.5 s. */
#include <stdio.h>
#include <stdlib.h>
#define DERIVATIVES_BEGIN if (t > 0.5) { puts("tired of this"); exit(7); }
#include "spring_return2.c"
