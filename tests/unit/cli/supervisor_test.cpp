#include "services/cli/supervisor.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace sealwatch::cli {
namespace {

using std::chrono::milliseconds;

/// The words of a second under a supervisor of one shell command.
std::vector<std::string> second_of(Supervisor& supervisor) {
  std::vector<std::string> events;
  EXPECT_TRUE(supervisor.start());
  for (int k = 0; k < 50; ++k) {
    for (const std::string& event : supervisor.tend()) events.push_back(event);
    std::this_thread::sleep_for(milliseconds(20));
  }
  return events;
}

TEST(Supervisor, StartsAgainWhatCrashes) {
  Supervisor supervisor({{.name = "crashing", .arguments = {"/bin/sh", "-c", "exit 3"}}}, milliseconds(50));
  EXPECT_GT(second_of(supervisor).size(), 4U);
  EXPECT_FALSE(supervisor.refused());
}

TEST(Supervisor, DisabledServicesAreNamed) {
  Configuration configuration;
  EXPECT_EQ(explain_disabled(configuration), "");
  configuration.services["state_detection"].enabled = false;
  configuration.services["health_assessment"].enabled = true;
  EXPECT_EQ(explain_disabled(configuration),
            "services.state_detection disabled here (enabled: false): the services after it get nothing");
}

TEST(Supervisor, DoesNotStartAgainWhatRefusesItsInput) {
  Supervisor supervisor({{.name = "refusing", .arguments = {"/bin/sh", "-c", "exit 2"}}}, milliseconds(50));
  EXPECT_EQ(second_of(supervisor), std::vector<std::string>{"refusing ended with exit status 2"});
  EXPECT_TRUE(supervisor.refused());
}

}  // namespace
}  // namespace sealwatch::cli
