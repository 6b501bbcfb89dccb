// A piece of work tried in a copy of this process, so that nothing it does can end this one: what it concludes there is
// thrown away, only how it ended counts. The copy has this thread alone and no open file, and ends with its maker. What
// other threads had locked stays locked in it: memory and streams the C library sees to, the log is silent, FMUs get
// processes of their own, and what layers share is locked by a FreeInCopies (core/process_copy.hpp). So a layer may do
// there whatever it does here.
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
  /// `deadline`: of a processor's time, or `by_clock`, as for other work (workers.hpp). None where no process can be
  /// made.
  [[nodiscard]] static std::unique_ptr<Trial> begin(const std::function<void()>& work,
                                                    std::chrono::milliseconds deadline,
                                                    std::chrono::milliseconds by_clock);
  ~Trial();
  Trial(const Trial&) = delete;
  Trial& operator=(const Trial&) = delete;
  /// None while it goes on; "" when it ended well, else what became of it.
  [[nodiscard]] std::optional<std::string> result();

 private:
  Trial(pid_t process, int words, std::chrono::milliseconds deadline, std::chrono::milliseconds by_clock);
  [[nodiscard]] std::string told() const;
  [[nodiscard]] bool is_overdue() const;

  pid_t process_;
  int words_;  ///< what it says before it ends
  std::chrono::steady_clock::time_point begun_;
  std::chrono::milliseconds deadline_;
  std::chrono::milliseconds by_clock_;
};

}  // namespace sealwatch
