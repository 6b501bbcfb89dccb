#include "services/data_acquisition/pst_id.hpp"

#include <string_view>

#include "sealwatch/core/text.hpp"
#include "sealwatch/core/time.hpp"
#include "sealwatch/message/id_part.hpp"
#include "sealwatch/message/made_up.hpp"

namespace sealwatch {
namespace {

constexpr std::size_t kHashDigits = 8;

void append_bytes(std::string& bytes, const std::vector<double>& values) {
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double));
}

std::string hash_of(const TimeSeries& samples) {
  std::string bytes;
  append_bytes(bytes, samples.time_s);
  for (const Series& channel : samples.channels) {
    bytes += channel.name;
    append_bytes(bytes, channel.values);
  }
  return content_hash(bytes);
}

/// A file's whole name would make ids that no layer takes.
std::string short_name(const std::string& recording_id) {
  constexpr std::size_t kLongestName = 100;
  return recording_id.size() > kLongestName ? content_hash(recording_id) : id_part(recording_id);
}

/// "20310412T030000Z", fractions of a second kept: format_utc without its separators.
std::string compact(UtcTime time) {
  std::string result;
  for (const char letter : format_utc(time))
    if (letter != '-' && letter != ':') result += letter;
  return result;
}

}  // namespace

std::string make_pst_id(const RawSamples& first_block) {
  std::string when = "undated";
  if (first_block.start_time_known)
    when = compact({.nanoseconds = first_block.start_time_ns});
  else if (!first_block.recording_id.empty())
    when = short_name(first_block.recording_id);
  const std::string content =
      first_block.content_hash.empty() ? hash_of(first_block.samples) : id_part(first_block.content_hash);
  return id_part(first_block.asset_id) + "-" + when + "-" + content.substr(0, kHashDigits) +
         std::string(is_made_up(first_block.source_id) ? kEndOfMadeUpId : "");
}

}  // namespace sealwatch
