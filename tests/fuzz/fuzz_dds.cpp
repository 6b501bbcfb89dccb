// Any bytes as a sample from the network, the first of them choosing its topic: Cyclone refuses them, or the decoder, or a
// message comes of them that admission can judge; never a crash. The decoder is given all bytes, too, as they are.
// Cyclone's part is not instrumented, so that mutations begin with bytes of true messages.
#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "dds/dds.h"
#include "dds/ddsi/ddsi_serdata.h"
#include "services/common/runtime/admission.hpp"
#include "services/common/transport/topic_types.hpp"
#include "tests/unit/message/fill.hpp"

namespace sealwatch::transport {
namespace {

constexpr const char* kThisProcessAlone =
    "<General><Interfaces><NetworkInterface name=\"lo\" multicast=\"false\"/></Interfaces></General>"
    "<Discovery><Tag>fuzz</Tag></Discovery>";

void require(bool holds) {
  if (!holds) std::abort();
}

/// Each topic's type as Cyclone has it: that of a sample which it took.
class Types {
 public:
  Types() {
    require(dds_create_domain(kDomain, kThisProcessAlone) >= 0);
    participant_ = dds_create_participant(kDomain, nullptr, nullptr);
    require(participant_ >= 0);
    const Sampler sampler{*this};
    sampler.all(std::make_index_sequence<std::variant_size_v<MessageAlternatives>>{});
  }
  [[nodiscard]] const ddsi_sertype* of(std::size_t topic) const { return types_.at(topic); }
  /// A sample of that topic with `length` items in each sequence, as it goes over the network.
  [[nodiscard]] std::vector<std::uint8_t> bytes(std::size_t topic, std::size_t length) const {
    return samples_.at(topic).at(length % kLengths);
  }

 private:
  static constexpr dds_domainid_t kDomain = 17;
  static constexpr std::size_t kLengths = 3;
  struct Sampler {
    Types& types;
    template <std::size_t... Index>
    void all(std::index_sequence<Index...> /*topics*/) const {
      (types.add<std::variant_alternative_t<Index, MessageAlternatives>>(), ...);
      types.add<ServiceStatus>();
      types.add<ResendRequest>();
      types.add<MaintenanceEvent>();  // retraction
    }
  };

  template <class T>
  void add() {
    const TopicType& topic = topic_types().at(types_.size());
    const dds_entity_t entity = dds_create_topic(participant_, topic.descriptor, topic.name.c_str(), nullptr, nullptr);
    const dds_entity_t reader = dds_create_reader(participant_, entity, nullptr, nullptr);
    const dds_entity_t writer = dds_create_writer(participant_, entity, nullptr, nullptr);
    std::vector<std::vector<std::uint8_t>> samples;
    for (std::size_t length = 0; length < kLengths; ++length) {
      const T filled = testing::filled<T>(length);
      if constexpr (std::is_constructible_v<Message, T>) {
        const Message message = filled;
        require(dds_write(writer, DdsSample(message).get()) == DDS_RETCODE_OK);
      } else {
        require(dds_write(writer, DdsSample(filled).get()) == DDS_RETCODE_OK);
      }
      ddsi_serdata* taken = nullptr;
      dds_sample_info_t info;
      require(dds_takecdr(reader, &taken, 1, &info, DDS_ANY_STATE) == 1);
      std::vector<std::uint8_t> bytes(ddsi_serdata_size(taken));
      ddsi_serdata_to_ser(taken, 0, bytes.size(), bytes.data());
      samples.push_back(std::move(bytes));
      if (length == 0) types_.push_back(taken->type);
      ddsi_serdata_unref(taken);
    }
    samples_.push_back(std::move(samples));
  }

  dds_entity_t participant_ = 0;
  std::vector<const ddsi_sertype*> types_;
  std::vector<std::vector<std::vector<std::uint8_t>>> samples_;
};

const Types& types() {
  static const Types made;
  return made;
}

void judge(const BusItem& item) {
  static const Admission admission;
  if (const auto* message = std::get_if<Message>(&item)) {
    (void)admission.refusal_of_asset(*message);
    (void)admission.refusal(*message, UtcTime{1'900'000'000'000'000'000});
  }
}

void take(std::size_t topic, std::uint8_t* bytes, std::size_t size) {
  const ddsrt_iovec_t piece = {.iov_base = bytes, .iov_len = size};
  ddsi_serdata* const received = ddsi_serdata_from_ser_iov(types().of(topic), SDK_DATA, 1, &piece, size);
  if (received == nullptr) return;
  std::vector<std::byte> kept(ddsi_serdata_size(received));  // of this size: nothing may be read beyond
  ddsi_serdata_to_ser(received, 0, kept.size(), kept.data());
  ddsi_serdata_unref(received);
  if (const auto item = topic_types().at(topic).decode(kept)) judge(*item);
}

}  // namespace
}  // namespace sealwatch::transport

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

/// One time in eight a true message takes the place of what is there.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  using namespace sealwatch::transport;
  if (seed % 8 == 0 || size < 5) {
    const std::size_t topic = seed / 8 % kTopicCount;
    const std::vector<std::uint8_t> bytes = types().bytes(topic, seed / 1024);
    if (bytes.size() + 1 > most) return size;
    data[0] = static_cast<std::uint8_t>(topic);
    std::memcpy(data + 1, bytes.data(), bytes.size());
    size = bytes.size() + 1;
  }
  return LLVMFuzzerMutate(data, size, most);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sealwatch::transport;
  if (size < 5) return 0;  // as many come with every sample: its encoding
  std::vector<std::uint8_t> bytes(data + 1, data + size);
  const std::size_t topic = data[0] % kTopicCount;
  if (const auto item = topic_types().at(topic).decode(std::as_bytes(std::span(bytes)))) judge(*item);
  take(topic, bytes.data(), bytes.size());
  return 0;
}
