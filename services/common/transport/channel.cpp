#include "services/common/transport/channel.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <memory>

#include "dds/ddsi/ddsi_serdata.h"
#include "sealwatch/message/confirmation.hpp"
#include "sealwatch/message/outside.hpp"
#include "sealwatch/message/retraction.hpp"
#include "services/common/transport/participant.hpp"
#include "services/common/transport/refusals.hpp"

namespace sealwatch::transport {
namespace {

/// A publisher that waited here could not take what its own readers have. What DDS does not take is in the journal: it
/// is sent a little later, or asked for.
constexpr dds_duration_t kMaxBlockingTime = DDS_MSECS(10);
/// Writers offer a finite liveliness lease, so that a foreign reader may ask to be told when they die.
constexpr dds_duration_t kLivelinessLease = DDS_SECS(5);
/// Messages of one asset that a reader with SlowReader::loses_oldest keeps.
constexpr std::int32_t kClientDepth = 256;

constexpr std::size_t kLargestBatch = 64;

using Qos = std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)>;

Qos common_qos(const TopicQos& settings) {
  Qos qos(dds_create_qos(), &dds_delete_qos);
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, kMaxBlockingTime);
  dds_qset_durability(qos.get(), settings.transient_local ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_destination_order(qos.get(), DDS_DESTINATIONORDER_BY_RECEPTION_TIMESTAMP);
  return qos;
}

Qos writer_qos(const TopicQos& settings) {
  Qos qos = common_qos(settings);
  if (settings.keep_all)
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_ALL, DDS_LENGTH_UNLIMITED);
  else
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, 1);
  // What a late subscriber gets is set here, not by the history: the last message of every asset.
  dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, 1, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED,
                              DDS_LENGTH_UNLIMITED);
  dds_qset_writer_data_lifecycle(qos.get(), false);  // else a crash would look like a dispose of every asset
  dds_qset_liveliness(qos.get(), DDS_LIVELINESS_AUTOMATIC, kLivelinessLease);
  if (settings.lifespan_s > 0)
    dds_qset_lifespan(qos.get(), static_cast<dds_duration_t>(settings.lifespan_s * DDS_NSECS_IN_SEC));
  return qos;
}

Qos reader_qos(const TopicQos& settings, SlowReader slow_reader, std::int32_t limit) {
  Qos qos = common_qos(settings);
  if (!settings.keep_all) {
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, 1);
  } else if (slow_reader == SlowReader::loses_oldest) {
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, kClientDepth);
  } else {
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_ALL, DDS_LENGTH_UNLIMITED);
    dds_qset_resource_limits(qos.get(), limit, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  }
  return qos;
}

void announce(dds_entity_t reader, void* channel) { static_cast<Channel*>(channel)->arrived(reader); }

std::string policy_of(std::uint32_t id) {
  if (id == DDS_DURABILITY_QOS_POLICY_ID) return "durability";
  if (id == DDS_RELIABILITY_QOS_POLICY_ID) return "reliability";
  if (id == DDS_OWNERSHIP_QOS_POLICY_ID) return "ownership";
  if (id == DDS_DATA_REPRESENTATION_QOS_POLICY_ID) return "data representation";
  return "policy " + std::to_string(id);
}

/// Neither side would notice: the writer waits for readers, or writes for nobody.
void tell_unheard(dds_entity_t reader, dds_requested_incompatible_qos_status_t status, void* /*unused*/) {
  std::array<char, 256> name{};
  (void)dds_get_name(dds_get_topic(reader), name.data(), name.size());
  note_refusal("topic " + std::string(name.data()) + ": nothing of a writer is received whose " +
               policy_of(status.last_policy_id) +
               " is not that of the services; give it the quality of service of docs/topics.md");
}

}  // namespace

bool is_retraction(const Message& message) {
  const auto* event = std::get_if<MaintenanceEvent>(&message);
  if (event == nullptr) return false;
  if (is_retraction_kind(event->kind)) return true;
  // Who may not retract may not make somebody else's retraction count either.
  const bool answers = event->kind == kActConfirmed || event->kind == kActRejected;
  const auto act = answers ? confirmed_act(event->asset_id, event->header.message_id) : std::optional<std::string>();
  return act && is_retraction_id(*act);
}

Status Channel::open_topic() {
  if (topic_ > 0) return {};
  const std::string name = "sealwatch/" + type_->name;
  const dds_entity_t topic = dds_create_topic(participant_, type_->descriptor, name.c_str(), nullptr, nullptr);
  if (topic < 0) return dds_failure("topic " + type_->name, topic);
  topic_ = topic;
  return {};
}

Status Channel::subscribe(Inbox& inbox) {
  if (subscribed()) return {};
  if (Status opened = open_topic(); !opened) return opened;
  assert(type_->batch <= kLargestBatch);
  inbox_ = &inbox;
  const std::unique_ptr<dds_listener_t, decltype(&dds_delete_listener)> listener(dds_create_listener(this),
                                                                                 &dds_delete_listener);
  dds_lset_data_available(listener.get(), announce);
  dds_lset_requested_incompatible_qos(listener.get(), tell_unheard);
  const dds_entity_t reader = dds_create_reader(
      participant_, topic_, reader_qos(qos_, slow_reader_, type_->reader_limit).get(), listener.get());
  if (reader < 0) return dds_failure("reader of topic " + type_->name, reader);
  const std::lock_guard taking(taking_);
  reader_ = reader;
  take_all();  // what came before the call returned
  return {};
}

