// Copies of this process that go on with its work, and the locks that such a copy takes.
//
// A copy has the one thread that made it: what another thread has locked just then is locked in it for ever, and what it
// was changing is half changed. Therefore no copy is made while anybody holds a FreeInCopies, and whoever wants one
// meanwhile waits. Held inside each other, they are one: a copy waits for the outermost.
//
// A lock that is shared by threads, and that a layer's work may take, is a FreeInCopies. A child that becomes another
// program at once takes none and needs none of this.
#pragma once

#include <sys/types.h>

#include <mutex>

namespace sealwatch {

/// A mutex that no copy of the process finds locked. To be held shortly, and not by a thread that makes a copy. What is
/// made at its first use is made under it: a copy would wait for the thread that was making it, too.
class FreeInCopies {
 public:
  void lock();
  void unlock();

 private:
  std::mutex mutex_;
};

/// fork(), when nobody holds a FreeInCopies.
[[nodiscard]] pid_t copy_process();

}  // namespace sealwatch
