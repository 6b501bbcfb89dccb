// A binary at work in its own process: values, derivatives and events of both versions; and everything that a binary
// can do wrong is an error here.
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <thread>

#include "services/common/fmi/fmu_file.hpp"
#include "tests/unit/fmi/fmu_builder.hpp"

namespace sealwatch::fmi {
namespace {

using testing::AllOf;
using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;

struct Running {
  std::shared_ptr<const FmuFile> file;
  std::unique_ptr<FmuProcess> process;
};

std::vector<std::size_t> of(const ModelDescription& description, FmiCausality causality) {
  std::vector<std::size_t> found;
  for (std::size_t k = 0; k < description.variables.size(); ++k)
    if (description.variables[k].causality == causality) found.push_back(k);
  return found;
}

Running start(const std::string& path, std::size_t slots = 1, const ProcessLimits& limits = {}) {
  auto file = FmuFile::open(path);
  EXPECT_TRUE(file) << file.error().describe();
  const ModelDescription& description = (*file)->description();
  Selection selection{of(description, FmiCausality::parameter), of(description, FmiCausality::input),
                      of(description, FmiCausality::output)};
  auto setup = (*file)->setup(selection);
  EXPECT_TRUE(setup);
  auto process = FmuProcess::start(path, *setup, slots, limits);
  EXPECT_TRUE(process) << process.error().describe();
  return {*file, process ? std::move(*process) : nullptr};
}

constexpr std::array kSteps = {1e-7, 1e-7};
constexpr std::array kParameters = {20.0, 2e3, 1e4, 100.0};

Result<Beginning> begin_spring(FmuProcess& process) {
  static constexpr std::array kInput = {0.0};
  return process.begin(
      {.state_steps = kSteps, .input_steps = std::span(kSteps).first(1), .inputs = kInput, .parameters = kParameters});
}

class FmuProcessTest : public testing::Test {
 protected:
  TestFolder folder_;
};

TEST_F(FmuProcessTest, ValuesAndDerivativesOfBothVersions) {
  for (const char* binary : {"fmu_spring_return2", "fmu_spring_directional2", "fmu_spring_return3"}) {
    TestUnit unit = spring_return(binary);
    unit.directional = unit.binary == "fmu_spring_directional2";
    const Running fmu = start(folder_.build(unit));
    const auto beginning = begin_spring(*fmu.process);
    ASSERT_TRUE(beginning) << beginning.error().describe();
    EXPECT_THAT(beginning->states, ElementsAre(0.0, 0.0));
    EXPECT_TRUE(std::isinf(beginning->outcome.next_time_s));
    const auto value = fmu.process->evaluate(0.1, std::array{0.02, 0.3}, std::array{4.0}, {1, 1, 0});
    ASSERT_TRUE(value) << value.error().describe();
    EXPECT_THAT(value->derivatives, ElementsAre(0.3, (100.0 * 4.0 - 2e3 * 0.3 - 1e4 * 0.02) / 20.0));
    EXPECT_THAT(value->outputs, ElementsAre(0.02));
    const double close = 1e-5;  // of differences; directional derivatives are exact
    EXPECT_THAT(value->derivatives_by_state, ElementsAre(DoubleNear(0.0, close), DoubleNear(1.0, close),
                                                         DoubleNear(-500.0, close), DoubleNear(-100.0, close)));
    EXPECT_THAT(value->derivatives_by_input, ElementsAre(DoubleNear(0.0, close), DoubleNear(5.0, close)));
    EXPECT_THAT(value->outputs_by_state, ElementsAre(DoubleNear(1.0, close), DoubleNear(0.0, close)));
  }
}

TEST_F(FmuProcessTest, FurtherSlotsCarryOtherParameters) {
  const Running fmu = start(folder_.build(spring_return("fmu_spring_return3")), 2);
  static constexpr std::array kBoth = {20.0, 2e3, 1e4, 100.0, 40.0, 2e3, 1e4, 100.0};
  static constexpr std::array kInputs = {0.0, 0.0};
  const auto beginning = fmu.process->begin({.state_steps = kSteps,
                                             .input_steps = std::span(kSteps).first(1),
                                             .inputs = kInputs,
                                             .slots = 2,
                                             .parameters = kBoth});
  ASSERT_TRUE(beginning) << beginning.error().describe();
  const auto value = fmu.process->evaluate(0.0, std::array{0.0, 0.0}, std::array{4.0}, {0, 0, 1});
  ASSERT_TRUE(value) << value.error().describe();
  EXPECT_THAT(value->derivatives, ElementsAre(0.0, 20.0));
  EXPECT_THAT(value->parameter, ElementsAre(0.0, 10.0, 0.0));
}

TEST_F(FmuProcessTest, EventsOfBothVersions) {
  for (const char* binary : {"fmu_bouncing2", "fmu_bouncing3"}) {
    const Running fmu = start(folder_.build(bouncing(binary)));
    static constexpr std::array kBall = {9.81, 0.7, 3.0};
    const auto beginning =
        fmu.process->begin({.state_steps = kSteps, .input_steps = {}, .inputs = {}, .parameters = kBall});
    ASSERT_TRUE(beginning) << beginning.error().describe();
    EXPECT_THAT(beginning->states, ElementsAre(1.0, 0.0));
    EXPECT_DOUBLE_EQ(beginning->outcome.next_time_s, 0.7);
    const auto above = fmu.process->evaluate(0.1, std::array{0.5, -1.0}, {}, {});
    EXPECT_GT(above->indicators[0], 0.0);
    const auto below = fmu.process->evaluate(0.1, std::array{-0.5, -1.0}, {}, {});
    EXPECT_LT(below->indicators[0], 0.0);
    std::array state = {0.0, -4.0};
    const auto outcome = fmu.process->event(0.45, state, {});
    ASSERT_TRUE(outcome) << outcome.error().describe();
    EXPECT_TRUE(outcome->values_changed);
    EXPECT_THAT(state, ElementsAre(0.0, 0.7 * 4.0));
    const auto step = fmu.process->completed_step(0.5, state, {});
    ASSERT_TRUE(step);
    EXPECT_FALSE(step->event);
  }
}

std::string trouble(const TestFolder& folder, const char* binary, const ProcessLimits& limits = {}) {
  const Running fmu = start(folder.build(spring_return(binary)), 1, limits);
  if (const auto beginning = begin_spring(*fmu.process); !beginning) return beginning.error().describe();
  const auto early = fmu.process->evaluate(0.1, std::array{0.0, 0.0}, std::array{0.0}, {});
  EXPECT_TRUE(early) << early.error().describe();
  const auto late = fmu.process->evaluate(0.6, std::array{0.0, 0.0}, std::array{0.0}, {});
  if (late) return "no trouble";
  EXPECT_FALSE(fmu.process->alive());
  EXPECT_FALSE(fmu.process->evaluate(0.1, std::array{0.0, 0.0}, std::array{0.0}, {})) << "asked after its end";
  return late.error().describe();
}

/// As where a test is tried in a copy of its service: asked by both at once, each would get the other's answers.
TEST_F(FmuProcessTest, ACopyOfTheProcessDoesNotAskItAndLeavesItAlive) {
  const Running fmu = start(folder_.build(spring_return("fmu_spring_return2")));
  ASSERT_TRUE(begin_spring(*fmu.process));
  const auto evaluated = [&] { return fmu.process->evaluate(0.1, std::array{0.0, 0.0}, std::array{0.0}, {}); };
  const pid_t copy = fork();
  if (copy == 0) {
    const bool was_answered = static_cast<bool>(evaluated());
    const_cast<Running&>(fmu).process.reset();
    _exit(was_answered ? 1 : 0);
  }
  int status = -1;
  ASSERT_EQ(waitpid(copy, &status, 0), copy);
  EXPECT_EQ(status, 0) << "it was answered";
  EXPECT_TRUE(evaluated());
}

TEST_F(FmuProcessTest, ACrashIsAnError) {
  EXPECT_THAT(trouble(folder_, "fmu_crash2"),
              AllOf(HasSubstr("model.fmu"), HasSubstr("crashed"), HasSubstr("t = 0.6 s"),
                    HasSubstr("; it said: solver: step 7 of the oil's equation"), HasSubstr("singular"),
                    Not(HasSubstr("\033")), Not(HasSubstr("\377")), Not(HasSubstr("\n"))));
}

TEST_F(FmuProcessTest, AHangIsAnError) {
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_THAT(trouble(folder_, "fmu_hang2", {.call_s = 1.0}),
              AllOf(HasSubstr("did not answer within 1 s"), HasSubstr("its binary hangs"),
                    HasSubstr("; it said: waiting for a licence server")));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(60));
}

TEST_F(FmuProcessTest, AStartThatIsWaitedForIsTold) {
  std::vector<std::string> told;
  slow_starts() = [&](const std::string& text) { told.push_back(text); };
  EXPECT_THAT(trouble(folder_, "fmu_spring_hang2", {.start_s = 2.0, .told_s = 0.2}),
              HasSubstr("did not answer within 2 s"));
  slow_starts() = {};
  EXPECT_THAT(told, ::testing::ElementsAre(HasSubstr("model.fmu: waiting for the FMU to start, at most 2 s")));
}

// Sanitizers reserve more addresses than a process may have: then it has no limit.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST_F(FmuProcessTest, MemoryThatIsUsedUpIsToldAsThat) {
  constexpr std::uint64_t kLittle = 512ULL << 20U;
  EXPECT_THAT(trouble(folder_, "fmu_hoards2", {.memory_bytes = kLittle, .call_s = 3.0}),
              AllOf(HasSubstr("ran out of memory: it has taken 0."), HasSubstr("t = 0.6 s"),
                    HasSubstr("did not answer within 3 s"), Not(HasSubstr("hangs"))));
  EXPECT_THAT(trouble(folder_, "fmu_hoards_crashes2", {.memory_bytes = kLittle}),
              AllOf(HasSubstr("crashed: Segmentation fault; it has taken 0."), HasSubstr("of the 0.5 GiB of memory")));
}
#endif

