#include "services/cli/state_journals.hpp"

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <utility>

#include "services/cli/session.hpp"
#include "services/common/runtime/configuration_loader.hpp"
#include "services/common/store/journal.hpp"

namespace sealwatch::cli {
namespace {

namespace fs = std::filesystem;

Error missing(const std::string& service, const std::string& connection) {
  return {.file = Journal::file_of(connection),
          .place = {},
          .value = {},
          .rule = "does not exist: the conclusions of " + service + " cannot be shown",
          .advice = "give the state directory where that service keeps it with --state, or restore it from a backup"};
}

void complain_of_none(const std::string& directory) {
  complain(Error{.file = directory,
                 .place = {},
                 .value = {},
                 .rule = "holds no journal of a service",
                 .advice = "give their state directory with --state: demo/state after deploy/demo.sh, "
                           "/var/lib/sealwatch where the package runs them"});
}

/// Under systemd each service has a directory of its own in that of all: `state_detection.db` in `state-detection`.
std::string where_it_lies(const std::string& service, const std::string& connection) {
  constexpr std::string_view kFile = "sqlite3://";
  std::error_code none;
  if (!connection.starts_with(kFile) || fs::exists(Journal::file_of(connection), none)) return connection;
  const fs::path file = Journal::file_of(connection);
  std::string folder = service;
  std::ranges::replace(folder, '_', '-');
  const fs::path own = file.parent_path() / folder / file.filename();
  return fs::is_directory(own.parent_path(), none) ? std::string(kFile) + own.string() : connection;
}

}  // namespace

std::optional<std::map<std::string, std::string>> journal_connections(const std::string& state_directory,
                                                                      const std::string& config) {
  std::map<std::string, std::string> connections;
  ConfigurationOverrides overrides;
  if (!state_directory.empty()) overrides.state_directory = state_directory;
  const auto configuration = load_configuration(config, overrides);
  if (configuration) {
    for (const auto& [service, settings] : configuration->services)
      connections[service] = where_it_lies(service, settings.journal);
    return connections;
  }
  // A state directory can be looked into where no configuration is at hand.
  if (std::error_code none; state_directory.empty() || fs::exists(config, none))
    for (const Error& error : configuration.error()) complain(error);
  if (state_directory.empty()) return std::nullopt;
  for (const std::string& service : service_names())
    connections[service] =
        where_it_lies(service, "sqlite3://" + (fs::path(state_directory) / (service + ".db")).string());
  return connections;
}

bool is_missing(const std::string& connection) {
  std::error_code none;
  return connection.starts_with("sqlite3://") && !fs::exists(Journal::file_of(connection), none);
}

std::optional<std::map<std::string, std::string>> journals_at_hand(const std::string& state_directory,
                                                                   const std::string& config) {
  auto connections = journal_connections(state_directory, config);
  if (!connections) return std::nullopt;
  std::erase_if(*connections, [](const auto& entry) { return is_missing(entry.second); });
  if (!connections->empty()) return connections;
  complain_of_none(state_directory.empty() ? config : state_directory);
  return std::nullopt;
}

std::string writer_of(Topic topic) {
  switch (topic) {
    case Topic::sample_block:
      return "data_acquisition";
    case Topic::test_window:
    case Topic::test_features:
      return "data_manipulation";
    case Topic::state_report:
      return "state_detection";
    case Topic::health_report:
    case Topic::model_discrepancy:
      return "health_assessment";
    case Topic::leakage_estimate:
    case Topic::remaining_life:
    case Topic::pst_request:
      return "prognostic_assessment";
    case Topic::advisory:
      return "advisory_generation";
    case Topic::raw_samples:
    case Topic::acknowledgement:
    case Topic::maintenance_event:
    case Topic::model_acceptance:
    case Topic::act_record:  // of several, as each keeps its own
      break;
  }
  return {};
}

std::optional<StateJournals> StateJournals::open(const std::string& state_directory, const std::string& config) {
  const auto connections = journal_connections(state_directory, config);
  if (!connections) return std::nullopt;
  StateJournals found;
  std::string example = state_directory;
  std::vector<Error> damaged;
  for (const auto& [service, connection] : *connections) {
    if (is_missing(connection)) {
      found.unread_.emplace(service, missing(service, connection));
      example = fs::absolute(Journal::file_of(connection)).parent_path().lexically_normal().string();
      continue;
    }
    Result<JournalReader> journal = JournalReader::open(connection, service);
    if (journal)
      found.journals_.emplace(service, std::move(*journal));
    else
      damaged.push_back(found.unread_.emplace(service, journal.error()).first->second);
  }
  found.place_ = state_directory.empty() ? "the journals of " + config : state_directory;
  if (!found.journals_.empty()) return found;
  for (const Error& error : damaged) complain(error);
  if (damaged.empty()) complain_of_none(example);
  return std::nullopt;
}

const Error* StateJournals::unread(const std::string& message_id) const {
  const auto topic = value_of<Topic>(message_id.substr(0, message_id.find('/')));
  const auto found = topic ? unread_.find(writer_of(*topic)) : unread_.end();
  return found == unread_.end() ? nullptr : &found->second;
}

Result<JournalReader*> StateJournals::journal_of(Topic topic) {
  const std::string service = writer_of(topic);
  if (const auto found = journals_.find(service); found != journals_.end()) return &found->second;
  if (const auto known = unread_.find(service); known != unread_.end()) return fail(known->second);
  return fail(Error{.file = place_,
                    .place = {},
                    .value = std::string(name_of(topic)),
                    .rule = "comes from outside: no service keeps it",
                    .advice = {}});
}

Result<std::optional<StateJournals::Kept>> StateJournals::find(const std::string& message_id) {
  const auto topic = value_of<Topic>(message_id.substr(0, message_id.find('/')));
  for (auto& [service, journal] : journals_) {
    if (topic && writer_of(*topic) != service) continue;  // one service writes a topic
    auto message = journal.output(message_id);
    if (!message) return fail(message.error());
    if (*message) return Kept{std::move(**message), journal.place()};
  }
  return std::nullopt;
}

Result<bool> StateJournals::received(const std::string& message_id) {
  for (auto& [service, journal] : journals_) {
    auto known = journal.has_input(message_id);
    if (!known || *known) return known;
  }
  return false;
}

Result<std::vector<std::string>> StateJournals::ids(Topic topic, const std::string& asset_id) {
  return journal_of(topic).and_then([&](JournalReader* journal) { return journal->output_ids(topic, asset_id); });
}

Result<std::vector<std::string>> StateJournals::assets(Topic topic) {
  return journal_of(topic).and_then([&](JournalReader* journal) { return journal->assets(topic); });
}

Result<std::vector<Message>> StateJournals::all(Topic topic, const std::string& asset_id) {
  return journal_of(topic).and_then([&](JournalReader* journal) { return journal->outputs(topic, asset_id); });
}

}  // namespace sealwatch::cli
