// sealwatch-fmu-host: the process in which the binary of an FMU runs, started by sealwatch alone (host_process.cpp).
// Whatever the binary does, it does here: a crash ends this process and becomes an error there. It answers for the binary
// value by value (fmu_host.hpp), or runs whole simulations with it (plant_host.hpp).
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <mutex>
#include <set>
#include <thread>

#include "services/common/fmi/fmu_host.hpp"
#include "services/common/fmi/host_process.hpp"
#include "services/common/fmi/plant_host.hpp"

namespace sealwatch::fmi {
namespace {

/// Ends the process and its group with sealwatch, also in the middle of a call, and takes the unpacked FMU along where
/// sealwatch was killed and could not.
class Cleaner {
 public:
  void watch() {
    std::thread([this] { end_with_sealwatch(); }).detach();
  }
  void take_along(std::string folder) {
    const std::scoped_lock lock(mutex_);
    folder_ = std::move(folder);
  }

 private:
  [[noreturn]] void end_with_sealwatch() {
    char nothing = 0;
    while (read(kLifeDescriptor, &nothing, 1) > 0) {
    }
    const std::scoped_lock lock(mutex_);
    std::error_code ignored;
    if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
    if (getpgrp() == getpid()) kill(0, SIGKILL);  // with what the binary has started
    _exit(0);
  }
  std::mutex mutex_;
  std::string folder_;
};
Cleaner& cleaner() {
  static Cleaner one;
  return one;
}

std::string words_of(const Failure& failure) {
  const std::string said = messages().last();
  return failure.text + (said.empty() ? "" : "; it said: " + said);
}

std::string words_of(const std::exception& error) {
  return std::string("the process has no memory left: ") + error.what();
}

class Server;

/// The binary within a simulation that runs here.
class HostHere final : public LocalHost {
 public:
  HostHere(Server& server, const Setup& setup);
  ~HostHere() override;
  [[nodiscard]] std::optional<std::string> serve(Operation operation, double time_s,
                                                 std::span<std::byte> heap) override;
  void end() {
    if (host_) host_->serve(Operation::end, {});
  }

 private:
  Server& server_;
  std::unique_ptr<FmuHost> host_;
  std::string fault_;  ///< why there is none
};

class Server final : public Conversation {
 public:
  Server(SharedHeader& header, std::span<std::byte> heap) : header_(header), heap_(heap), plant_(*this) {
    messages().keep_in(header_.said);
    local_hosts() = [this](const Setup& setup) { return std::make_unique<HostHere>(*this, setup); };
  }

  [[noreturn]] void serve() {
    for (;;) {
      await_request();
      const bool last = header_.operation == Operation::end;
      serve_one();
      if (last) _exit(0);  // without the binary's own ideas of how a program ends
    }
  }

  void ask() override {
    answer(AnswerStatus::asks, "");
    await_request();
    if (header_.stop.load() != 0) plant_.stop();
  }
  [[nodiscard]] std::span<std::byte> heap() override { return heap_; }

  /// Written down before and after each call of the binary, for the process that watches.
  void note_call(Operation operation, double time_s) {
    header_.inside = operation;
    header_.at_s = time_s;
    header_.calls.fetch_add(1, std::memory_order_relaxed);
    if (header_.stop.load(std::memory_order_relaxed) != 0) plant_.stop();
  }

  std::set<HostHere*> here;

 private:
  void await_request() {
    constexpr double kLong_s = 3600.0;
    while (!wait_while(header_.requests, served_, kLong_s)) {
    }
    served_ = header_.requests.load();
  }

  void answer(AnswerStatus status, const std::string& text) {
    header_.status = status;
    const std::string shortened = text.substr(0, kTextBytes - 1);
    std::copy(shortened.begin(), shortened.end(), header_.text);
    header_.text[shortened.size()] = '\0';
    store_and_wake(header_.answers, header_.requests.load());
  }

  void serve_one() {
    messages().clear();
    try {
      serve(header_.operation);
      answer(AnswerStatus::ok, messages().last());
    } catch (const Failure& failure) {
      answer(AnswerStatus::failed, words_of(failure));
    } catch (const std::exception& error) {
      answer(AnswerStatus::failed, words_of(error));
    }
  }

  void serve(Operation operation) {
    Unpacker request(heap_);
    switch (operation) {
      case Operation::load: {
        Setup setup = get_setup(request);
        cleaner().take_along(setup.folder);
        host_ = std::make_unique<FmuHost>(std::move(setup));
        return;
      }
      case Operation::load_plant: {
        Unpacker look = request;
        cleaner().take_along(get_plant(look).fmu_folder);
        return plant_.load(request);
      }
      case Operation::simulation:
        return plant_.make_simulation(request);
      case Operation::run:
        return plant_.run(request);
      case Operation::end:
        for (HostHere* one : here) one->end();
        [[fallthrough]];
      default:
        if (host_) host_->serve(operation, heap_);
    }
  }

  SharedHeader& header_;
  std::span<std::byte> heap_;
  std::uint32_t served_ = 0;
  std::unique_ptr<FmuHost> host_;
  PlantHost plant_;
};

HostHere::HostHere(Server& server, const Setup& setup) : server_(server) {
  server_.here.insert(this);
  try {
    host_ = std::make_unique<FmuHost>(setup);
  } catch (const Failure& failure) {
    fault_ = words_of(failure);
  }
}

HostHere::~HostHere() { server_.here.erase(this); }

std::optional<std::string> HostHere::serve(Operation operation, double time_s, std::span<std::byte> heap) {
  if (!host_) return fault_;
  messages().clear();
  server_.note_call(operation, time_s);
  std::optional<std::string> failed;
  try {
    host_->serve(operation, heap);
  } catch (const Failure& failure) {
    failed = words_of(failure);
  } catch (const std::exception& error) {
    failed = words_of(error);
  }
  server_.note_call(Operation::run, time_s);
  return failed;
}

int run() {
  struct stat about {};
  if (fstat(kSharedMemoryDescriptor, &about) != 0 || about.st_size < static_cast<off_t>(sizeof(SharedHeader))) {
    std::fputs("sealwatch-fmu-host is started by sealwatch, to run a Functional Mock-up Unit in\n", stderr);
    return 2;
  }
  const auto size = static_cast<std::size_t>(about.st_size);
  void* memory = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, kSharedMemoryDescriptor, 0);
  if (memory == MAP_FAILED) return 3;
  auto& header = *static_cast<SharedHeader*>(memory);
  const std::span<std::byte> heap(static_cast<std::byte*>(memory) + sizeof(SharedHeader), size - sizeof(SharedHeader));
  cleaner().watch();
  static Server server(header, heap);
  server.serve();
}

}  // namespace
}  // namespace sealwatch::fmi

int main() {
  std::setvbuf(stdout, nullptr, _IONBF, 0);  // a binary's last words are there, however it ends
  return sealwatch::fmi::run();
}
