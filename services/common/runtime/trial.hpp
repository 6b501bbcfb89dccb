// A piece of work tried in a copy of this process, so that nothing it does can end this one: what it concludes there is
// thrown away, only how it ended counts. The copy has this thread alone and no open file, and ends with its maker. What
// other threads had locked stays locked in it: memory and streams the C library sees to, the log is silent, FMUs get
// processes of their own, and what layers share is locked by a FreeInCopies (core/process_copy.hpp). So a layer may do
// there whatever it does here. What a library locks or makes at its first use nobody can know: a copy that sleeps and
// uses no processor waits for a thread that it does not have, and another copy is made in its place.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace sealwatch {

class Trial {
 public:
  struct Limits {
    std::chrono::milliseconds deadline;                         ///< of a processor's time,
    std::chrono::milliseconds by_clock;                         ///< or so long, as for other work (workers.hpp)
    std::chrono::milliseconds still = std::chrono::seconds(5);  ///< after which a copy that sleeps is replaced
  };
  /// None where no process can be made.
  [[nodiscard]] static std::unique_ptr<Trial> begin(std::function<void()> work, const Limits& limits);
  ~Trial();
  Trial(const Trial&) = delete;
  Trial& operator=(const Trial&) = delete;
  /// None while it goes on; "" when it ended well, else what became of it.
  [[nodiscard]] std::optional<std::string> result();

 private:
  /// A process, and the end of a pipe from which its last words are read.
  struct Copy {
    pid_t process = -1;
    int words = -1;
  };
  Trial(std::function<void()> work, const Limits& limits, Copy copy);
  [[nodiscard]] static std::optional<Copy> copy_for(const std::function<void()>& work);
  void end_copy();
  [[nodiscard]] std::string told() const;
  [[nodiscard]] bool is_overdue() const;
  [[nodiscard]] bool stands_still();
  [[nodiscard]] std::optional<std::string> with_another_copy();

  std::function<void()> work_;
  Limits limits_;
  Copy copy_;
  int copies_ = 1;
  std::chrono::steady_clock::time_point begun_, moved_;  ///< the copy; its processor time, as far as was looked
  std::chrono::nanoseconds used_{0};
};

}  // namespace sealwatch