TEST_F(FmuProcessTest, AnEndedProgramIsAnErrorWithItsLastWords) {
  EXPECT_THAT(trouble(folder_, "fmu_leaves2"), AllOf(HasSubstr("status 7"), HasSubstr("tired of this")));
}

TEST_F(FmuProcessTest, WhatAnAbortedBinaryPrintedLastIsThere) {
  EXPECT_THAT(trouble(folder_, "fmu_aborts2"), AllOf(HasSubstr("crashed: Aborted"), HasSubstr("tired of this")));
  EXPECT_THAT(trouble(folder_, "fmu_spring_mutters2"), AllOf(HasSubstr("gave no instance"), HasSubstr("no key")));
}

TEST_F(FmuProcessTest, AMissingLicenceIsAnErrorWithTheFmusWords) {
  EXPECT_THAT(trouble(folder_, "fmu_spring_licence2"),
              AllOf(HasSubstr("gave no instance"), HasSubstr("licence: no licence for 30 days"),
                    HasSubstr("a licence may be missing")));
}

/// canBeInstantiatedOnlyOncePerProcess: not a second time either, once the first is freed.
TEST_F(FmuProcessTest, AUnitThatIsInstantiatedOnceHasAProcessForEachRun) {
  TestUnit unit = spring_return("fmu_spring_once2");
  unit.interfaces = "<ModelExchange modelIdentifier=\"model\" canBeInstantiatedOnlyOncePerProcess=\"true\"/>\n";
  const Running fmu = start(folder_.build(unit));
  for (int run = 0; run < 3; ++run) {
    const auto beginning = begin_spring(*fmu.process);
    ASSERT_TRUE(beginning) << beginning.error().describe();
    const auto value = fmu.process->evaluate(0.0, std::array{0.0, 0.0}, std::array{4.0}, {});
    ASSERT_TRUE(value) << value.error().describe();
    EXPECT_THAT(value->derivatives, ElementsAre(0.0, 20.0));
  }
}

