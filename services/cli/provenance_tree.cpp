#include "services/cli/provenance_tree.hpp"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "services/cli/summary.hpp"
#include "services/cli/terminal.hpp"
#include "services/common/message/json.hpp"

namespace sealwatch::cli {
namespace {

constexpr std::size_t kWidth = 116;

/// All messages that are followed from one, by id.
class Graph {
 public:
  explicit Graph(const LookUp& look_up) : look_up_(look_up) {}

  /// Reads `id` and what stands behind it. A source is followed where it is of the same test, or where the message is
  /// of none (an advisory that was acknowledged, a test that is overdue).
  Status read(const std::string& id, const std::string& pst_id) {
    if (nodes_.contains(id)) return {};
    Result<Looked> looked = look_up_(id);
    if (!looked) return fail(looked.error());
    SourceNode& node = nodes_[id];
    node = {.message_id = id, .message = std::move(looked->message), .place = std::move(looked->place)};
    if (!node.message) return {};
    const Header& header = header_of(*node.message);
    node.followed = pst_id.empty() || header.pst_id == pst_id;
    if (!node.followed) return {};
    for (const std::string& source : header.source_ids)
      if (Status read_too = read(source, header.pst_id); !read_too) return read_too;
    return {};
  }

  SourceNode tree(const std::string& id) {
    SourceNode node = nodes_.at(id);
    if (!hung_.insert(id).second) return node;
    for (const std::string& source : nearest_sources(node))
      if (!hung_.contains(source)) node.sources.push_back(tree(source));
    return node;
  }

 private:
  static std::vector<std::string> sources_of(const SourceNode& node) {
    return node.message && node.followed ? header_of(*node.message).source_ids : std::vector<std::string>{};
  }

  /// Everything behind `id`, without itself.
  const std::set<std::string>& behind(const std::string& id) {
    const auto [known, is_new] = behind_.try_emplace(id);
    std::set<std::string>& all = known->second;
    if (!is_new) return all;
    for (const std::string& source : sources_of(nodes_.at(id))) {
      all.insert(source);
      const std::set<std::string>& more = behind(source);
      all.insert(more.begin(), more.end());
    }
    return all;
  }

  /// The sources that do not stand behind another of the sources.
  std::vector<std::string> nearest_sources(const SourceNode& node) {
    const std::vector<std::string> sources = sources_of(node);
    std::vector<std::string> nearest;
    for (const std::string& source : sources)
      if (std::ranges::none_of(
              sources, [&](const std::string& other) { return other != source && behind(other).contains(source); }))
        nearest.push_back(source);
    return nearest;
  }

