/* Takes memory without end in a derivative after t = 0.5 s. CRASHES: and writes where it got none. */
#include <stdlib.h>
#include <string.h>
static void hoard(void) {
  const size_t some = (size_t)1 << 24;
  for (;;) {
    char* got = malloc(some);
    if (got != NULL) memset(got, 1, some);
#ifdef CRASHES
    else
      *(volatile char*)got = 1;
#endif
  }
}
#define DERIVATIVES_BEGIN \
  if (t > 0.5) hoard();
#include "spring_return2.c"
