// Looking into a journal from outside, also while its service runs or after it has ended: nothing is changed, and a
// journal that is not there is not made.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sealwatch/core/result.hpp"
#include "sealwatch/message/topics.hpp"

namespace sealwatch {

class JournalReader {
 public:
  [[nodiscard]] static Result<JournalReader> open(const std::string& connection, const std::string& service);
  ~JournalReader();
  JournalReader(JournalReader&& other) noexcept;
  JournalReader& operator=(JournalReader&& other) noexcept;

  /// Where it is, without a password.
  [[nodiscard]] const std::string& place() const;
  /// The writer id that its service's messages carry: no two journals have the same.
  [[nodiscard]] const std::string& writer_id() const;
  /// The output of that id, as the layer concluded it; nothing where this service concluded none of that id.
  [[nodiscard]] Result<std::optional<Message>> output(const std::string& message_id);
  /// All outputs of one topic and asset, in the order of conclusion.
  [[nodiscard]] Result<std::vector<Message>> outputs(Topic topic, const std::string& asset_id);
  /// Ids of all outputs of one topic, in the order of conclusion; of one asset unless that is "".
  [[nodiscard]] Result<std::vector<std::string>> output_ids(Topic topic, const std::string& asset_id = {});
  /// Assets that outputs of this topic are about.
  [[nodiscard]] Result<std::vector<std::string>> assets(Topic topic);
  /// Whether a message of that id was received; what it said is dropped once it is consumed.
  [[nodiscard]] Result<bool> has_input(const std::string& message_id);

 private:
  struct Session;
  explicit JournalReader(std::unique_ptr<Session> session);
  std::unique_ptr<Session> session_;
};

}  // namespace sealwatch
