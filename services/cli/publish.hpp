// `sealwatch publish`: tests from any program, as JSON lines.
#pragma once

#include <string>

namespace sealwatch::cli {

struct PublishOptions {
  std::string config;
};
int run_publish(const PublishOptions& options);

}  // namespace sealwatch::cli
