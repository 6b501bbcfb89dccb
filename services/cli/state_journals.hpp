// What the services keep, looked into without them: the journals of a state directory, or those that a configuration
// names.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "services/common/store/journal_reader.hpp"

namespace sealwatch::cli {

class StateJournals {
 public:
  /// The journals in `state_directory`, or those of the configuration `config` where that is "". A service whose
  /// journal is not here runs elsewhere, or not at all; that there is none of any service, or that one cannot be read,
  /// is said on standard error.
  [[nodiscard]] static std::optional<StateJournals> open(const std::string& state_directory, const std::string& config);

  struct Kept {
    Message message;
    std::string place;  ///< the journal
  };
  /// The message that a service concluded under this id.
  [[nodiscard]] Result<std::optional<Kept>> find(const std::string& message_id);
  /// Whether a service received a message of this id. What came from outside is kept by its id alone.
  [[nodiscard]] Result<bool> received(const std::string& message_id);
  /// Ids of all conclusions of this topic, in the order of conclusion; of one asset unless that is "".
  [[nodiscard]] Result<std::vector<std::string>> ids(Topic topic, const std::string& asset_id = {});
  [[nodiscard]] Result<std::vector<std::string>> assets(Topic topic);
  /// All conclusions of this topic about this asset.
  [[nodiscard]] Result<std::vector<Message>> all(Topic topic, const std::string& asset_id);
  /// Where was looked.
  [[nodiscard]] const std::string& place() const { return place_; }

 private:
  std::string place_;
  std::vector<JournalReader> journals_;
};

}  // namespace sealwatch::cli
