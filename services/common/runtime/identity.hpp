// Identity of messages: stamps that a layer must not see, and ids for senders that give none.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "sealwatch/message/topics.hpp"

namespace sealwatch {

/// Whether a message belongs to a numbered stream (message/service.hpp). Foreign senders' messages need not.
/// Under which the journal keeps that an act was refused for what it says. Its own id stays free: what is corrected comes
/// under the same, and so does what was truly said where somebody else has said it first.
[[nodiscard]] std::string id_of_refused(const Message& act);

[[nodiscard]] bool is_numbered(const Message& message);

/// The message as a layer sees it: writer id, sequence and publishing time cleared, as they differ from run to run and
/// a layer's conclusions must not.
[[nodiscard]] Message without_stamps(Message message);

/// What is known of inputs that came before.
struct EarlierInputs {
  std::function<bool(const std::string& message_id)> has;
  std::function<std::string(Topic topic, const std::string& asset_id)> last_unnumbered;
};

/// The layers know a replacement again, and it can be taken back, by an id as replacement_id.hpp makes it: that of a
/// sender with ids of its own ("cmms-4711") becomes part of one.
void name_replacement(Message& message);

/// The id of an input: its own; else, for a sender that gives none, "<topic>/<asset>/<hash of content>", of a
/// replacement with kind and time as name_replacement() has them, with "#2", "#3" behind the hash for later messages of
/// equal content. Nothing when the message was received before: a sender's last message comes again whenever a service
/// restarts.
[[nodiscard]] std::optional<std::string> identify(const Message& message, const EarlierInputs& earlier);

}  // namespace sealwatch
