/* Ends its program, after a word, at a derivative after t = 0.5 s. ABORTS: before the word is out. */
#include <stdio.h>
#include <stdlib.h>
#ifdef ABORTS
#define DERIVATIVES_BEGIN if (t > 0.5) { printf("tired of this"); abort(); }
#else
#define DERIVATIVES_BEGIN if (t > 0.5) { puts("tired of this"); exit(7); }
#endif
#include "spring_return2.c"
