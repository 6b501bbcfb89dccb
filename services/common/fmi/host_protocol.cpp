#include "services/common/fmi/host_protocol.hpp"

#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cmath>
#include <ctime>

namespace sealwatch::fmi {
namespace {

/// Some microseconds: a derivative of a small model takes less than waking a sleeping process.
constexpr int kLooks = 300;

void rest_a_moment() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

long futex(const std::atomic<std::uint32_t>& word, int operation, std::uint32_t value, const timespec* timeout) {
  return syscall(SYS_futex, reinterpret_cast<const std::uint32_t*>(&word), operation, value, timeout, nullptr, 0);
}

template <class Visitor, class SetupType>
void visit(Visitor&& visitor, SetupType& setup) {
  visitor.texts(setup.library, setup.folder, setup.resources, setup.token, setup.constant_texts);
  visitor.numbers(setup.fmi3, setup.co_simulation, setup.once_per_process, setup.state_directional,
                  setup.output_directional, setup.event_indicators, setup.continuous_inputs, setup.structural);
  visitor.lists(setup.states, setup.derivatives, setup.parameters, setup.constants, setup.inputs, setup.outputs,
                setup.dependencies);
}

struct Putter {
  Packer& packer;
  void texts(auto&... text) { (packer.put_text(text), ...); }
  void numbers(auto&... number) { (packer.put(number), ...); }
  template <class... Items>
  void lists(const std::vector<Items>&... list) {
    (packer.put_list(std::span<const Items>(list)), ...);
  }
};

struct Getter {
  Unpacker& unpacker;
  void texts(auto&... text) { ((text = unpacker.text()), ...); }
  void numbers(auto&... number) { ((number = unpacker.get<std::uint32_t>()), ...); }
  template <class... Items>
  void lists(std::vector<Items>&... list) {
    ((list = unpacker.list<Items>()), ...);
  }
};

}  // namespace

void put_setup(Packer& packer, const Setup& setup) { visit(Putter{packer}, setup); }

Setup get_setup(Unpacker& unpacker) {
  Setup setup;
  visit(Getter{unpacker}, setup);
  return setup;
}

bool wait_while(const std::atomic<std::uint32_t>& word, std::uint32_t old, double seconds) {
  static const bool looking_helps = sysconf(_SC_NPROCESSORS_ONLN) > 1;
  for (int look = 0; looking_helps && look < kLooks; ++look) {
    if (word.load(std::memory_order_acquire) != old) return true;
    rest_a_moment();
  }
  const timespec timeout{static_cast<std::time_t>(seconds), static_cast<long>((seconds - std::floor(seconds)) * 1e9)};
  if (word.load(std::memory_order_acquire) == old) futex(word, FUTEX_WAIT, old, &timeout);
  return word.load(std::memory_order_acquire) != old;
}

void store_and_wake(std::atomic<std::uint32_t>& word, std::uint32_t value) {
  word.store(value, std::memory_order_release);
  futex(word, FUTEX_WAKE, 1, nullptr);
}

}  // namespace sealwatch::fmi
