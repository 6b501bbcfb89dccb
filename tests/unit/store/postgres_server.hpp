// A PostgreSQL server of a test's own, where Debian's postgresql is installed: in a fresh folder, on a socket in it, and
// gone with the test. It refuses to run as root: a test that does starts it as user postgres or nobody.
#pragma once

#include <fcntl.h>
#include <grp.h>
#include <pwd.h>
#include <soci/soci.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

namespace sealwatch {

class PostgresServer {
 public:
  /// Of the one of this process, started when it is asked for first; "" where there can be none.
  static const std::string& connection() {
    static const PostgresServer server;
    return server.connection_;
  }
  PostgresServer(const PostgresServer&) = delete;
  PostgresServer& operator=(const PostgresServer&) = delete;

 private:
  PostgresServer() {
    const std::filesystem::path programs = newest();
    std::string folder = (std::filesystem::temp_directory_path() / "sealwatch_postgres_XXXXXX").string();
    if (programs.empty() || ::mkdtemp(folder.data()) == nullptr) return;
    folder_ = folder;
    for (const char* const name : {"postgres", "nobody"})
      if (user_ == nullptr && ::getuid() == 0) user_ = ::getpwnam(name);
    if (::getuid() == 0 && (user_ == nullptr || ::chown(folder.c_str(), user_->pw_uid, user_->pw_gid) != 0)) return;
    const std::string data = folder + "/data";
    const pid_t made =
        run({programs / "initdb", "-D", data, "-U", "test", "-A", "trust", "-E", "UTF8", "--locale=C", "--no-sync"});
    int status = 0;
    if (made < 0 || ::waitpid(made, &status, 0) != made || status != 0) return;
    server_ = run({programs / "postgres", "-D", data, "-k", folder, "-c", "listen_addresses=", "-c", "fsync=off"});
    const std::string connection = "host=" + folder + " dbname=postgres user=test";
    if (server_ > 0 && answers(connection)) connection_ = connection;
  }
  ~PostgresServer() {
    if (server_ > 0) {
      ::kill(server_, SIGINT);  // ends its sessions
      ::waitpid(server_, nullptr, 0);
    }
    std::error_code ignored;
    if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
  }

  static std::filesystem::path newest() {
    std::filesystem::path found;
    std::error_code none;
    for (const auto& version : std::filesystem::directory_iterator("/usr/lib/postgresql", none))
      if (std::filesystem::exists(version.path() / "bin/initdb")) found = std::max(found, version.path() / "bin");
    return found;
  }
  /// In a process of its own, as the server's user; it ends with this one.
  [[nodiscard]] pid_t run(const std::vector<std::string>& words) const {
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    const std::string log = folder_ + "/log";
    const pid_t child = ::fork();
    if (child != 0) return child;
    const bool is_user = user_ == nullptr ||
                         (::setgroups(0, nullptr) == 0 && ::setgid(user_->pw_gid) == 0 && ::setuid(user_->pw_uid) == 0);
    const int output = ::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
    if (!is_user || output < 0 || ::chdir("/") != 0) ::_exit(127);
    ::dup2(output, STDOUT_FILENO);
    ::dup2(output, STDERR_FILENO);
    ::prctl(PR_SET_PDEATHSIG, SIGINT);
    ::execv(arguments.front(), arguments.data());
    ::_exit(127);
  }
  static bool answers(const std::string& connection) {
    for (int tries = 0; tries < 200; ++tries) {
      try {
        soci::session("postgresql://" + connection) << "SELECT 1";
        return true;
      } catch (const std::exception&) {  // not yet
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
      }
    }
    return false;
  }

  std::string folder_;
  const passwd* user_ = nullptr;
  pid_t server_ = -1;
  std::string connection_;
};

}  // namespace sealwatch