TEST_F(FmuProcessTest, AWrongTokenIsAnErrorInBothVersions) {
  for (const char* binary : {"fmu_spring_return2", "fmu_spring_return3"}) {
    TestUnit unit = spring_return(binary);
    unit.token = "{another}";
    const Running fmu = start(folder_.build(unit));
    EXPECT_THAT(begin_spring(*fmu.process).error().describe(), HasSubstr("gave no instance"));
  }
}

TEST_F(FmuProcessTest, AFunctionThatFailsIsNamed) {
  TestUnit unit = spring_return("fmu_spring_return2");
  unit.variables.replace(unit.variables.find("5000"), 4, "5001");  // an output that the binary does not have
  const Running fmu = start(folder_.build(unit));
  ASSERT_TRUE(begin_spring(*fmu.process));
  EXPECT_THAT(fmu.process->evaluate(0.0, std::array{0.0, 0.0}, std::array{0.0}, {}).error().describe(),
              HasSubstr("fmi2GetReal answered Error"));
}

/// Processes that were started with this word in their environment, zombies left out.
int marked(const std::string& mark) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    std::ostringstream environment;
    environment << std::ifstream(entry.path() / "environ", std::ios::binary).rdbuf();
    count += environment.str().find("SEALWATCH_TEST_MARK=" + mark) != std::string::npos ? 1 : 0;
  }
  return count;
}

