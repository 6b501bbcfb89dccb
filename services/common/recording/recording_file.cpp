#include "services/common/recording/recording_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "sealwatch/core/text.hpp"
#include "services/common/recording/csv_reader.hpp"
#include "services/common/recording/mat_reader.hpp"
#include "services/common/recording/sidecar.hpp"

namespace sealwatch {
namespace {

namespace fs = std::filesystem;

/// The same error, of this file.
tl::unexpected<Error> fail_in(const std::string& file, Error error) {
  error.file = file;
  return fail(std::move(error));
}

Result<std::ifstream> open(const std::string& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return fail_in(path, error_at({}, {}, "is a directory"));
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in) return fail_in(path, error_at({}, {}, std::string("cannot be opened: ") + std::strerror(errno)));
  return in;
}

Result<std::string> hash_file(const std::string& path) {
  Result<std::ifstream> in = open(path);
  if (!in) return fail(in.error());
  ContentHasher hasher;
  std::array<char, 1U << 16U> block{};
  while (in->read(block.data(), block.size()) || in->gcount() > 0)
    hasher.add({block.data(), static_cast<std::size_t>(in->gcount())});
  return hasher.hex();
}

Result<ColumnarSamples> read_samples(const std::string& path, const PlantDescription& plant) {
  if (suffix_of(path) != ".mat") {
    Result<std::ifstream> in = open(path);
    return in ? read_csv(*in, plant) : fail(in.error());
  }
  const Result<std::string> hash = hash_file(path);
  if (!hash) return fail(hash.error());
  Result<ColumnarSamples> samples = read_mat(path, plant);
  if (samples) samples->content_hash = *hash;
  return samples;
}

std::string sidecar_path(const std::string& path) { return fs::path(path).replace_extension(".yaml").string(); }

/// The text of the sidecar of `path`, "" where there is none.
Result<std::string> read_sidecar_text(const std::string& file) {
  if (std::error_code ignored; !fs::exists(file, ignored)) return std::string();
  Result<std::ifstream> in = open(file);
  if (!in) return fail(in.error());
  std::string text(kLongestSidecar_bytes + 1, '\0');
  in->read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in->gcount()));
  if (text.size() > kLongestSidecar_bytes)
    return fail_in(file, error_at({}, {}, "is longer than " + std::to_string(kLongestSidecar_bytes) + " bytes"));
  return text;
}

/// The sidecar of `path`; nothing said where there is none.
Result<Sidecar> read_sidecar(const std::string& path, const PlantDescription& plant) {
  const std::string file = sidecar_path(path);
  const Result<std::string> text = read_sidecar_text(file);
  if (!text) return fail(text.error());
  Result<Sidecar> sidecar = parse_sidecar(*text, plant);
  return sidecar ? sidecar : fail_in(file, sidecar.error());
}

}  // namespace

namespace {

Result<std::string> recorded_value(const std::string& path, const std::string& key) {
  const std::string file = sidecar_path(path);
  const Result<std::string> text = read_sidecar_text(file);
  if (!text) return fail(text.error());
  Result<std::string> value = parse_sidecar_value(*text, key);
  return value ? value : fail_in(file, value.error());
}

}  // namespace

std::string suffix_of(const std::string& path) {
  std::string suffix = fs::path(path).extension().string();
  std::ranges::transform(suffix, suffix.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return suffix;
}

Result<std::string> recorded_asset_id(const std::string& path) { return recorded_value(path, "asset_id"); }

std::optional<UtcTime> recorded_start_time(const std::string& path) {
  const Result<std::string> text = recorded_value(path, "start_time");
  if (!text) return {};
  const auto time = parse_utc(*text);
  return time ? std::optional(*time) : std::nullopt;
}

Result<Recording> read_recording(const std::string& path, const PlantDescription& plant) {
  Result<ColumnarSamples> read = read_samples(path, plant);
  if (!read) return fail_in(path, read.error());
  const Result<Sidecar> sidecar = read_sidecar(path, plant);
  if (!sidecar) return fail(sidecar.error());
  Recording recording;
  recording.file = path;
  recording.recording_id = fs::path(path).stem().string();
  if (!is_utf8(recording.recording_id)) recording.recording_id = printable(recording.recording_id);
  recording.content_hash = std::move(read->content_hash);
  recording.samples = std::move(read->samples);
  if (const Status applied = apply_sidecar(*sidecar, read->columns, recording); !applied)
    return fail_in(sidecar_path(path), applied.error());
  return recording;
}

}  // namespace sealwatch
