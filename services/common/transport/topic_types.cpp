#include "services/common/transport/topic_types.hpp"

#include <array>
#include <bit>
#include <deque>
#include <utility>

#include "dds/ddsi/ddsi_cdrstream.h"
#include "idl/act_record.h"
#include "idl/advisory_generation.h"
#include "idl/data_acquisition.h"
#include "idl/data_manipulation.h"
#include "idl/health_assessment.h"
#include "idl/prognostic_assessment.h"
#include "idl/service.h"
#include "idl/state_detection.h"
#include "sealwatch/message/outside.hpp"
#include "services/common/transport/codec.hpp"
#include "services/common/transport/from_cdr.hpp"

namespace sealwatch::transport {
namespace {

constexpr std::size_t kEncodingSize = 4;

/// The C struct and the descriptor that idlc generated for a message type.
template <class T>
struct Generated;

#define SEALWATCH_GENERATED(Type)                                                          \
  template <>                                                                              \
  struct Generated<Type> {                                                                 \
    using Sample = sealwatch_##Type;                                                       \
    static constexpr const dds_topic_descriptor_t* kDescriptor = &sealwatch_##Type##_desc; \
  };
SEALWATCH_GENERATED(RawSamples)
SEALWATCH_GENERATED(SampleBlock)
SEALWATCH_GENERATED(TestWindow)
SEALWATCH_GENERATED(TestFeatures)
SEALWATCH_GENERATED(StateReport)
SEALWATCH_GENERATED(HealthReport)
SEALWATCH_GENERATED(LeakageEstimate)
SEALWATCH_GENERATED(RemainingLife)
SEALWATCH_GENERATED(PstRequest)
SEALWATCH_GENERATED(Advisory)
SEALWATCH_GENERATED(Acknowledgement)
SEALWATCH_GENERATED(MaintenanceEvent)
SEALWATCH_GENERATED(ModelDiscrepancy)
SEALWATCH_GENERATED(ModelAcceptance)
SEALWATCH_GENERATED(ActRecord)
SEALWATCH_GENERATED(ServiceStatus)
SEALWATCH_GENERATED(ResendRequest)
#undef SEALWATCH_GENERATED

/// What Cyclone calls D_CDR2, in this machine's byte order: the encoding of appendable structs, and no other comes.
bool is_delimited_cdr2(std::span<const std::byte> bytes) {
  constexpr bool kLittle = std::endian::native == std::endian::little;
  return bytes.size() >= kEncodingSize && bytes[0] == std::byte{0} && bytes[1] == std::byte{kLittle ? 9 : 8};
}

/// Whose it is, where that could be read: its stream goes on, and it is told of.
template <class T>
std::unique_ptr<BusItem> unreadable(const T& read) {
  if constexpr (std::is_constructible_v<Message, T>) {
    if (read.asset_id.empty() && read.header.writer_id.empty()) return nullptr;
    T message;
    message.asset_id = read.asset_id;
    message.header.message_id = std::string(kUnreadableMessage) + read.header.message_id;
    message.header.writer_id = read.header.writer_id;
    message.header.stream_sequence = read.header.stream_sequence;
    message.header.writer_started_ns = read.header.writer_started_ns;
    return std::make_unique<BusItem>(Message(std::move(message)));
  } else {
    return nullptr;
  }
}

template <class T>
std::unique_ptr<BusItem> decode(std::span<const std::byte> bytes) {
  if (!is_delimited_cdr2(bytes)) return nullptr;
  std::unique_ptr<BusItem> item;
  T* content = nullptr;  // read where it stays: a block of samples is large and costly to move
  if constexpr (std::is_constructible_v<Message, T&&>) {
    item = std::make_unique<BusItem>(Message(T{}));
    content = &std::get<T>(std::get<Message>(*item));
  } else {
    item = std::make_unique<BusItem>(T{});
    content = &std::get<T>(*item);
  }
  return FromCdr(bytes.subspan(kEncodingSize)).read(*content) ? std::move(item) : unreadable(*content);
}

/// Cyclone passes over a message with an enumerator that the IDL does not have, unseen: its reader would ask for it for
/// ever. So any is let through, to be told of. (An instruction is above 2^24, what belongs to it below.)
const dds_topic_descriptor_t* with_any_enumerator(const dds_topic_descriptor_t& type) {
  constexpr std::uint32_t kWhat = DDS_OP_MASK | DDS_OP_TYPE_MASK;
  constexpr auto kEnumerator = std::uint32_t{DDS_OP_ADR} | std::uint32_t{DDS_OP_TYPE_ENU};
  constexpr std::uint32_t kAny = 0x7FFF'FFFF;
  struct Made {
    std::vector<std::uint32_t> operations;
    dds_topic_descriptor_t type;
  };
  static std::deque<Made> made;
  std::vector<std::uint32_t> operations(type.m_ops,
                                        type.m_ops + dds_stream_countops(type.m_ops, type.m_nkeys, type.m_keys));
  for (std::size_t k = 0; k + 2 < operations.size(); ++k)
    if ((operations[k] & kWhat) == kEnumerator) operations[k + 2] = kAny;
  const std::uint32_t* const first = operations.data();  // stays where it is when the vector is moved
  made.push_back({.operations = std::move(operations),
                  .type = {.m_size = type.m_size,
                           .m_align = type.m_align,
                           .m_flagset = type.m_flagset,
                           .m_nkeys = type.m_nkeys,
                           .m_typename = type.m_typename,
                           .m_keys = type.m_keys,
                           .m_nops = type.m_nops,
                           .m_ops = first,
                           .m_meta = type.m_meta,
                           .type_information = type.type_information,
                           .type_mapping = type.type_mapping,
                           .restrict_data_representation = type.restrict_data_representation}});
  return &made.back().type;
}

/// How many messages a reader holds, and takes from DDS at once. A message is a few kB, a block of a second of samples
/// about 20 kB, a test's window about 1 MB. Blocks come in bursts: they must not wait for each other when the reader's
/// thread has to wait for a core.
struct Limits {
  std::int32_t held;
  std::size_t batch;
};
constexpr Limits kSmall = {.held = 8192, .batch = 64};
constexpr Limits kBlocks = {.held = 512, .batch = 16};
constexpr Limits kWindows = {.held = 64, .batch = 4};

template <class T>
constexpr Limits limits_of() {
  if constexpr (requires(T message) {
                  message.samples;
                  message.block_number;
                })
    return kBlocks;
  else if constexpr (requires(T message) { message.samples; })
    return kWindows;
  else
    return kSmall;
}

template <class T>
TopicType describe(std::string_view name) {
  return {.name = std::string(name),
          .descriptor = with_any_enumerator(*Generated<T>::kDescriptor),
          .decode = decode<T>,
          .qos = {},
          .reader_limit = limits_of<T>().held,
          .batch = limits_of<T>().batch};
}

template <std::size_t... Index>
std::vector<TopicType> describe_all(std::index_sequence<Index...> /*topics*/) {
  std::vector<TopicType> types = {
      describe<std::variant_alternative_t<Index, MessageAlternatives>>(EnumNames<Topic>::kNames[Index])...};
  types.push_back(describe<ServiceStatus>("service_status"));
  types.back().qos.keep_all = false;  // a state: only the last heartbeat counts
  types.push_back(describe<ResendRequest>("resend_request"));
  types.back().qos.transient_local = false;  // an old request asks for what has long been sent
  types.push_back(describe<MaintenanceEvent>("retraction"));
  return types;
}

static_assert(std::variant_size_v<MessageAlternatives> == EnumNames<Topic>::kNames.size());

}  // namespace

const std::vector<TopicType>& topic_types() {
  static const std::vector<TopicType> types =
      describe_all(std::make_index_sequence<std::variant_size_v<MessageAlternatives>>{});
  return types;
}

template <class T>
void DdsSample::lend(const T& message) {
  using Sample = typename Generated<T>::Sample;
  auto* const sample = new (memory_.allocate(sizeof(Sample), alignof(Sample))) Sample{};
  LendToDds(memory_).lend(message, *sample);
  sample_ = sample;
}

DdsSample::DdsSample(const Message& message) {
  std::visit([this](const auto& alternative) { lend(alternative); }, message);
}
DdsSample::DdsSample(const ServiceStatus& status) { lend(status); }
DdsSample::DdsSample(const ResendRequest& request) { lend(request); }

}  // namespace sealwatch::transport
