// The SQL session behind a journal: opening, schema, errors. Portable SQL only: SQLite and PostgreSQL.
#pragma once

#include <soci/soci.h>

#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "services/common/store/checkpointer.hpp"
#include "services/common/store/journal.hpp"
#include "services/common/store/statements.hpp"

namespace sealwatch {

/// Raised when the layout of the tables changes; a journal of a newer version is refused, not guessed at.
inline constexpr int kJournalSchemaVersion = 1;

struct Journal::Database {
  std::string name;  ///< connection string as errors show it, without a password
  std::string service;
  soci::session sql;
  std::string writer_id;
  std::map<Topic, std::uint64_t> written;
  long long last_receipt = 0;  ///< orders the inputs
  long long last_ordinal = 0;  ///< orders the outputs
  std::uint64_t open_inputs = 0;
  std::size_t batch_rows = 0;                   ///< changed since the batch began
  std::optional<Checkpointer> checkpointer;     ///< SQLite's
  Survives synchronous = Survives::power_cuts;  ///< as SQLite is set now
  bool has_synced = false;  ///< the first batch brings the log's entry in its directory to the disk as well
  std::string file;         ///< SQLite's
  std::optional<JournalStatements> statements;  ///< after `sql`, as they must end before it

  /// Connects, sets SQLite up, creates or checks the schema. Throws soci::soci_error, std::runtime_error or Error.
  void open(const std::string& connection);
  void begin(Survives survives);
  /// Reads the counters that are kept in memory.
  void load_counters();

  /// Runs `work`, turning the library's exceptions into an Error that names the journal and what was being done.
  template <class Work>
  [[nodiscard]] auto guard(const char* doing, Work&& work) -> Result<decltype(work())> {
    try {
      if constexpr (std::is_void_v<decltype(work())>) {
        work();
        return {};
      } else {
        return work();
      }
    } catch (const Error& error) {
      return fail(error);
    } catch (const std::exception& exception) {
      return fail(describe(doing, exception.what()));
    }
  }

 private:
  [[nodiscard]] Error describe(const char* doing, const std::string& what) const;
  [[nodiscard]] bool has_table(const std::string& table);
  void create_schema();
  void check_schema();
};

}  // namespace sealwatch
