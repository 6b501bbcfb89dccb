// Prints each advisory of sealwatch as it comes, the last one of every asset first. Ctrl-C ends it.
//   advisory_subscriber [DOMAIN]
#include <csignal>
#include <cstdlib>
#include <iostream>

#include "sealwatch/client/subscriber.hpp"
#include "sealwatch/core/time.hpp"

namespace {
sealwatch::client::Subscriber* running = nullptr;
}

int main(int argc, char** argv) {
  sealwatch::client::Subscriber subscriber({.domain = argc > 1 ? std::atoi(argv[1]) : 0});

  subscriber.on<sealwatch::Advisory>([](const sealwatch::Advisory& advisory) {
    std::cout << advisory.asset_id << ": " << name_of(advisory.priority) << ": " << advisory.recommendation;
    if (advisory.latest_by_known) std::cout << " (latest by " << sealwatch::format_date({advisory.latest_by_ns}) << ")";
    std::cout << '\n';
    for (const std::string& reason : advisory.reasons) std::cout << "  because " << reason << '\n';
    std::cout << std::flush;
  });

  running = &subscriber;
  std::signal(SIGINT, [](int) { running->stop(); });
  if (const sealwatch::Status ended = subscriber.run(); !ended) {
    std::cerr << ended.error().describe() << '\n';
    return 1;
  }
}
