#include "sealwatch/client/sender.hpp"

#include <algorithm>
#include <random>

#include "services/common/text/format.hpp"
#include "services/common/transport/dds_bus.hpp"

namespace sealwatch::client {
namespace {

/// Blocks on their way: what data_acquisition holds for a stream that it does not keep up with.
constexpr std::uint64_t kWindow = 128;
/// Several heartbeats: nobody has answered.
constexpr std::chrono::seconds kUnanswered{3};
constexpr std::chrono::milliseconds kLook{20};

std::string unique_writer_id(const std::string& name) {
  std::random_device random;
  return text::format("{}-{:08x}{:08x}", name, random(), random());
}

}  // namespace

Sender::Sender(Options options) : options_(std::move(options)), writer_id_(unique_writer_id(options_.name)) {}
Sender::~Sender() = default;

Status Sender::connect() {
  if (bus_) return {};
  Configuration configuration;
  configuration.domain = options_.domain;
  configuration.cyclonedds_uri = options_.cyclonedds_uri;
  Result<std::unique_ptr<DdsBus>> bus = open_dds_bus(configuration, SlowReader::loses_oldest);
  if (!bus) return fail(bus.error());
  if (Status joined = (*bus)->subscribe_service_topics(); !joined) return joined;
  bus_ = std::move(*bus);
  return {};
}

Status Sender::add(RawSamples block) {
  if (block.header.message_id.empty())
    return fail(Error{.file = {},
                      .place = "header.message_id",
                      .value = {},
                      .rule = "must not be empty",
                      .advice = "the same text whenever this block is sent: source, recording and block number"});
  if (waiting_.empty()) confirmed_at_ = Clock::now();
  block.header.writer_id = writer_id_;
  block.header.stream_sequence = ++added_;
  stamp_clock(block.header, read_clock());
  waiting_.push_back(std::move(block));
  return {};
}

void Sender::send_next() {
  while (!waiting_.empty()) {
    const std::uint64_t first = waiting_.front().header.stream_sequence;
    if (sent_ >= added_ || sent_ + 1 >= first + kWindow) return;
    const std::uint64_t next = std::max(sent_ + 1, first);
    if (!bus_->publish(Message(waiting_[next - first]))) return;  // not taken now
    if (sent_ + 1 == first) moved_ = Clock::now();
    sent_ = next;
  }
}

void Sender::send_again(std::uint64_t first, std::uint64_t last) {
  for (const RawSamples& block : waiting_) {
    const std::uint64_t number = block.header.stream_sequence;
    if (number > std::min(last, sent_)) return;
    if (number >= first && !bus_->publish(Message(block))) return;
  }
}

void Sender::repeat_unanswered() {
  if (waiting_.empty() || Clock::now() - moved_ < kUnanswered) return;
  moved_ = Clock::now();
  send_again(0, sent_);
}

void Sender::answer(const ResendRequest& request) {
  if (request.writer_id != writer_id_ || request.topic != "raw_samples" || waiting_.empty()) return;
  const bool asks_for_forgotten = request.first_sequence < waiting_.front().header.stream_sequence;
  // A request that crossed a confirmation asks for what is there.
  if (asks_for_forgotten && Clock::now() - confirmed_at_ >= kUnanswered) return start_anew();
  send_again(request.first_sequence, request.last_sequence);
}

/// What is known already, data_acquisition knows by its message_id.
void Sender::start_anew() {
  writer_id_ = unique_writer_id(options_.name);
  added_ = sent_ = 0;
  for (RawSamples& block : waiting_) {
    block.header.writer_id = writer_id_;
    block.header.stream_sequence = ++added_;
  }
  moved_ = confirmed_at_ = Clock::now();
}

void Sender::take(const ServiceStatus& status) {
  if (status.service != "data_acquisition") return;
  for (const StreamPosition& received : status.received) {
    if (received.topic != "raw_samples" || received.writer_id != writer_id_) continue;
    while (!waiting_.empty() && waiting_.front().header.stream_sequence <= received.sequence) {
      confirmed_.push_back(waiting_.front().header.message_id);
      waiting_.pop_front();
      moved_ = confirmed_at_ = Clock::now();
    }
  }
}

Status Sender::run_for(std::chrono::milliseconds duration) {
  if (Status connected = connect(); !connected) return connected;
  const auto end = Clock::now() + duration;
  do {
    send_next();
    repeat_unanswered();
    for (const BusItem& item : bus_->receive(kLook)) {
      if (const auto* status = std::get_if<ServiceStatus>(&item)) take(*status);
      if (const auto* request = std::get_if<ResendRequest>(&item)) answer(*request);
    }
  } while (Clock::now() < end && !waiting_.empty());
  return {};
}

}  // namespace sealwatch::client