bool comes_true(const std::function<bool()>& condition) {
  constexpr int kMost_s = 20;
  for (int look = 0; look < kMost_s * 50 && !condition(); ++look)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  return condition();
}

/// A process group that runs a unit until it is ended by a signal, with its temporary files in `temporary`.
void end_in_the_middle(const std::string& path, const std::string& temporary, int signal) {
  std::array<int, 2> loaded{};
  ASSERT_EQ(pipe(loaded.data()), 0);
  const pid_t sealwatch = fork();
  if (sealwatch == 0) {
    setpgid(0, 0);
    setenv("TMPDIR", temporary.c_str(), 1);
    const Running fmu = start(path);
    static_cast<void>(!write(loaded[1], "1", 1));
    static_cast<void>(begin_spring(*fmu.process));
    pause();
  }
  close(loaded[1]);
  char one = 0;
  ASSERT_EQ(read(loaded[0], &one, 1), 1);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));  // it is at the start of the model
  EXPECT_FALSE(std::filesystem::is_empty(temporary));
  EXPECT_EQ(kill(-sealwatch, signal), 0);
  EXPECT_EQ(waitpid(sealwatch, nullptr, 0), sealwatch);
  close(loaded[0]);
}

/// As Ctrl-C, `timeout` and a closed terminal do, which signal all processes of a group.
TEST_F(FmuProcessTest, ASignalToTheGroupLeavesNeitherProcessesNorFiles) {
  const std::string path = folder_.build(spring_return("fmu_spring_hang2"));
  const std::string temporary = (folder_ / "temporary").string();
  std::filesystem::create_directory(temporary);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGKILL}) {
    const std::string mark = std::to_string(getpid()) + "_" + std::to_string(signal);
    setenv("SEALWATCH_TEST_MARK", mark.c_str(), 1);
    end_in_the_middle(path, temporary, signal);
    EXPECT_TRUE(comes_true([&] { return std::filesystem::is_empty(temporary); })) << "signal " << signal;
    EXPECT_TRUE(comes_true([&] { return marked(mark) == 0; })) << "signal " << signal;
  }
}

/// A licence's helper and the like, one that asks for a session of its own too, in whatever way the run ends.
TEST_F(FmuProcessTest, ProcessesThatTheBinaryStartsEndWithIt) {
  const std::string path = folder_.build(spring_return("fmu_spring_forks2"));
  const std::string mark = std::to_string(getpid()) + "_forks";
  setenv("SEALWATCH_TEST_MARK", mark.c_str(), 1);
  Running fmu = start(path);
  ASSERT_TRUE(begin_spring(*fmu.process));
  EXPECT_EQ(marked(mark), 2);
  fmu.process.reset();
  EXPECT_TRUE(comes_true([&] { return marked(mark) == 0; })) << "after its end";
  end_in_the_middle(path, folder_.path(), SIGKILL);
  EXPECT_TRUE(comes_true([&] { return marked(mark) == 0; })) << "after sealwatch was killed";
}

TEST_F(FmuProcessTest, AMissingHostIsNamed) {
  const std::string path = folder_.build(spring_return("fmu_spring_return2"));
  setenv("SEALWATCH_FMU_HOST", "/nowhere/host", 1);
  auto file = FmuFile::open(path);
  ASSERT_TRUE(file);
  Selection selection;
  EXPECT_THAT(FmuProcess::start(path, *(*file)->setup(selection), 1).error().describe(), HasSubstr("/nowhere/host"));
}

}  // namespace
}  // namespace sealwatch::fmi
