// What no honest program sends, for the campaign (campaign.py, trial poison):
//
//   poison DOMAIN named|nameless
//
// Takes true messages from standard input, {"topic": ..., "message": {...}}, and sends each again and again with one of
// its fields spoilt: enumerators that there are not, booleans of 2 and 255, no and infinite numbers, texts that are no
// UTF-8 or a megabyte long, sequences that are empty or enormous. named: numbered, under a name of its own; nameless:
// as from outside. Prints how many it sent.
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "dds/dds.h"
#include "dds/ddsi/ddsi_serdata.h"
#include "services/common/message/json.hpp"
#include "services/common/transport/topic_types.hpp"

namespace {

using namespace sealwatch;

constexpr std::size_t kWays = 4;

/// Spoils the leaf of that place in one of the ways; of sequences the first item is looked into.
class Spoiler {
 public:
  Spoiler(std::size_t place, std::size_t way) : left_(place), way_(way) {}
  template <class T>
  void operator()(std::string_view /*name*/, T& value) {
    if constexpr (Described<T>) {
      T::visit(*this, value);
    } else if (left_-- == 0) {
      done_ = true;
      spoil(value);
    } else if constexpr (requires { typename T::value_type; } && !std::is_same_v<T, std::string>) {
      if constexpr (!std::is_arithmetic_v<typename T::value_type>)
        if (!value.empty()) (*this)("", value.front());
    }
  }
  /// False where there is no such leaf.
  [[nodiscard]] bool done() const { return done_; }
  /// Bytes of the leaf that must be spoilt on the wire, as no such value can be written.
  [[nodiscard]] std::size_t bytes_on_the_wire() const { return bytes_; }

 private:
  template <class T>
  void spoil(T& value) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    if constexpr (std::is_same_v<T, bool>) {
      value = !value, bytes_ = 1;
    } else if constexpr (std::is_enum_v<T>) {
      value = value == T{} ? static_cast<T>(1) : T{}, bytes_ = 4;
    } else if constexpr (std::is_same_v<T, double>) {
      value = std::array<double, kWays>{kInfinity - kInfinity, kInfinity, -1.7e308, 5e-324}[way_];
    } else if constexpr (std::is_arithmetic_v<T>) {
      value = std::array<T, kWays>{std::numeric_limits<T>::max(), std::numeric_limits<T>::min(), 0, 1}[way_];
    } else if constexpr (std::is_same_v<T, std::string>) {
      value = std::array<std::string, kWays>{"\xFF\xC0", std::string(1'000'000, 'A'), "\x1B[2J;$(x)", ""}[way_];
    } else {
      const std::size_t most = std::is_arithmetic_v<typename T::value_type> ? 300'000 : 20'000;
      value.resize(std::array<std::size_t, kWays>{0, most, value.size() + 1, 1}[way_]);
    }
  }
  std::size_t left_, way_, bytes_ = 0;
  bool done_ = false;
};

