// A wall clock that the campaign sets while a service runs (LD_PRELOAD): the offset in nanoseconds that stands in the
// file CAMPAIGN_CLOCK, eight bytes, is added to what the system says.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

static int64_t offset_ns(void) {
  static const volatile int64_t* offset = NULL;
  if (offset == NULL) {
    const char* const path = getenv("CAMPAIGN_CLOCK");
    const int file = path == NULL ? -1 : open(path, O_RDONLY | O_CLOEXEC);
    void* const mapped = file < 0 ? MAP_FAILED : mmap(NULL, sizeof(int64_t), PROT_READ, MAP_SHARED, file, 0);
    if (mapped == MAP_FAILED) return 0;
    close(file);
    offset = mapped;
  }
  return *offset;
}

int clock_gettime(clockid_t clock, struct timespec* time) {
  static int (*system_s)(clockid_t, struct timespec*) = NULL;
  if (system_s == NULL) system_s = (int (*)(clockid_t, struct timespec*))dlsym(RTLD_NEXT, "clock_gettime");
  const int failed = system_s(clock, time);
  if (failed != 0 || clock != CLOCK_REALTIME) return failed;
  const int64_t now_ns = time->tv_sec * INT64_C(1000000000) + time->tv_nsec + offset_ns();
  time->tv_sec = now_ns / INT64_C(1000000000);
  time->tv_nsec = now_ns % INT64_C(1000000000);
  return 0;
}

int gettimeofday(struct timeval* restrict time, void* restrict zone) {
  (void)zone;
  struct timespec now;
  if (clock_gettime(CLOCK_REALTIME, &now) != 0) return -1;
  time->tv_sec = now.tv_sec;
  time->tv_usec = now.tv_nsec / 1000;
  return 0;
}
