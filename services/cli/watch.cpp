// `sealwatch watch`: any topic, live.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <optional>

#include "sealwatch/core/text.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/session.hpp"
#include "services/cli/summary.hpp"
#include "services/common/message/json.hpp"

namespace sealwatch::cli {
namespace {

constexpr const char* kServiceStatus = "service_status";

struct Selection {
  std::vector<Topic> topics;
  bool service_status = false;
};

/// All topics but the bulky samples, unless some are named.
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
      if (const auto topic = static_cast<Topic>(index);
          topic != Topic::raw_samples && topic != Topic::sample_block && topic != Topic::test_window)
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
  if (const Status joined = session->bus->subscribe(selection->topics); !joined) {
    complain(joined.error());
    return kInternalFailure;
  }
  if (selection->service_status) {
    if (const Status joined = session->bus->subscribe_service_topics(); !joined) {
      complain(joined.error());
      return kInternalFailure;
    }
  }
  catch_interrupts();
  const auto start = std::chrono::steady_clock::now();
  const auto over = [&] {
    return options.seconds > 0.0 &&
           std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > options.seconds;
  };
  while (!interrupted() && !over())
    for (const BusItem& item : session->bus->receive(std::chrono::milliseconds(200))) print(item, options);
  return kOk;
}

}  // namespace sealwatch::cli