/// Writes a topic with a type that allows any enumerator and any boolean: else Cyclone would not send them.
class LooseWriter {
 public:
  LooseWriter(dds_entity_t participant, std::size_t topic)
      : type_(*transport::topic_types().at(topic).descriptor), operations_(loosened(type_)) {
    type_.m_ops = operations_.data();
    type_.type_information = {};
    type_.type_mapping = {};
    const std::string& name = transport::topic_types()[topic].name;
    dds_qos_t* const qos = dds_create_qos();
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(5));
    dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
    dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
    dds_qset_writer_data_lifecycle(qos, false);
    dds_qset_liveliness(qos, DDS_LIVELINESS_AUTOMATIC, DDS_SECS(5));
    const auto create = [&](const std::string& named) {
      return dds_create_topic(participant, &type_, named.c_str(), nullptr, nullptr);
    };
    writer_ = dds_create_writer(participant, create("sealwatch/" + name), qos, nullptr);
    const dds_entity_t scratch = create("scratch/" + name);
    scratch_reader_ = dds_create_reader(participant, scratch, qos, nullptr);
    scratch_writer_ = dds_create_writer(participant, scratch, qos, nullptr);
    dds_delete_qos(qos);
    if (writer_ < 0 || scratch_reader_ < 0 || scratch_writer_ < 0)
      std::fprintf(stderr, "no writer of %s\n", name.c_str());
  }

  /// `spoilt` differs from the other in one leaf.
  bool send(const Message& message, const Message& spoilt, std::size_t bytes_on_the_wire, std::size_t way) {
    std::vector<std::uint8_t> bytes = bytes_of(spoilt);
    if (bytes_on_the_wire > 0) {
      const std::vector<std::uint8_t> before = bytes_of(message);
      std::size_t at = 0;
      while (at + bytes_on_the_wire < bytes.size() && bytes[at] == before[at]) ++at;
      const auto value = bytes_on_the_wire == 1 ? std::array<int, kWays>{2, 255, 3, 128}[way]
                                                : std::array<int, kWays>{0xFF, 0x7F, 0x05, 0x80}[way];
      std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at / bytes_on_the_wire * bytes_on_the_wire),
                  bytes_on_the_wire, static_cast<std::uint8_t>(value));
    }
    const ddsrt_iovec_t piece = {.iov_base = bytes.data(), .iov_len = bytes.size()};
    ddsi_serdata* const sample = ddsi_serdata_from_ser_iov(sertype_, SDK_DATA, 1, &piece, bytes.size());
    return sample != nullptr && dds_writecdr(writer_, sample) == DDS_RETCODE_OK;
  }

 private:
  /// What the type's program checks no more.
  static std::vector<std::uint32_t> loosened(dds_topic_descriptor_t& type) {
    constexpr std::size_t kWords = 3000;  // more than any has; how many it has nobody says
    std::vector<std::uint32_t> words(type.m_ops, type.m_ops + kWords);
    for (std::size_t k = 0; k + 2 < words.size(); ++k) {
      if ((words[k] & 0xFF000000U) != DDS_OP_ADR) continue;
      if ((words[k] & 0x00FF0000U) == DDS_OP_TYPE_ENU) words[k + 2] = 0xFFFFFFFFU;
      if ((words[k] & 0x00FFFF00U) == DDS_OP_TYPE_BLN) words[k] = (words[k] & ~0x00FF0000U) | DDS_OP_TYPE_1BY;
    }
    const_cast<std::uint32_t&>(type.m_flagset) &= ~static_cast<std::uint32_t>(DDS_TOPIC_XTYPES_METADATA);
    return words;
  }
  std::vector<std::uint8_t> bytes_of(const Message& message) {
    ddsi_serdata* taken = nullptr;
    dds_sample_info_t info;
    if (dds_write(scratch_writer_, transport::DdsSample(message).get()) != DDS_RETCODE_OK ||
        dds_takecdr(scratch_reader_, &taken, 1, &info, DDS_ANY_STATE) != 1)
      std::abort();
    sertype_ = taken->type;
    std::vector<std::uint8_t> bytes(ddsi_serdata_size(taken));
    ddsi_serdata_to_ser(taken, 0, bytes.size(), bytes.data());
    ddsi_serdata_unref(taken);
    return bytes;
  }

  dds_topic_descriptor_t type_;
  std::vector<std::uint32_t> operations_;
  dds_entity_t writer_ = 0, scratch_reader_ = 0, scratch_writer_ = 0;
  const ddsi_sertype* sertype_ = nullptr;
};

class Poisoner {
 public:
  Poisoner(int domain, bool named)
      : participant_(dds_create_participant(static_cast<dds_domainid_t>(domain), nullptr, nullptr)), named_(named) {}

  void send(const Message& message) {
    auto& writer = writers_[message.index()];
    if (!writer) {
      writer = std::make_unique<LooseWriter>(participant_, message.index());
      std::this_thread::sleep_for(std::chrono::seconds(1));  // until its readers are known
    }
    for (std::size_t place = 0;; ++place)
      for (std::size_t way = 0; way < kWays; ++way) {
        const Message mine = under_my_name(message);
        Message spoilt = mine;
        Spoiler spoiler(place, way);
        std::visit([&](auto& content) { spoiler("", content); }, spoilt);
        if (!spoiler.done()) return;
        sent_ += writer->send(mine, spoilt, spoiler.bytes_on_the_wire(), way) ? 1 : 0;
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
      }
  }
  [[nodiscard]] std::size_t sent() const { return sent_; }

 private:
  Message under_my_name(Message message) {
    auto& header = header_of(message);
    header.message_id += (named_ ? "-named-" : "-nameless-") + std::to_string(sent_);
    header.writer_id = named_ ? "poisoner" : "";
    header.stream_sequence = named_ ? ++sequences_[message.index()] : 0;
    return message;
  }

  dds_entity_t participant_;
  bool named_;
  std::map<std::size_t, std::unique_ptr<LooseWriter>> writers_;
  std::map<std::size_t, std::uint64_t> sequences_;
  std::size_t sent_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() != 2) return 2;
  Poisoner poisoner(std::atoi(words[0].c_str()), words[1] == "named");
  for (std::string line; std::getline(std::cin, line);) {
    const auto whole = nlohmann::json::parse(line, nullptr, false);
    const auto topic = value_of<Topic>(whole.value("topic", ""));
    const auto message =
        topic ? message_from_json(*topic, whole["message"].dump()) : Result<Message>(fail("is not a topic"));
    if (message)
      poisoner.send(*message);
    else
      std::fprintf(stderr, "%s\n", message.error().describe().c_str());
  }
  std::this_thread::sleep_for(std::chrono::seconds(2));
  std::printf("%zu\n", poisoner.sent());
  return poisoner.sent() > 0 ? 0 : 1;
}
