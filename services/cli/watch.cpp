// `sealwatch watch`: any topic, live.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>

#include "sealwatch/core/text.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/session.hpp"
#include "services/cli/state_journals.hpp"
#include "services/cli/summary.hpp"
#include "services/common/message/json.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::cli {
namespace {

constexpr const char* kServiceStatus = "service_status";
constexpr const char* kAnyService = "any service";  ///< each writes its status
/// A service that runs is heard within its heartbeat's second and a little.
constexpr std::chrono::milliseconds kPatience{1800};

struct Selection {
  std::vector<Topic> topics;
  bool service_status = false;
};

/// All topics but the bulky samples, and what services keep for each other, unless some are named.
std::optional<Selection> select(const std::vector<std::string>& names) {
  Selection selection;
  std::vector<std::string> known(EnumNames<Topic>::kNames.begin(), EnumNames<Topic>::kNames.end());
  known.emplace_back(kServiceStatus);
  for (const std::string& name : names) {
    const auto topic = value_of<Topic>(name);
    if (topic) selection.topics.push_back(*topic);
    if (name == kServiceStatus) selection.service_status = true;
    if (topic || name == kServiceStatus) continue;
    complain(Error{.file = {}, .place = {}, .value = name, .rule = "is not a topic", .advice = suggest(name, known)});
    return std::nullopt;
  }
  if (names.empty())
    for (std::size_t index = 0; index < EnumNames<Topic>::kNames.size(); ++index)
      if (const auto topic = static_cast<Topic>(index); topic != Topic::raw_samples && topic != Topic::sample_block &&
                                                        topic != Topic::test_window && topic != Topic::act_record)
        selection.topics.push_back(topic);
  return selection;
}

/// A name that no asset bears would be watched in silence for ever.
bool is_configured(const std::string& asset_id, const Configuration& configuration) {
  if (asset_id.empty() || configuration.find_asset(asset_id) != nullptr) return true;
  std::vector<std::string> known;
  for (const AssetConfig& asset : configuration.assets) known.push_back(asset.asset_id);
  complain(Error{.file = {},
                 .place = "--asset",
                 .value = asset_id,
                 .rule = "is not a configured asset",
                 .advice = suggest(asset_id, known)});
  return false;
}

/// Says once that what is watched has no writer that is heard: silence would look like a quiet day.
class Writers {
 public:
  explicit Writers(const Selection& selection) {
    for (const Topic topic : selection.topics)
      if (const std::string writer = writer_of(topic); !writer.empty()) silent_.insert(writer);
    if (selection.service_status && silent_.empty()) silent_.insert(kAnyService);
    expected_ = silent_.size();
  }
  void take(const BusItem& item) {
    if (const auto* status = std::get_if<ServiceStatus>(&item)) {
      silent_.erase(status->service);
      silent_.erase(kAnyService);
    }
    if (const auto* message = std::get_if<Message>(&item)) silent_.erase(writer_of(topic_of(*message)));
  }
  void tell(std::chrono::steady_clock::time_point now, std::int32_t domain) {
    if (told_ || silent_.empty() || now < begin_ + kPatience) return;
    told_ = true;
    std::string names;
    for (const std::string& name : silent_) text::add_to_list(names, name);
    const bool all = silent_.size() == expected_;
    std::fprintf(
        stderr,
        "sealwatch: no heartbeat from %s in DDS domain %d: %s comes until %s (`sealwatch up` starts the services; "
        "CYCLONEDDS_URI must be the same for all); waiting\n",
        names.c_str(), domain, all ? "nothing" : "not everything", silent_.size() == 1 ? "it runs" : "they run");
  }

 private:
  std::set<std::string> silent_;
  std::size_t expected_ = 0;
  bool told_ = false;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

/// Messages that a service sends again, because somebody missed them, are told once.
class Repetitions {
 public:
  bool is_one(const Message& message) {
    const Header& header = header_of(message);
    if (header.stream_sequence == 0) return false;  // from outside
    std::uint64_t& last = last_[{topic_of(message), header.writer_id, asset_of(message)}];
    if (header.stream_sequence <= last) return true;
    last = header.stream_sequence;
    return false;
  }

 private:
  std::map<std::tuple<Topic, std::string, std::string>, std::uint64_t> last_;
};

void print(const BusItem& item, const WatchOptions& options) {
  if (const auto* message = std::get_if<Message>(&item)) {
    if (!options.asset_id.empty() && asset_of(*message) != options.asset_id) return;
    const std::string topic(name_of(topic_of(*message)));
    const std::string line =
        options.json ? R"({"topic":")" + topic + R"(","message":)" + to_json(*message) + "}" : one_line(*message);
    std::printf("%s\n", line.c_str());
  } else if (const auto* status = std::get_if<ServiceStatus>(&item)) {
    const std::string line =
        options.json ? R"({"topic":"service_status","message":)" + to_json(*status) + "}" : one_line(*status);
    std::printf("%s\n", line.c_str());
  }
  std::fflush(stdout);
}

}  // namespace

int run_watch(const WatchOptions& options) {
  const std::optional<Selection> selection = select(options.topics);
  if (!selection) return kBadInput;
  std::optional<Session> session = open_session(options.config);
  if (!session || !is_configured(options.asset_id, session->configuration)) return kBadInput;
  Status joined = session->bus->subscribe(selection->topics);
  if (joined) joined = session->bus->subscribe_service_topics();
  if (!joined) {
    complain(joined.error());
    return kInternalFailure;
  }
  catch_interrupts();
  const auto start = std::chrono::steady_clock::now();
  const auto over = [&] {
    return options.seconds > 0.0 &&
           std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > options.seconds;
  };
  Writers writers(*selection);
  Repetitions repetitions;
  while (!interrupted() && !over()) {
    for (const BusItem& item : session->bus->receive(std::chrono::milliseconds(100))) {
      writers.take(item);
      if (const auto* message = std::get_if<Message>(&item); message != nullptr && repetitions.is_one(*message))
        continue;
      if (selection->service_status || !std::holds_alternative<ServiceStatus>(item)) print(item, options);
    }
    writers.tell(std::chrono::steady_clock::now(), session->configuration.domain);
  }
  return kOk;
}

}  // namespace sealwatch::cli
