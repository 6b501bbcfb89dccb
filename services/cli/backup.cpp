// `sealwatch backup` and `sealwatch restore`: copies of the services' journals, and their way back.
#include "services/common/store/backup.hpp"

#include <cstdio>
#include <filesystem>

#include "services/cli/commands.hpp"
#include "services/cli/session.hpp"
#include "services/cli/state_journals.hpp"
#include "services/common/store/journal.hpp"
#include "services/common/store/journal_lock.hpp"

namespace sealwatch::cli {
namespace {

namespace fs = std::filesystem;

fs::path copy_of(const std::string& directory, const std::string& service) {
  return fs::path(directory) / (service + ".db");
}

/// The copy is whole, and no service has the journal open.
Status may_be_restored(const fs::path& copy, const std::string& connection, const std::string& service) {
  if (Status whole = check_copy(copy.string(), connection, service); !whole) return whole;
  if (is_missing(connection)) return {};
  const auto lock = JournalLock::take(Journal::file_of(connection));
  return lock ? Status() : fail(lock.error());
}

}  // namespace

int run_backup(const BackupOptions& options) {
  const auto connections = journals_at_hand(options.state_directory, options.config);
  if (!connections) return kBadInput;
  std::error_code failed;
  fs::create_directories(options.directory, failed);
  for (const auto& [service, connection] : *connections) {
    const fs::path copy = copy_of(options.directory, service);
    if (const Status done = back_up_journal(connection, service, copy.string()); !done) {
      complain(done.error());
      return kBadInput;
    }
    std::printf("%s: %ju bytes\n", copy.c_str(), static_cast<std::uintmax_t>(fs::file_size(copy, failed)));
  }
  return kOk;
}

int run_restore(const BackupOptions& options) {
  const auto connections = journal_connections(options.state_directory, options.config);
  if (!connections) return kBadInput;
  std::error_code none;
  for (const auto& [service, connection] : *connections)
    if (const fs::path copy = copy_of(options.directory, service);
        !is_missing(connection) && fs::equivalent(copy, Journal::file_of(connection), none)) {
      complain(Error{.file = copy.string(),
                     .place = {},
                     .value = {},
                     .rule = "is the journal that would be replaced, not a copy of it",
                     .advice = "name the directory that `sealwatch backup` wrote to"});
      return kBadInput;
    }
  // All or nothing: who is refused one copy has all journals as they were.
  for (const auto& [service, connection] : *connections)
    if (const fs::path copy = copy_of(options.directory, service); fs::exists(copy, none))
      if (const Status free = may_be_restored(copy, connection, service); !free) {
        complain(free.error());
        return kBadInput;
      }
  bool found = false;
  for (const auto& [service, connection] : *connections) {
    const fs::path copy = copy_of(options.directory, service);
    if (!fs::exists(copy, none)) continue;
    found = true;
    const auto aside = restore_journal(copy.string(), connection, service);
    if (!aside) {
      complain(aside.error());
      return kBadInput;
    }
    std::printf("%s: restored%s\n", service.c_str(),
                aside->empty() ? "" : ("; what was there is now " + *aside).c_str());
  }
  if (found) return kOk;
  complain(Error{.file = options.directory,
                 .place = {},
                 .value = {},
                 .rule = "holds no copy of a journal",
                 .advice = "name the directory that `sealwatch backup` wrote to"});
  return kBadInput;
}

}  // namespace sealwatch::cli
