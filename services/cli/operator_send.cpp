#include "services/cli/operator_send.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "sealwatch/core/text.hpp"
#include "sealwatch/core/visible_text.hpp"
#include "sealwatch/message/confirmation.hpp"
#include "sealwatch/port/patient_publish.hpp"
#include "services/cli/commands.hpp"

namespace sealwatch::cli {
namespace {

/// The reader's heartbeat confirms receipt; without it after this time the command says so and fails.
constexpr std::chrono::seconds kPatience{10};

/// Somebody speaks of an asset that there is.
std::optional<Error> objection(const Configuration& configuration, const std::string& config,
                               const std::string& asset_id, const std::string& who) {
  if (without_blanks(who).empty())
    return Error{
        .file = {}, .place = "--by", .value = who, .rule = "must say who", .advice = "a name, or a position on shift"};
  if (asset_id == kNoAsset || configuration.find_asset(asset_id) != nullptr) return std::nullopt;
  std::vector<std::string> known;
  for (const AssetConfig& asset : configuration.assets) known.push_back(asset.asset_id);
  return Error{.file = config,
               .place = "assets",
               .value = asset_id,
               .rule = "is not a configured asset",
               .advice = suggest(asset_id, known)};
}

}  // namespace

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

std::optional<Session> open_for(const std::string& config, const std::string& asset_id, const std::string& who) {
  std::optional<Session> session = open_session(config);
  if (!session) return std::nullopt;
  if (const auto error = objection(session->configuration, config, asset_id, who)) {
    complain(*error);
    return std::nullopt;
  }
  return session;
}

bool says_that_it_waits(const Session& session, const Message& act) {
  if (!session.configuration.acts_confirmed_by_second || !may_lower_an_advisory(act)) return false;
  std::printf("received: it counts once another person confirms it: sealwatch confirm %s %s --by NAME\n",
              shell_word(asset_of(act)).c_str(), shell_word(header_of(act).message_id).c_str());
  return true;
}

int send(std::optional<Session>& session, Message message, std::vector<std::string> readers,
         const std::function<void(const Message&)>& look) {
  const std::string topic(name_of(topic_of(message)));
  Header& header = header_of(message);
  header.writer_id = unique_name("operator");
  header.stream_sequence = 1;
  header.producer = "sealwatch command line " SEALWATCH_VERSION;
  stamp_clock(header, read_clock());
  Status done = session->bus->subscribe_service_topics();
  if (done) done = publish_patiently(*session->bus, message);
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (done && !readers.empty() && std::chrono::steady_clock::now() < end) {
    for (const BusItem& item : session->bus->receive(std::chrono::milliseconds(100))) {
      if (const auto* request = std::get_if<ResendRequest>(&item);
          request != nullptr && request->writer_id == header.writer_id)
        done = publish_patiently(*session->bus, message);
      if (const auto* status = std::get_if<ServiceStatus>(&item))
        for (const StreamPosition& position : status->received)
          if (position.writer_id == header.writer_id && position.sequence >= header.stream_sequence)
            std::erase(readers, status->service);
      if (const auto* other = std::get_if<Message>(&item); other != nullptr && look) look(*other);
    }
  }
  if (!done) {
    complain(done.error());
    return kInternalFailure;
  }
  if (readers.empty()) return kOk;
  complain(Error{.file = {},
                 .place = topic,
                 .value = {},
                 .rule = "was not received by " + readers.front() + " within 10 s",
                 .advice = "is it running? see `sealwatch status`"});
  return kAnswerIsNo;
}

}  // namespace sealwatch::cli
