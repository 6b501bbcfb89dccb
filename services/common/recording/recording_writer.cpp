#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "services/common/recording/recording_file.hpp"
#include "services/common/recording/sidecar.hpp"

namespace sealwatch {
namespace {

namespace fs = std::filesystem;

void append_number(std::string& out, double value, int significant_digits) {
  std::array<char, 32> text{};
  const auto end = significant_digits == kExactDigits
                       ? std::to_chars(text.begin(), text.end(), value)
                       : std::to_chars(text.begin(), text.end(), value, std::chars_format::general, significant_digits);
  out.append(text.data(), end.ptr);
}

std::string format_csv(const TimeSeries& samples, int significant_digits) {
  std::string out = "time[s]";
  for (const Series& channel : samples.channels) out += "," + channel.name + "[" + channel.unit + "]";
  out += '\n';
  for (std::size_t row = 0; row < samples.time_s.size(); ++row) {
    append_number(out, samples.time_s[row], kExactDigits);
    for (const Series& channel : samples.channels) {
      out += ',';
      append_number(out, channel.values[row], significant_digits);
    }
    out += '\n';
  }
  return out;
}

/// Writes beside `path` and moves it there when it is complete.
Status write_whole(const std::string& path, const std::string& text) {
  const auto failed = [&path](const std::string& why) {
    return fail(Error{.file = path, .place = {}, .value = {}, .rule = "cannot be written: " + why, .advice = {}});
  };
  const std::string part = path + ".part";
  errno = 0;
  std::ofstream out(part, std::ios::binary | std::ios::trunc);
  out << text;
  out.close();
  if (!out) return failed(std::strerror(errno));
  std::error_code error;
  fs::rename(part, path, error);
  if (error) return failed(error.message());
  return {};
}

}  // namespace

Status write_recording_csv(const Recording& recording, const std::string& path, int significant_digits) {
  const std::string sidecar = fs::path(path).replace_extension(".yaml").string();
  if (Status status = write_whole(sidecar, format_sidecar(recording)); !status) return status;
  return write_whole(path, format_csv(recording.samples, std::min(significant_digits, 17)));
}

}  // namespace sealwatch
