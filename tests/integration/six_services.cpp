#include "tests/integration/six_services.hpp"

#include <fcntl.h>
#include <soci/soci.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

#include "services/common/runtime/configuration_loader.hpp"

extern char** environ;

namespace sealwatch::testing {
namespace {

/// Enough tests for a forecast (24 months and more), with months that were never tested and one test cut short.
constexpr const char* kMonths = "40";
constexpr const char* kMissing = "0.05";
constexpr const char* kCut = "0.03";

std::string read_file(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

pid_t spawn(const std::vector<std::string>& arguments, const std::filesystem::path& output) {
  std::vector<std::string> words = arguments;
  if (!words[0].starts_with('/')) words[0] = std::string(SEALWATCH_BINARY_DIR) + "/bin/" + words[0];
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  pid_t process = -1;
  const int error = posix_spawn(&process, pointers[0], &actions, nullptr, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  EXPECT_EQ(error, 0) << words[0];
  return process;
}

Finished run_to_end(const std::vector<std::string>& arguments, const std::filesystem::path& output) {
  Finished finished;
  int status = 0;
  if (waitpid(spawn(arguments, output), &status, 0) > 0 && WIFEXITED(status)) finished.status = WEXITSTATUS(status);
  finished.output = read_file(output);
  return finished;
}

std::filesystem::path new_folder(const std::string& name) {
  std::string pattern = (std::filesystem::temp_directory_path() / ("sealwatch_" + name + "_XXXXXX")).string();
  return mkdtemp(pattern.data());
}

/// Recordings live as long as the program.
struct Recordings {
  std::filesystem::path folder = new_folder("recordings");
  std::vector<std::string> files;
  Recordings() {
    const Finished made = run_to_end(
        {"sealwatch", "simulate", "--asset", std::string(SEALWATCH_SOURCE_DIR) + "/config/assets/xt03-mv2.yaml",
         "--ageing", "--months", kMonths, "--missing", kMissing, "--cut", kCut, "--rate", "50", "--seed", "7", "--out",
         (folder / "life").string()},
        folder / "simulate.log");
    EXPECT_EQ(made.status, 0) << made.output;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "life"))
      if (entry.path().extension() == ".csv") files.push_back(entry.path().string());
    std::sort(files.begin(), files.end());
  }
  ~Recordings() { std::filesystem::remove_all(folder); }
  Recordings(const Recordings&) = delete;
  Recordings& operator=(const Recordings&) = delete;
};

}  // namespace

SixServices::SixServices() : folder_(new_folder("six_services")) {
  const std::string uri =
      "<CycloneDDS><Domain Id=\"any\"><General><Interfaces><NetworkInterface name=\"lo\" "
      "multicast=\"true\"/></Interfaces>"
      "</General><Discovery><LeaseDuration>2s</LeaseDuration><Tag>sealwatch-test-" +
      std::to_string(getpid()) + "</Tag></Discovery></Domain></CycloneDDS>";
  setenv("CYCLONEDDS_URI", uri.c_str(), 1);
}

SixServices::~SixServices() {
  if (!HasFailure()) std::filesystem::remove_all(folder_);
}

Finished SixServices::run(const std::vector<std::string>& arguments) const {
  return run_to_end(arguments, folder_ / "output.log");
}

pid_t SixServices::start(const std::vector<std::string>& arguments, const std::filesystem::path& output) const {
  return spawn(arguments, output);
}

const std::vector<std::string>& SixServices::recordings() {
  static const Recordings made;
  return made.files;
}

std::vector<cli::ServiceProgram> SixServices::programs(const std::string& state) const {
  std::vector<cli::ServiceProgram> programs = cli::service_programs(config(), state_directory(state).string());
  for (cli::ServiceProgram& service : programs)
    service.arguments[0] = program(std::filesystem::path(service.arguments[0]).filename().string());
  return programs;
}

StoredResults SixServices::stored_results(const std::string& state) const {
  StoredResults results;
  for (const std::string& service : service_names()) {
    // Read past the journal's lock: its service may run.
    soci::session sql("sqlite3://dbname=\"" + (state_directory(state) / (service + ".db")).string() +
                      "\" readonly=true timeout=5");
    std::pair<std::string, std::string> output;
    soci::statement statement = (sql.prepare << "SELECT message_id, payload FROM outputs ORDER BY ordinal",
                                 soci::into(output.first), soci::into(output.second));
    statement.execute();
    while (statement.fetch()) results[service].push_back(output);
  }
  return results;
}

}  // namespace sealwatch::testing
