// From a message down to the waveform: the messages it was concluded from, those they were concluded from, and so on.
//
// A message names in its header all that stands behind it, also what stands behind its sources. In the tree a message
// hangs where the nearest conclusion from it is, and once. The sources of other tests (the history behind a forecast)
// are named and not followed.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sealwatch/core/result.hpp"
#include "sealwatch/message/topics.hpp"

namespace sealwatch::cli {

struct SourceNode {
  std::string message_id;
  std::shared_ptr<const Message> message;  ///< null where only its id is kept
  std::string place;                       ///< the journal that keeps it; why it is not read where only its id is kept
  bool followed = true;                    ///< false: of another test
  std::vector<SourceNode> sources = {};
};

/// A message and its journal; no message where it is not kept, and then why its journal is not read, if it is not.
struct Looked {
  std::shared_ptr<const Message> message;
  std::string place;
};
using LookUp = std::function<Result<Looked>(const std::string& message_id)>;

[[nodiscard]] Result<SourceNode> provenance_tree(const std::string& message_id, const LookUp& look_up);

/// For people: an id a line, what it says below; sample blocks and other tests are gathered.
[[nodiscard]] std::string tree_text(const SourceNode& root);
/// For machines (schema sealwatch.message/1): the message in full, its sources by id, topic and journal.
[[nodiscard]] std::string tree_json(const SourceNode& root);
/// The window of the test behind a message; null where the tree has none.
[[nodiscard]] const TestWindow* window_of(const SourceNode& root);

}  // namespace sealwatch::cli
