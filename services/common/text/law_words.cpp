#include "services/common/text/law_words.hpp"

#include "services/common/text/words.hpp"

namespace sealwatch::text {

std::string law_at(std::string_view law, std::string_view element, std::string_view name,
                   std::string_view preposition) {
  constexpr std::string_view kSensor = "sensor:";
  constexpr std::string_view kInput = "input:";
  std::string text(law);
  if (element.starts_with(kSensor)) return text.append(" of ").append(in_words(element.substr(kSensor.size())));
  if (element.starts_with(kInput))
    return text.append(" of the recorded ").append(in_words(element.substr(kInput.size())));
  if (element == "clock") return text.append(" of the recording");
  return text.append(" ").append(element == "fluid" ? "in" : preposition).append(" ").append(name);
}

}  // namespace sealwatch::text
