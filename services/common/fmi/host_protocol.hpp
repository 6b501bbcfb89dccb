// How sealwatch and sealwatch-fmu-host, the process in which an FMU's binary runs, speak: one piece of shared memory
// with a word for the request, a word for the answer (futexes), a text and a heap of numbers. One request is under way
// at a time. sealwatch believes nothing of what stands there but numbers: all sizes are its own.
//
//   request   operation, then what Packer has put       ->   answer   status, text, what Packer has put
#pragma once

#include <atomic>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "services/common/fmi/model_description.hpp"

namespace sealwatch::fmi {

enum class Operation : std::uint32_t {
  load,
  begin,
  evaluate,
  event,
  completed_step,
  do_step,
  load_plant,  ///< and from then on simulations of it, with the binary in this process
  simulation,
  run,
  weights,  ///< that a run asked for
  end
};
enum class AnswerStatus : std::uint32_t { ok, failed, asks };

inline constexpr std::size_t kTextBytes = 4096;
inline constexpr std::size_t kSaidBytes = 1024;
inline constexpr int kSharedMemoryDescriptor = 3;
inline constexpr int kLifeDescriptor = 4;  ///< its end says that sealwatch is gone

struct SharedHeader {
  std::atomic<std::uint32_t> requests{0};  ///< how many have been made
  std::atomic<std::uint32_t> answers{0};   ///< how many have been given
  Operation operation = Operation::load;
  AnswerStatus status = AnswerStatus::ok;
  std::uint64_t heap_bytes = 0;
  // Of a run, which takes long: how many calls of the binary it has made, the one that it is in, whether it shall end.
  std::atomic<std::uint32_t> calls{0};
  std::atomic<std::uint32_t> stop{0};
  Operation inside = Operation::end;
  double at_s = 0.0;
  char text[kTextBytes] = {};  ///< of an error: what failed, and then the binary's own last words
  char said[kSaidBytes] = {};  ///< what the binary last told its logger, for when its process gives no answer any more
};
static_assert(std::atomic<std::uint32_t>::is_always_lock_free);

/// A variable of the binary, whole.
struct Handle {
  std::uint32_t reference = 0;
  FmiType type = FmiType::float64;
  std::uint32_t size = 1;
};
[[nodiscard]] inline std::size_t elements(std::span<const Handle> handles) {
  std::size_t count = 0;
  for (const Handle& handle : handles) count += handle.size;
  return count;
}

/// What the process has to know about the binary.
struct Setup {
  std::string library, folder, resources, token;
  std::uint32_t fmi3 = 0, co_simulation = 0, once_per_process = 0;
  std::uint32_t state_directional = 0;   ///< the binary gives directional derivatives of the state derivatives
  std::uint32_t output_directional = 0;  ///< and of the outputs
  std::uint32_t event_indicators = 0;
  std::vector<Handle> states, derivatives;  ///< whole variables
  std::vector<Handle> parameters;           ///< that are set before a run, in the order of their values
  std::vector<Handle> constants;            ///< that are set before those: structural parameters first
  std::uint32_t structural = 0;             ///< how many of the constants are structural parameters
  std::string constant_texts;               ///< the value of each, ended by a zero byte
  std::vector<Handle> inputs, outputs;
  std::uint32_t continuous_inputs = 0;  ///< how many of the inputs, the first, may change outside of events
  /// Of each state derivative and output, element by element: how many states it depends on, and which. Empty: each may
  /// depend on all.
  std::vector<std::uint32_t> dependencies;
  std::string needed_tool;  ///< that must be on this machine for the binary to start; not of its business
};

/// Derivatives by state, column by column, whatever Setup::dependencies says.
inline constexpr std::uint32_t kOneByOne = 2;

/// Which numbers an evaluation answers with, in this order; f, y, z always.
struct EvaluationRequest {
  std::uint32_t by_state = 0, by_input = 0, by_parameter = 0;
};

/// Puts numbers, texts and lists one behind the other; each begins at a multiple of eight bytes. Without a heap it counts
/// how much that takes.
class Packer {
 public:
  explicit Packer(std::span<std::byte> heap = {}) : heap_(heap) {}
  [[nodiscard]] std::size_t used() const { return at_; }
  template <class T>
  void put(const T& value) {
    bytes(&value, sizeof value);
  }
  template <class T>
  void put_list(std::span<const T> values) {
    put(static_cast<std::uint64_t>(values.size()));
    bytes(values.data(), values.size_bytes());
  }
  void put_text(std::string_view text) { put_list(std::span<const char>(text)); }
  void put_numbers(std::span<const double> values) { bytes(values.data(), values.size_bytes()); }
  /// Room for numbers that are written in place.
  [[nodiscard]] std::span<double> room(std::size_t count) {
    double* first = reinterpret_cast<double*>(heap_.data() + at_);
    advance(count * sizeof(double));
    return {first, count};
  }

 private:
  void bytes(const void* from, std::size_t size) {
    const std::size_t begin = at_;
    advance(size);
    if (size > 0 && heap_.data() != nullptr) std::memcpy(heap_.data() + begin, from, size);
  }
  void advance(std::size_t size) {
    at_ += (size + 7U) / 8U * 8U;
    assert(heap_.data() == nullptr || at_ <= heap_.size());
  }
  std::span<std::byte> heap_;
  std::size_t at_ = 0;
};

class Unpacker {
 public:
  explicit Unpacker(std::span<std::byte> heap) : heap_(heap) {}
  template <class T>
  [[nodiscard]] T get() {
    T value{};
    std::memcpy(&value, place(sizeof value), sizeof value);
    return value;
  }
  template <class T>
  [[nodiscard]] std::vector<T> list() {
    const auto count = get<std::uint64_t>();
    assert(count <= heap_.size() / sizeof(T));
    std::vector<T> values(count);
    const std::byte* from = place(count * sizeof(T));
    if (count > 0) std::memcpy(values.data(), from, count * sizeof(T));
    return values;
  }
  [[nodiscard]] std::string text() {
    const std::vector<char> letters = list<char>();
    return {letters.begin(), letters.end()};
  }
  [[nodiscard]] std::span<double> numbers(std::size_t count) {
    return {reinterpret_cast<double*>(place(count * sizeof(double))), count};
  }

 private:
  std::byte* place(std::size_t size) {
    std::byte* here = heap_.data() + at_;
    at_ += (size + 7U) / 8U * 8U;
    assert(at_ <= heap_.size());
    return here;
  }
  std::span<std::byte> heap_;
  std::size_t at_ = 0;
};

void put_setup(Packer& packer, const Setup& setup);
[[nodiscard]] Setup get_setup(Unpacker& unpacker);

/// Waits until `word` is no longer `old`: looks for some microseconds, then sleeps, at most `seconds`. False: it still
/// is.
[[nodiscard]] bool wait_while(const std::atomic<std::uint32_t>& word, std::uint32_t old, double seconds);
void store_and_wake(std::atomic<std::uint32_t>& word, std::uint32_t value);

}  // namespace sealwatch::fmi
