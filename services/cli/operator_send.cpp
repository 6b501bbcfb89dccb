#include "services/cli/operator_send.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <map>

#include "sealwatch/core/text.hpp"
#include "sealwatch/core/visible_text.hpp"
#include "sealwatch/message/confirmation.hpp"
#include "sealwatch/port/patient_publish.hpp"
#include "services/cli/commands.hpp"
#include "services/common/runtime/admission.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::cli {
namespace {

/// The reader's heartbeat confirms receipt; without it after this time the command says so and fails.
constexpr std::chrono::seconds kPatience{10};
/// Every service beats once a second.
constexpr std::chrono::milliseconds kBeatOfReaders{1200};

/// Whether a service took tests of it without a file: on a bus of its own, as the last messages are heard once.
bool is_heard_of(const std::string& config, const std::string& asset_id) {
  constexpr std::array kTold = {Topic::state_report, Topic::remaining_life, Topic::advisory};
  std::optional<Session> session = open_session(config);
  if (!session || !session->bus->subscribe(kTold)) return false;
  for (const auto end = std::chrono::steady_clock::now() + kBeatOfReaders; std::chrono::steady_clock::now() < end;)
    for (const BusItem& item : session->bus->receive(std::chrono::milliseconds(50)))
      if (const auto* message = std::get_if<Message>(&item); message != nullptr && asset_of(*message) == asset_id)
        return true;
  return false;
}

/// Somebody speaks of an asset that there is.
std::optional<Error> objection(const Configuration& configuration, const std::string& config,
                               const std::string& asset_id, const std::string& who) {
  if (without_blanks(who).empty())
    return Error{
        .file = {}, .place = "--by", .value = who, .rule = "must say who", .advice = "a name, or a position on shift"};
  if (asset_id == kNoAsset || configuration.find_asset(asset_id) != nullptr || is_heard_of(config, asset_id))
    return std::nullopt;
  std::vector<std::string> known;
  for (const AssetConfig& asset : configuration.assets) known.push_back(asset.asset_id);
  return Error{.file = config,
               .place = "assets",
               .value = asset_id,
               .rule = "is not a configured asset, and no running service knows it",
               .advice = suggest(asset_id, known)};
}

/// What no service would take is not sent.
std::optional<Error> objection(const Message& message) {
  const std::optional<TextFault> fault = fault_of_texts(message);
  if (!fault) return std::nullopt;
  constexpr std::size_t kShown = 60;
  return Error{.file = {},
               .place = fault->field.ends_with("_by") ? "--by" : fault->field,
               .value = visible(fault->text.substr(0, kShown)),
               .rule = fault->rule + ": no service would take it",
               .advice = "nothing was sent; write it shorter, in plain UTF-8 letters"};
}

/// What the readers say of a message: that they have it, and in the same heartbeat, as their last error, why they
/// refused it.
class ReadersOfAct {
 public:
  ReadersOfAct(const Header& header, Topic topic, std::vector<std::string> names)
      : header_(header), refused_(std::string(name_of(topic)) + " refused: "), waiting_(std::move(names)) {}

  /// Before the message is sent: what they said of others.
  void know(const ServiceStatus& status) { earlier_[status.service] = status.last_error; }
  [[nodiscard]] bool are_known() const {
    return std::ranges::all_of(waiting_, [&](const std::string& name) { return earlier_.contains(name); });
  }
  void look(const ServiceStatus& status) {
    const bool has_it = std::ranges::any_of(status.received, [&](const StreamPosition& position) {
      return position.writer_id == header_.writer_id && position.sequence >= header_.stream_sequence;
    });
    if (!has_it) return know(status);
    if (std::erase(waiting_, status.service) == 0) return;
    const auto earlier = earlier_.find(status.service);
    const std::size_t reason = status.last_error.find(refused_);
    if (earlier == earlier_.end() || earlier->second == status.last_error || reason == std::string::npos) return;
    text::add_to_list(refusing_, status.service);
    why_ = status.last_error.substr(reason + refused_.size());
  }
  [[nodiscard]] const std::vector<std::string>& waiting() const { return waiting_; }
  [[nodiscard]] std::optional<Error> refusal() const {
    if (refusing_.empty()) return std::nullopt;
    return Error{
        .file = {}, .place = "refused by " + refusing_, .value = header_.message_id, .rule = why_, .advice = {}};
  }

 private:
  Header header_;
  std::string refused_;
  std::vector<std::string> waiting_;
  std::map<std::string, std::string> earlier_;  ///< last errors, by service
  std::string refusing_;
  std::string why_;
};

/// Hears each of them once.
void know_readers(Bus& bus, ReadersOfAct& readers, const std::function<void(const Message&)>& look) {
  for (const auto end = std::chrono::steady_clock::now() + kBeatOfReaders;
       !readers.are_known() && std::chrono::steady_clock::now() < end;)
    for (const BusItem& item : bus.receive(std::chrono::milliseconds(50))) {
      if (const auto* status = std::get_if<ServiceStatus>(&item)) readers.know(*status);
      if (const auto* other = std::get_if<Message>(&item); other != nullptr && look) look(*other);
    }
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
  if (const auto error = objection(message)) {
    complain(*error);
    return kBadInput;
  }
  Header& header = header_of(message);
  header.writer_id = unique_name("operator");
  header.stream_sequence = 1;
  header.producer = "sealwatch command line " SEALWATCH_VERSION;
  stamp_clock(header, read_clock());
  ReadersOfAct heard(header, topic_of(message), std::move(readers));
  Status done = session->bus->subscribe_service_topics();
  if (done) know_readers(*session->bus, heard, look);
  if (done) done = publish_patiently(*session->bus, message);
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (done && !heard.waiting().empty() && std::chrono::steady_clock::now() < end) {
    for (const BusItem& item : session->bus->receive(std::chrono::milliseconds(100))) {
      if (const auto* request = std::get_if<ResendRequest>(&item);
          request != nullptr && request->writer_id == header.writer_id)
        done = publish_patiently(*session->bus, message);
      if (const auto* status = std::get_if<ServiceStatus>(&item)) heard.look(*status);
      if (const auto* other = std::get_if<Message>(&item); other != nullptr && look) look(*other);
    }
  }
  if (!done) {
    complain(done.error());
    return kInternalFailure;
  }
  if (const auto refusal = heard.refusal()) {
    complain(*refusal);
    return kAnswerIsNo;
  }
  if (heard.waiting().empty()) return kOk;
  complain(Error{.file = {},
                 .place = std::string(name_of(topic_of(message))),
                 .value = {},
                 .rule = "was not received by " + heard.waiting().front() + " within 10 s",
                 .advice = "is it running? see `sealwatch status`"});
  return kAnswerIsNo;
}

}  // namespace sealwatch::cli
