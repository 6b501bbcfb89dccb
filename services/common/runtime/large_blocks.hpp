// Memory of large tests goes back to the system as soon as nobody needs it. glibc raises its threshold, up to 32 MB, with
// each large block that is freed; the matrices of many megabytes that then come and go leave holes in the heap.
#pragma once

#include <malloc.h>

namespace sealwatch {

/// To be called once, before there are other threads. A usual test's blocks are smaller, and stay in the heap.
inline void give_large_blocks_back() {
  mallopt(M_MMAP_THRESHOLD, 4 << 20);
  mallopt(M_TRIM_THRESHOLD, 16 << 20);
}

}  // namespace sealwatch
