// Where a test keeps its journal: a fresh directory, or a fresh schema of the PostgreSQL server that
// SEALWATCH_TEST_POSTGRESQL names ("host=127.0.0.1 dbname=test user=test"), else of one of the test's own.
#pragma once

#include <soci/soci.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/unit/store/postgres_server.hpp"

namespace sealwatch {

class Place {
 public:
  explicit Place(std::string backend = "sqlite3") : backend_(std::move(backend)) {
    static int count = 0;
    name_ = "sealwatch_test_" + std::to_string(::getpid()) + "_" + std::to_string(count++);
    if (backend_ == "sqlite3") {
      std::filesystem::create_directories(directory());
    } else if (usable()) {
      soci::session("postgresql://" + server()) << "CREATE SCHEMA " + name_;
    }
  }
  ~Place() {
    if (backend_ == "sqlite3") {
      std::error_code ignored;
      std::filesystem::permissions(directory(), std::filesystem::perms::owner_all, ignored);
      std::filesystem::remove_all(directory(), ignored);
    } else if (usable()) {
      soci::session sql("postgresql://" + server());
      sql << "SET client_min_messages = warning";
      sql << "DROP SCHEMA " + name_ + " CASCADE";
    }
  }
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;

  [[nodiscard]] bool usable() const { return backend_ == "sqlite3" || !server().empty(); }
  [[nodiscard]] static std::string why_not() {
    return "install postgresql, or set SEALWATCH_TEST_POSTGRESQL to a connection string, to test on PostgreSQL";
  }
  /// In memory where that is possible: these tests are about what is written, not about the disk.
  [[nodiscard]] std::filesystem::path directory() const {
    const std::filesystem::path memory = "/dev/shm";
    return (::access(memory.c_str(), W_OK) == 0 ? memory : std::filesystem::temp_directory_path()) / name_;
  }
  [[nodiscard]] std::string connection() const {
    if (backend_ == "sqlite3") return "sqlite3://" + (directory() / "journal.db").string();
    return "postgresql://" + server() + " options='-c search_path=" + name_ + "'";
  }
  void execute(const std::string& statement) const { soci::session(connection()) << statement; }

 private:
  static std::string server() {
    const char* text = std::getenv("SEALWATCH_TEST_POSTGRESQL");
    return text == nullptr ? PostgresServer::connection() : text;
  }
  std::string backend_;
  std::string name_;
};

}  // namespace sealwatch