void Channel::arrived(dds_entity_t reader) {
  {
    const std::lock_guard taking(taking_);  // what takes when asked is not disturbed either
    if (!subscribed()) reader_ = reader;    // dds_create_reader is not through yet
    if (takes_at_once_) take_all();
  }
  inbox_->signal.notify();
}

bool Channel::take_batch(std::vector<Stamped>& taken) const {
  std::array<ddsi_serdata*, kLargestBatch> samples{};
  std::array<dds_sample_info_t, kLargestBatch> infos;
  const auto most = static_cast<std::uint32_t>(type_->batch);
  const dds_return_t count = dds_takecdr(reader_, samples.data(), most, infos.data(), DDS_ANY_STATE);
  if (count <= 0) return false;  // below 0: called by the listener before dds_create_reader is through
  for (std::size_t k = 0; static_cast<dds_return_t>(k) < count; ++k) {
    const std::unique_ptr<ddsi_serdata, decltype(&ddsi_serdata_unref)> sample(samples[k], &ddsi_serdata_unref);
    if (!infos[k].valid_data) continue;
    if (auto item = decode(*sample); item && may_say(*item))
      taken.push_back(
          {.published = infos[k].source_timestamp, .writer = infos[k].publication_handle, .item = std::move(item)});
  }
  return count == static_cast<dds_return_t>(most);
}

/// What is no message is passed over, as DDS does with what it cannot read. Services, which count, hear of it.
std::unique_ptr<BusItem> Channel::decode(const ddsi_serdata& sample) const {
  ddsrt_iovec_t bytes;
  ddsi_serdata* const held = ddsi_serdata_to_ser_ref(&sample, 0, ddsi_serdata_size(&sample), &bytes);
  auto item = type_->decode({static_cast<const std::byte*>(bytes.iov_base), bytes.iov_len});
  ddsi_serdata_to_ser_unref(held, &bytes);
  const auto* message = item ? std::get_if<Message>(&*item) : nullptr;
  const bool is_unreadable = message != nullptr && header_of(*message).message_id.starts_with(kUnreadableMessage);
  return is_unreadable && slow_reader_ == SlowReader::loses_oldest ? nullptr : std::move(item);
}

/// A retraction on the topic of all other events was sent without the right to retract, or by a program that knows of no
/// rights: where there are any, it is refused.
bool Channel::may_say(const BusItem& item) const {
  const auto* message = std::get_if<Message>(&item);
  const bool retracts = message != nullptr && is_retraction(*message);
  const bool is_of_retractions = type_ == &topic_types()[kRetractionIndex];
  if (retracts == is_of_retractions || (retracts && rights_ == Rights::none)) return true;
  note_refusal("topic " + type_->name + ": a message of asset '" + asset_of(*message) +
               "' belongs to another topic, for which its sender needs another right");
  return false;
}

void Channel::take() {
  const std::lock_guard taking(taking_);
  take_all();
}

bool Channel::inbox_is_full(std::chrono::steady_clock::time_point now) const {
  const std::lock_guard lock(inbox_->mutex);
  return inbox_->is_full(static_cast<std::size_t>(type_ - topic_types().data()),
                         static_cast<std::size_t>(type_->reader_limit), now);
}

void Channel::take_all() {
  const auto now = std::chrono::steady_clock::now();
  left_behind_ = inbox_is_full(now);
  if (left_behind_) return;
  std::vector<Stamped> taken;
  while (take_batch(taken)) {
  }
  if (taken.empty()) return;
  std::ranges::stable_sort(taken, {}, &Stamped::published);
  const std::lock_guard lock(inbox_->mutex);
  for (Stamped& one : taken)
    inbox_->put(one.writer, std::move(one.item), static_cast<std::size_t>(type_->reader_limit), now);
}

Status Channel::open_writer() {
  if (writer_ > 0) return {};
  if (Status opened = open_topic(); !opened) return opened;
  const dds_entity_t writer = dds_create_writer(participant_, topic_, writer_qos(qos_).get(), nullptr);
  if (writer < 0) return dds_failure("writer of topic " + type_->name, writer);
  writer_ = writer;
  return {};
}

Status Channel::write(const DdsSample& sample) {
  if (Status opened = open_writer(); !opened) return opened;
  last_written_ = std::max(last_written_ + 1, dds_time());  // the system's clock may be set back
  const dds_return_t code = dds_write_ts(writer_, sample.get(), last_written_);
  if (code == DDS_RETCODE_TIMEOUT)
    return dds_failure("topic " + type_->name, code, "a subscriber does not take its messages now; publish again");
  if (code < 0) return dds_failure("topic " + type_->name, code);
  return {};
}

Result<std::size_t> Channel::subscribers() {
  if (Status opened = open_writer(); !opened) return fail(opened.error());
  const dds_return_t count = dds_get_matched_subscriptions(writer_, nullptr, 0);
  if (count < 0) return dds_failure("subscribers of topic " + type_->name, count);
  return static_cast<std::size_t>(count);
}

}  // namespace sealwatch::transport
