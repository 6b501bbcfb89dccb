// dds_rights CONFIG: what the identity in CYCLONEDDS_URI may do, as DDS Security itself decides it. Prints "write TOPIC"
// and "read TOPIC" for all that it may. Publishes empty messages: not for a domain where services run.
#include <cstdio>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "sealwatch/message/retraction.hpp"
#include "services/cli/session.hpp"

namespace sealwatch {
namespace {

void tell(const char* way, std::string_view topic, const Status& done) {
  if (done) std::printf("%s %s\n", way, std::string(topic).c_str());
}

template <std::size_t... Index>
void try_messages(Bus& bus, std::index_sequence<Index...> /*topics*/) {
  (tell("write", name_of(static_cast<Topic>(Index)),
        bus.publish(Message(std::variant_alternative_t<Index, MessageAlternatives>{}))),
   ...);
}

}  // namespace
}  // namespace sealwatch

int main(int argc, char** argv) {
  using namespace sealwatch;
  if (argc != 2) return 2;
  const auto session = cli::open_session(argv[1]);
  if (!session) return 2;
  Bus& bus = *session->bus;
  try_messages(bus, std::make_index_sequence<std::variant_size_v<MessageAlternatives>>{});
  MaintenanceEvent retraction;
  retraction.kind = kTestRetracted;
  tell("write", "retraction", bus.publish(Message(retraction)));
  tell("write", "service_status", bus.publish(ServiceStatus{}));
  tell("write", "resend_request", bus.publish(ResendRequest{}));
  for (std::size_t index = 0; index < std::variant_size_v<MessageAlternatives>; ++index) {
    const auto topic = static_cast<Topic>(index);
    const Status subscribed = bus.subscribe(std::span(&topic, 1));
    tell("read", name_of(topic), subscribed);
    if (topic == Topic::maintenance_event) tell("read", "retraction", subscribed);  // both, or neither
  }
  tell("read", "service_status", bus.subscribe_service_topics());
  return 0;
}