  const LookUp& look_up_;
  std::map<std::string, SourceNode> nodes_;
  std::map<std::string, std::set<std::string>> behind_;
  std::set<std::string> hung_;
};

std::string topic_in(const std::string& message_id) { return message_id.substr(0, message_id.find('/')); }

/// In a journal that cannot be looked into.
bool is_unread(const SourceNode& node) { return !node.message && !node.place.empty(); }

/// Nodes that are told together: the blocks of one recording, the same conclusion from other tests, what one journal
/// that cannot be looked into would tell.
bool belong_together(const SourceNode& a, const SourceNode& b) {
  const std::string topic = topic_in(a.message_id);
  const bool gathered =
      !a.followed || (is_unread(a) && is_unread(b)) || topic == "sample_block" || topic == "raw_samples";
  return gathered && topic == topic_in(b.message_id) && a.followed == b.followed;
}

using Group = std::vector<const SourceNode*>;

std::string says(const SourceNode& node) {
  if (node.message) return one_line(*node.message);
  if (is_unread(node)) return node.place;
  return topic_in(node.message_id) == "raw_samples" ? "as it was received" : "not kept here, only its id";
}

std::size_t samples_in(const Group& group) {
  std::size_t samples = 0;
  for (const SourceNode* node : group)
    if (node->message)
      if (const auto* block = std::get_if<SampleBlock>(node->message.get())) samples += block->samples.time_s.size();
  return samples;
}

/// Their dates, from the first to the last.
std::string dates_of(const Group& group) {
  std::set<std::string> dates;
  for (const SourceNode* node : group)
    if (node->message && header_of(*node->message).event_time_known)
      dates.insert(date(header_of(*node->message).event_time_ns));
  if (dates.empty()) return {};
  return ", " + *dates.begin() + (dates.size() > 1 ? " to " + *dates.rbegin() : "");
}

std::string says(const Group& group) {
  const SourceNode& first = *group.front();
  if (is_unread(first)) return group.size() == 1 ? says(first) : count_of(group.size(), "message") + "; " + first.place;
  if (!first.followed)
    return count_of(group.size(), "message") + " of other tests" + dates_of(group) + "; not followed";
  const auto* block = first.message ? std::get_if<SampleBlock>(first.message.get()) : nullptr;
  if (block != nullptr)
    return count_of(group.size(), "block") + ", " + count_of(samples_in(group), "sample") + " of recording " +
           block->recording_id + ", sent by " + block->source_id;
  return group.size() == 1 ? says(first) : count_of(group.size(), "message") + ", as they were received";
}

std::string shortened(const std::string& text, std::size_t width) {
  if (letters(text) <= width) return text;
  const std::size_t cut = text.rfind(' ', width - 4);
  return text.substr(0, cut == std::string::npos ? width - 4 : cut) + " ...";
}

/// An advisory's reasons: what the messages below it are asked about.
std::string reasons_of(const SourceNode& node) {
  const auto* advisory = node.message ? std::get_if<Advisory>(node.message.get()) : nullptr;
  std::string text;
  if (advisory != nullptr)
    for (const std::string& reason : advisory->reasons)
      text.append("    - ").append(wrapped(reason, kWidth - 6, 6)).append("\n");
  return text;
}

void add_text(const Group& group, std::size_t depth, std::string& text) {
  const std::string indent(2 * depth, ' ');
  const SourceNode& first = *group.front();
  text.append(indent).append(first.message_id);
  if (group.size() > 1)
    text.append(" ... ").append(group.back()->message_id.substr(group.back()->message_id.rfind('/')));
  text.append("\n").append(indent).append("    ");
  const std::size_t width = kWidth - 2 * depth - 4;
  text.append(depth == 0 ? wrapped(says(first), width, 4) : shortened(says(group), width)).append("\n");
  if (depth == 0) text.append(reasons_of(first));
  std::vector<Group> groups;
  for (const SourceNode* node : group)
    for (const SourceNode& source : node->sources) {
      const auto same =
          std::ranges::find_if(groups, [&](const Group& other) { return belong_together(*other.front(), source); });
      if (same != groups.end())
        same->push_back(&source);
      else
        groups.push_back({&source});
    }
  std::stable_partition(groups.begin(), groups.end(), [](const Group& one) { return !one.front()->followed; });
  for (const Group& one : groups) add_text(one, depth + 1, text);
}

nlohmann::ordered_json as_json(const SourceNode& node) {
  nlohmann::ordered_json json = {{"message_id", node.message_id}, {"topic", topic_in(node.message_id)}};
  if (node.message) json["topic"] = name_of(topic_of(*node.message));
  if (node.message) json["journal"] = node.place;
  if (node.message) json["says"] = one_line(*node.message);
  if (!node.followed) return json;
  json["sources"] = nlohmann::ordered_json::array();
  for (const SourceNode& source : node.sources) json["sources"].push_back(as_json(source));
  return json;
}

}  // namespace

Result<SourceNode> provenance_tree(const std::string& message_id, const LookUp& look_up) {
  Graph graph(look_up);
  if (const Status read = graph.read(message_id, {}); !read) return fail(read.error());
  return graph.tree(message_id);
}

std::string tree_text(const SourceNode& root) {
  std::string text;
  add_text({&root}, 0, text);
  return text;
}

std::string tree_json(const SourceNode& root) {
  nlohmann::ordered_json json = {{"schema", "sealwatch.message/1"}};
  const nlohmann::ordered_json tree = as_json(root);
  for (const char* key : {"message_id", "topic", "journal"})
    if (tree.contains(key)) json[key] = tree[key];
  json["message"] = root.message ? nlohmann::ordered_json::parse(to_json(*root.message)) : nullptr;
  json["sources"] = tree["sources"];
  return json.dump(1);
}

const TestWindow* window_of(const SourceNode& root) {
  if (root.message && root.followed)
    if (const auto* window = std::get_if<TestWindow>(root.message.get())) return window;
  for (const SourceNode& source : root.sources)
    if (const TestWindow* window = window_of(source)) return window;
  return nullptr;
}

}  // namespace sealwatch::cli
