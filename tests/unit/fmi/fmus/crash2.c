/* Follows a null pointer at its first derivative after t = 0.5 s, and tells its logger before. */
static void (*say)(void*, const char*, int, const char*, const char*, ...);
#define MODEL_BEFORE_INSTANTIATE(callbacks) say = callbacks->logger;
#define DERIVATIVES_BEGIN                                                                            \
  if (t > 0.5) {                                                                                     \
    say(0, "test", 1, "solver", "step %d of %s\n\033[2J is \377 singular", 7, "the oil's equation"); \
    *(volatile int*)0 = 1;                                                                           \
  }
#include "spring_return2.c"
