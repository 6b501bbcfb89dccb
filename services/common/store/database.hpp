// The SQL session behind a journal: opening, schema, errors. Portable SQL only: SQLite and PostgreSQL.
#pragma once

#include <soci/soci.h>
#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "services/common/store/checkpointer.hpp"
#include "services/common/store/journal.hpp"
#include "services/common/store/journal_lock.hpp"
#include "services/common/store/packed_past.hpp"
#include "services/common/store/rows.hpp"
#include "services/common/store/statements.hpp"

namespace sealwatch {

/// Raised when the layout of the tables changes: a journal of an older version is changed when it is opened
/// (schema.cpp), one of a newer version is refused, not guessed at. Stands in table meta and, in SQLite, in user_version as well: a
/// turned bit changes only one of them.
inline constexpr int kJournalSchemaVersion = 5;

/// Table meta: that an output was found damaged while it was read.
inline constexpr const char* kToBeMended = "to_be_mended";

/// Table meta: that nobody has compared the journal with others' records of acts since it was made.
inline constexpr const char* kNewJournal = "new";

/// Table meta: number and sum of the checksums of anchors.
inline constexpr const char* kAnchorsSum = "anchors";

/// A journal that is not the one that belongs in its place.
struct OtherJournal {
  std::string writer_id;
};

struct Journal::Database {
  Database() = default;
  ~Database() { remember(); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  std::string name;  ///< connection string as errors show it, without a password
  std::string service;
  soci::session sql;
  std::string writer_id;
  std::map<Topic, std::uint64_t> written;
  long long last_receipt = 0;  ///< orders the inputs
  long long last_ordinal = 0;  ///< orders the outputs
  std::uint64_t open_inputs = 0;
  std::size_t batch_rows = 0;                                   ///< changed since the batch began
  std::optional<Checkpointer> checkpointer;                     ///< SQLite's
  Survives synchronous = Survives::power_cuts;                  ///< as SQLite is set now
  std::set<std::pair<std::string, std::string>> damaged_tests;  ///< asset, PST id
  bool packs = true;                                            ///< assets' pasts
  std::string packs_for;                                        ///< version of the program
  std::string packed_refused;  ///< of the first asset whose past is read from JSON again, with the reason
  bool told_packed_refused = false;
  long long checked = 0;            ///< outputs up to here are as they were written
  long long outputs_looked_up = 0;  ///< up to here the indexes find them
  long long inputs_looked_up = 0;
  std::optional<JournalLock> lock;  ///< SQLite's
  bool is_made = false;             ///< by this process
  bool has_all_tables = false;      ///< or had them when it was last used
  long long committed = 0;          ///< outputs, as far as they are committed
  std::chrono::steady_clock::time_point remembered;
  long long last_used_ns = 0;  ///< by the wall clock, before it was opened
  bool has_synced = false;     ///< the first batch brings the log's entry in its directory to the disk as well
  std::string file;            ///< SQLite's
  std::map<std::string, std::pair<dev_t, ino_t>> opened_files;  ///< SQLite's, by path: which files they were
  std::optional<JournalStatements> statements;                  ///< after `sql`, as they must end before it

  /// Connects, sets SQLite up, creates or checks the schema. Throws soci::soci_error, std::runtime_error or Error.
  void open(const std::string& connection);
  void begin(Survives survives);
  /// Throws Error where SQLite writes to files that nobody will find any more.
  void check_in_place();
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

  [[nodiscard]] Error describe(const char* doing, const std::string& what) const;
  [[nodiscard]] bool has_table(const std::string& table);
  void take_file(const std::string& path);
  /// Connects and sets SQLite up.
  void connect(const std::string& connection);
  /// From what is connected to a journal that can be used.
  void make_ready();
  /// In the place of what was there, which is moved aside: returned is where it is now.
  std::string make_anew(const std::string& connection);
  void note_last_used();
  /// The lock's mark, once what it says is on the disk.
  void remember();
  /// It waits for the disk.
  void remember_now_and_then();
  [[nodiscard]] bool is_file() { return sql.get_backend_name() == "sqlite3"; }

  // journal_past.cpp
  [[nodiscard]] bool has_damaged_test(const std::string& asset_id) const;
  [[nodiscard]] PackedPast packed_past_of(const std::string& asset_id);

  // schema.cpp
  void create_schema();
  void check_schema();
  [[nodiscard]] int schema_version();
  void check_meta();
  void migrate(int version);
  void make_later_tables();
  [[nodiscard]] std::string meta(const std::string& key);
  void set_meta(const std::string& key, const std::string& value);

  // journal_mend.cpp
  /// Looks for rows that are not as they were written, and prepares that they come again.
  void mend();
  void mend_positions();
  void mend_quarantine();
  void mend_inputs();
  void mend_outputs(bool all);
  void know_damaged_tests();
  void make_indexes_anew();
  void check_small_tables();
  void mark_missing_outputs();
  void check_anchors();
  // journal_check.cpp
  /// Looks whether the indexes find the next rows; false once all were looked at. Throws Error where one does not.
  bool check_indexes();
  /// Throws Error where an output is not as it was written, and has the next opening look at all of them.
  void check(const MessageRow& output);
  [[noreturn]] void must_be_mended(long long ordinal, const std::string& whose);
  /// The output, stamped, where one of its id was damaged: it now stands in its place.
  [[nodiscard]] std::optional<Message> fill_place(const Message& message, UtcTime publishing_time);
  void tell_of_journal(const std::string& reason);
  /// Whether it ends before the one that was used last, or that one is gone.
  void compare_with_last();
  void fetch_again(const std::string& topic, const std::string& writer, long long sequence);
};

}  // namespace sealwatch
