// Messages as JSON text, both ways. Field names are those of the structs; enums are written by name.
#pragma once

#include <string>
#include <string_view>

#include "sealwatch/core/result.hpp"
#include "sealwatch/message/topics.hpp"

namespace sealwatch {

/// How long arrays of numbers are written.
enum class JsonForm {
  readable,  ///< numbers as decimals; NaN and infinities as null
  exact,     ///< vector<double> as base64 of little-endian doubles: bit-exact and fast, for the journal
};

[[nodiscard]] std::string to_json(const Message& message, JsonForm form = JsonForm::readable);
[[nodiscard]] std::string to_json(const ServiceStatus& status);
[[nodiscard]] std::string to_json(const AlarmEntry& entry);

/// Reads what to_json wrote, in either form; absent fields keep their defaults, unknown fields are passed over (so that
/// an older reader reads a newer journal). Errors name the field.
[[nodiscard]] Result<Message> message_from_json(Topic topic, std::string_view text);
[[nodiscard]] Result<AlarmEntry> alarm_from_json(std::string_view text);

}  // namespace sealwatch
