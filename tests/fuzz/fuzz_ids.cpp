// Any text as the id of an act, a time or a connection string: nothing, or something that says what it was made of; never
// a crash. A password is never shown, whatever it is.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "sealwatch/core/visible_text.hpp"
#include "sealwatch/message/alarm_acts.hpp"
#include "sealwatch/message/confirmation.hpp"
#include "sealwatch/message/retraction.hpp"
#include "services/common/store/connection_string.hpp"

namespace {

using namespace sealwatch;

void require(bool holds) {
  if (!holds) std::abort();
}

void read_ids(const std::string& text) {
  if (const auto retraction = retraction_of("A/1", text)) {
    const int said =
        (retraction->pst_id.empty() ? 0 : 1) + (retraction->since ? 1 : 0) + (retraction->withdrawn_id.empty() ? 0 : 1);
    require(said == 1 && is_retraction_id(text));
  }
  if (const auto confirmed = confirmed_act("A/1", text)) require(!confirmed->empty() && text.ends_with(*confirmed));
  for (const auto kind : {kAlarmShelved, kAlarmUnshelved, kAssetOutOfService, kAssetInService}) {
    MaintenanceEvent event;
    event.asset_id = "A/1";
    event.kind = kind;
    event.header.message_id = text;
    (void)alarm_act_of(event);
  }
  if (const auto time = parse_utc(text)) require(parse_utc(format_utc(*time)) == *time);
  if (is_valid_utf8(text)) require(is_visible(visible(text), true));
}

void mask(const std::string& text) {
  std::string quoted = "'";
  for (const char letter : text)
    if (letter == '\'' || letter == '\\')
      quoted.append({'\\', letter});
    else
      quoted += letter;
  const std::string connection = "postgresql://dbname=x PASSWORD = " + quoted + "' user=u";
  require(shown(connection).text == "postgresql://dbname=x PASSWORD = *** user=u");
  (void)without_secrets_of(text, "could not connect: " + text);
  (void)without_secrets_of("postgresql://" + text, text);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  read_ids(text);
  mask(text);
  return 0;
}
