// An instance of the model in a binary, whatever its version of FMI. Lives in sealwatch-fmu-host alone: the binary may
// do anything. Every function throws Failure where the binary does not answer ok (a warning is ok).
#pragma once

#include <dlfcn.h>

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "services/common/fmi/fmi_functions.hpp"
#include "services/common/fmi/host_protocol.hpp"

namespace sealwatch::fmi {

struct Failure {
  std::string text;
};

struct EventOutcome {
  bool terminate = false;
  bool values_changed = false;
  double next_time_s = 0.0;  ///< infinite: none is known
};

struct StepOutcome {
  bool event = false;
  bool terminate = false;
};

/// A step of Co-Simulation.
struct CoStep {
  bool terminate = false;
  double reached_s = 0.0;
};

/// A variable that is set once, to numbers with spaces between them or to a text.
struct Constant {
  Handle handle;
  std::string text;
  bool structural = false;
};
[[nodiscard]] std::vector<Constant> constants_of(const Setup& setup);
[[nodiscard]] std::vector<double> numbers_of(const Constant& constant);

/// Variables that are set or read together.
struct Group {
  explicit Group(std::vector<Handle> variables);
  std::vector<Handle> handles;
  std::vector<Reference> references;
  std::size_t size = 0;     ///< elements
  bool all_float64 = true;  ///< one call serves them all
};

/// The binary, opened.
class Library {
 public:
  explicit Library(const std::string& file);
  /// The function of that name; Failure where it is needed and absent.
  template <class Function>
  [[nodiscard]] Function* find(const char* name, bool needed = true) const {
    return reinterpret_cast<Function*>(symbol(name, needed));
  }

 private:
  [[nodiscard]] void* symbol(const char* name, bool needed) const;
  void* handle_ = nullptr;
};

class FmiInstance {
 public:
  virtual ~FmiInstance() = default;
  /// Of a new instance.
  virtual void set_constants(std::span<const Constant> constants) = 0;
  /// Initialises with these values, and settles the first event; then it is in continuous-time mode (or ready to step).
  /// It will not go beyond the stop time, which is infinite where none is known.
  virtual EventOutcome initialise(double start_time, double stop_time, const Group& parameters,
                                  std::span<const double> parameter_values, const Group& inputs,
                                  std::span<const double> input_values) = 0;
  virtual void set(const Group& group, std::span<const double> values) = 0;
  virtual void get(const Group& group, std::span<double> values) = 0;
  virtual void set_time(double time) = 0;
  virtual void set_states(std::span<const double> states) = 0;
  virtual void get_states(std::span<double> states) = 0;
  virtual void get_nominals(std::span<double> nominals) = 0;
  virtual void get_derivatives(std::span<double> derivatives) = 0;
  virtual void get_event_indicators(std::span<double> indicators) = 0;
  virtual void directional(std::span<const Reference> unknowns, std::span<const Reference> knowns,
                           std::span<const double> seed, std::span<double> sensitivity) = 0;
  virtual void enter_event_mode() = 0;
  /// Settles an event that was entered and goes back to continuous-time mode.
  virtual EventOutcome settle_event() = 0;
  virtual StepOutcome completed_step() = 0;
  virtual CoStep do_step(double time, double step) = 0;
};

/// What the binary said, newest last; shortened to what fits an error.
class Messages {
 public:
  void add(int status, const std::string& category, const std::string& message);
  [[nodiscard]] std::string last() const { return text_; }
  void clear() { text_.clear(); }
  /// From now on the newest stands here too, ended by a zero byte, the moment it is said: it outlives the process.
  void keep_in(std::span<char> room) { room_ = room; }

 private:
  void keep(std::string_view text) const;
  std::string text_;
  std::span<char> room_;
};
[[nodiscard]] Messages& messages();

/// Throws Failure unless the status is ok or a warning.
void check(int status, const char* function);

using MakeInstance = std::function<std::unique_ptr<FmiInstance>()>;
/// Look up all functions once; each call of what they return makes an instance.
[[nodiscard]] MakeInstance fmi2_instances(const Library& library, const Setup& setup);
[[nodiscard]] MakeInstance fmi3_instances(const Library& library, const Setup& setup);

}  // namespace sealwatch::fmi
