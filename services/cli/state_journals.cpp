#include "services/cli/state_journals.hpp"

#include <filesystem>
#include <utility>

#include "services/cli/session.hpp"
#include "services/common/runtime/configuration_loader.hpp"
#include "services/common/store/journal.hpp"

namespace sealwatch::cli {
namespace {

namespace fs = std::filesystem;

/// Connection strings by service.
std::optional<std::map<std::string, std::string>> connections_of(const std::string& state_directory,
                                                                 const std::string& config) {
  std::map<std::string, std::string> connections;
  if (!state_directory.empty()) {
    for (const std::string& service : service_names())
      connections[service] = "sqlite3://" + (fs::path(state_directory) / (service + ".db")).string();
    return connections;
  }
  const std::optional<Configuration> configuration = load_or_explain(config);
  if (!configuration) return std::nullopt;
  for (const auto& [service, settings] : configuration->services) connections[service] = settings.journal;
  return connections;
}

bool is_missing(const std::string& connection) {
  std::error_code none;
  return connection.starts_with("sqlite3://") && !fs::exists(Journal::file_of(connection), none);
}

}  // namespace

std::optional<StateJournals> StateJournals::open(const std::string& state_directory, const std::string& config) {
  const auto connections = connections_of(state_directory, config);
  if (!connections) return std::nullopt;
  StateJournals found;
  std::string example;
  for (const auto& [service, connection] : *connections) {
    if (is_missing(connection)) {
      example = fs::absolute(Journal::file_of(connection)).parent_path().lexically_normal().string();
      continue;
    }
    Result<JournalReader> journal = JournalReader::open(connection, service);
    if (!journal) {
      complain(journal.error());
      return std::nullopt;
    }
    found.journals_.push_back(std::move(*journal));
  }
  found.place_ = state_directory.empty() ? "the journals of " + config : state_directory;
  if (!found.journals_.empty()) return found;
  complain(Error{.file = example,
                 .place = {},
                 .value = {},
                 .rule = "holds no journal of a service",
                 .advice = "give their state directory with --state: demo/state after deploy/demo.sh, "
                           "/var/lib/sealwatch where the package runs them"});
  return std::nullopt;
}

Result<std::optional<StateJournals::Kept>> StateJournals::find(const std::string& message_id) {
  for (JournalReader& journal : journals_) {
    auto message = journal.output(message_id);
    if (!message) return fail(message.error());
    if (*message) return Kept{std::move(**message), journal.place()};
  }
  return std::nullopt;
}

Result<bool> StateJournals::received(const std::string& message_id) {
  for (JournalReader& journal : journals_) {
    auto known = journal.has_input(message_id);
    if (!known || *known) return known;
  }
  return false;
}

Result<std::vector<std::string>> StateJournals::ids(Topic topic, const std::string& asset_id) {
  for (JournalReader& journal : journals_) {
    auto ids = journal.output_ids(topic, asset_id);
    if (!ids || !ids->empty()) return ids;  // one service writes a topic
  }
  return std::vector<std::string>{};
}

Result<std::vector<std::string>> StateJournals::assets(Topic topic) {
  for (JournalReader& journal : journals_) {
    auto assets = journal.assets(topic);
    if (!assets || !assets->empty()) return assets;
  }
  return std::vector<std::string>{};
}

Result<std::vector<Message>> StateJournals::all(Topic topic, const std::string& asset_id) {
  for (JournalReader& journal : journals_) {
    auto messages = journal.outputs(topic, asset_id);
    if (!messages || !messages->empty()) return messages;
  }
  return std::vector<Message>{};
}

}  // namespace sealwatch::cli
