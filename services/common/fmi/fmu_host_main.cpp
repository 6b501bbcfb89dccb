// sealwatch-fmu-host: the process in which the binary of an FMU runs, started by sealwatch alone (fmu_process.cpp).
// Whatever the binary does, it does here: a crash ends this process and becomes an error there.
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <thread>

#include "services/common/fmi/fmu_host.hpp"

namespace sealwatch::fmi {
namespace {

/// Ends the process with sealwatch, also in the middle of a call, and takes the unpacked FMU along where sealwatch
/// was killed and could not.
void end_with_sealwatch(const std::string& folder) {
  char nothing = 0;
  while (read(kLifeDescriptor, &nothing, 1) > 0) {
  }
  std::error_code ignored;
  std::filesystem::remove_all(folder, ignored);
  _exit(0);
}

void answer_with(SharedHeader& header, AnswerStatus status, const std::string& text) {
  header.status = status;
  const std::string shortened = text.substr(0, kTextBytes - 1);
  std::copy(shortened.begin(), shortened.end(), header.text);
  header.text[shortened.size()] = '\0';
  store_and_wake(header.answers, header.requests.load());
}

void serve_one(SharedHeader& header, std::span<std::byte> heap, std::unique_ptr<FmuHost>& host) {
  messages().clear();
  try {
    if (header.operation == Operation::load) {
      Unpacker request(heap);
      Setup setup = get_setup(request);
      std::thread(end_with_sealwatch, setup.folder).detach();
      host = std::make_unique<FmuHost>(std::move(setup));
    } else if (host) {
      host->serve(header.operation, heap);
    }
    answer_with(header, AnswerStatus::ok, messages().last());
  } catch (const Failure& failure) {
    const std::string said = messages().last();
    answer_with(header, AnswerStatus::failed, failure.text + (said.empty() ? "" : "; it said: " + said));
  } catch (const std::exception& error) {
    answer_with(header, AnswerStatus::failed, std::string("the process has no memory left: ") + error.what());
  }
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
  std::unique_ptr<FmuHost> host;
  for (std::uint32_t served = 0;;) {
    constexpr double kLong_s = 3600.0;
    while (!wait_while(header.requests, served, kLong_s)) {
    }
    served = header.requests.load();
    const bool last = header.operation == Operation::end;
    serve_one(header, heap, host);
    if (last) _exit(0);  // without the binary's own ideas of how a program ends
  }
}

}  // namespace
}  // namespace sealwatch::fmi

int main() { return sealwatch::fmi::run(); }
