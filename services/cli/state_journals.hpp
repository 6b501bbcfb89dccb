// What the services keep, looked into without them: the journals of a state directory, or those that a configuration
// names.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "services/common/store/journal_reader.hpp"

namespace sealwatch::cli {

/// Connection strings of the services' journals, by service: those that the configuration names, or those of the state
/// directory where there is no configuration. None, and said on standard error, where neither is at hand.
[[nodiscard]] std::optional<std::map<std::string, std::string>> journal_connections(const std::string& state_directory,
                                                                                    const std::string& config);
/// Whether such a journal is a file that is not there.
[[nodiscard]] bool is_missing(const std::string& connection);
/// Likewise, of those journals that are there; none, and said, where there is none of any service.
[[nodiscard]] std::optional<std::map<std::string, std::string>> journals_at_hand(const std::string& state_directory,
                                                                                 const std::string& config);

class StateJournals {
 public:
  /// The journals that the services have with this configuration and, unless it is "", this state directory: those that
  /// the configuration names win, as with the services; without a configuration the files of the directory. A service
  /// whose journal is not here runs elsewhere, or not at all; that there is none of any service is said on standard
  /// error.
  [[nodiscard]] static std::optional<StateJournals> open(const std::string& state_directory, const std::string& config);

  struct Kept {
    Message message;
    std::string place;  ///< the journal
  };
  /// The message that a service concluded under this id.
  [[nodiscard]] Result<std::optional<Kept>> find(const std::string& message_id);
  /// Whether a service received a message of this id. What came from outside is kept by its id alone.
  [[nodiscard]] Result<bool> received(const std::string& message_id);

  // Of one topic. An Error where the journal of the service that writes it is missing or damaged.

  /// Ids of all conclusions, in the order of conclusion; of one asset unless that is "".
  [[nodiscard]] Result<std::vector<std::string>> ids(Topic topic, const std::string& asset_id = {});
  [[nodiscard]] Result<std::vector<std::string>> assets(Topic topic);
  /// All conclusions about this asset.
  [[nodiscard]] Result<std::vector<Message>> all(Topic topic, const std::string& asset_id);
  /// The journal.
  [[nodiscard]] Result<JournalReader*> journal_of(Topic topic);

  /// Why the journal of the topic that this id begins with cannot be looked into; null where it can, or where no
  /// service writes such messages.
  [[nodiscard]] const Error* unread(const std::string& message_id) const;
  /// The services' journals that cannot be looked into, and why, by service.
  [[nodiscard]] const std::map<std::string, Error>& unread() const { return unread_; }
  /// Where was looked.
  [[nodiscard]] const std::string& place() const { return place_; }

 private:
  std::string place_;
  std::map<std::string, JournalReader> journals_;  ///< by service
  std::map<std::string, Error> unread_;
};

/// The service that concludes messages of this topic; "" where they come from outside.
[[nodiscard]] std::string writer_of(Topic topic);

}  // namespace sealwatch::cli
