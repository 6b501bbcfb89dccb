// Memory of large tests goes back to the system as soon as nobody needs it. glibc raises its threshold, up to 32 MB, with
// each large block that is freed; the matrices of many megabytes that then come and go leave holes in the heap. And it
// makes a heap for nearly each thread: what one layer's thread has given back, no other layer's can use.
#pragma once

#include <malloc.h>

namespace sealwatch {

/// To be called once, before there are other threads. A usual test's blocks are smaller, and stay in the heap.
inline void give_large_blocks_back() {
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
  mallopt(M_TRIM_THRESHOLD, 16 << 20);
  mallopt(M_ARENA_MAX, 2);
}

/// For a command that searches: the matrices of one simulation, up to 8 MB each, stay for the next. Else the system gives
/// and clears every page of them anew, which takes a quarter of the time of explain.
inline void keep_blocks_of_a_search() {
  mallopt(M_MMAP_THRESHOLD, 8 << 20);
  mallopt(M_TRIM_THRESHOLD, 128 << 20);
  mallopt(M_TOP_PAD, 64 << 20);
}

}  // namespace sealwatch
