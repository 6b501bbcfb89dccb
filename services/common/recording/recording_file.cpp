#include "services/common/recording/recording_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>

#include "sealwatch/core/file.hpp"
#include "sealwatch/core/text.hpp"
#include "sealwatch/core/visible_text.hpp"
#include "services/common/recording/csv_reader.hpp"
#include "services/common/recording/hdf5_reader.hpp"
#include "services/common/recording/joined_tests.hpp"
#include "services/common/recording/log_reader.hpp"
#include "services/common/recording/mat_reader.hpp"
#include "services/common/recording/plausible_samples.hpp"
#include "services/common/recording/sidecar.hpp"
#include "services/common/recording/text_file.hpp"
#include "services/common/recording/vector_file.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch {
namespace {

namespace fs = std::filesystem;

/// The same error, of this file.
tl::unexpected<Error> fail_in(const std::string& file, Error error) {
  error.file = file;
  return fail(std::move(error));
}

Result<std::string> hash_file(const std::string& path) {
  Result<std::ifstream> in = open_file(path, kLargestRecording_bytes);
  if (!in) return fail(in.error());
  ContentHasher hasher;
  std::array<char, 1U << 16U> block{};
  while (in->read(block.data(), block.size()) || in->gcount() > 0)
    hasher.add({block.data(), static_cast<std::size_t>(in->gcount())});
  return hasher.hex();
}

/// One test, of a file in the project's own format.
Result<Log> one_test(Result<ColumnarSamples> samples, std::size_t first_row) {
  if (!samples) return fail(samples.error());
  Log log;
  log.left_aside = std::move(samples->left_aside);
  log.tests.push_back({.read = std::move(*samples), .start_time = {}, .clock = {}, .first_row = first_row});
  return log;
}

Result<Log> read_vectors(const std::string& path, const PlantDescription& plant, const ChannelMap& map) {
  const bool matlab = suffix_of(path) == ".mat";
  Result<Log> log;
  if (matlab && map.columns.empty()) {
    log = one_test(read_mat(path, plant), 1);
  } else {
    Result<std::vector<MatVariable>> vectors = matlab ? read_mat_vectors(path) : read_hdf5_vectors(path);
    if (!vectors) return fail(vectors.error());
    log = log_of_vectors(std::move(*vectors), plant, map);
  }
  if (!log) return log;
  const Result<std::string> hash = hash_file(path);
  if (!hash) return fail(hash.error());
  log->tests.front().read.content_hash = *hash;
  return log;
}

/// A file with none of the map's columns and with the header of docs/recordings.md: what this program wrote for an
/// asset whose own logs look otherwise. A map without columns, which says how a log is laid out, is of this one.
bool is_in_own_format(const FoundLayout& layout, const ChannelMap& map) {
  const auto is_time = [](const std::string& cell) { return cell == "time" || cell.starts_with("time["); };
  return !map.columns.empty() && layout.delimiter == ',' && layout.header_row == 1 && layout.units_row == 0 &&
         !has_a_column_of(layout, map) && std::ranges::any_of(layout.header, is_time);
}

Result<Log> read_text(const std::string& path, const PlantDescription& plant, const ChannelMap& map) {
  const Result<std::unique_ptr<std::istream>> text = open_text(path);
  if (!text) return fail(text.error());
  std::istream* const in = text->get();
  const bool jumps = map.log.repeated_times == "jump";
  if (map.empty()) return one_test(read_csv(*in, plant, jumps), 2);
  const Result<FoundLayout> layout = layout_of(*in, map.log);
  if (layout && is_in_own_format(*layout, map)) return one_test(read_csv(*in, plant, jumps), 2);
  return read_log(*in, plant, map);
}

/// What is in one file, by its suffix.
Result<Log> read_file(const std::string& path, const PlantDescription& plant, const ChannelMap& map) {
  const std::string suffix = suffix_of(path);
  if (suffix == ".parquet" || suffix == ".feather" || suffix == ".xlsx" || suffix == ".tdms")
    return fail(error_at({}, {}, suffix + " files are not read", "export it as CSV, HDF5 or MATLAB"));
  const bool vectors = suffix == ".mat" || suffix == ".h5" || suffix == ".hdf5";
  return vectors ? read_vectors(path, plant, map) : read_text(path, plant, map);
}

std::string sidecar_path(const std::string& path) { return fs::path(path).replace_extension(".yaml").string(); }

/// The text of the sidecar of `path`, "" where there is none.
Result<std::string> read_sidecar_text(const std::string& file) {
  if (std::error_code ignored; !fs::exists(file, ignored)) return std::string();
  return sealwatch::read_file(file, kLongestSidecar_bytes);
}

/// The sidecar of `path`; nothing said where there is none.
Result<Sidecar> read_sidecar(const std::string& path, const PlantDescription& plant) {
  const std::string file = sidecar_path(path);
  const Result<std::string> text = read_sidecar_text(file);
  if (!text) return fail(text.error());
  Result<Sidecar> sidecar = parse_sidecar(*text, plant);
  if (sidecar) return sidecar;
  Error error = sidecar.error();
  text::add_to_list(error.advice, "this file is read as the sidecar of " + path, "; ");
  return fail_in(file, error);
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

namespace {

Result<Recording> recording_of(const std::string& path, LogTest test, const Sidecar& sidecar,
                               const PlantDescription& plant) {
  if (const Status checked = check_plausible(test.read.samples, plant, test.first_row); !checked)
    return fail_in(path, checked.error());
  Recording recording;
  recording.file = path;
  recording.recording_id = fs::path(path).stem().string();
  if (!is_visible(recording.recording_id)) recording.recording_id = printable(recording.recording_id);
  recording.content_hash = std::move(test.read.content_hash);
  recording.samples = std::move(test.read.samples);
  if (const Status applied = apply_sidecar(sidecar, test.read.columns, recording); !applied)
    return fail_in(sidecar_path(path), applied.error());
  if (!recording.start_time) recording.start_time = test.start_time;
  return recording;
}

}  // namespace

Result<std::vector<Recording>> read_recordings(const std::string& path, const PlantDescription& plant,
                                               const ChannelMap& map) {
  const std::vector<std::string> parts = parts_of(path);
  JoinedTests joined(map.log.time_resets);
  std::vector<std::string> left_aside, warnings;
  for (const std::string& part : parts) {
    Result<Log> log = read_file(part, plant, map);
    if (!log) return fail_in(part, log.error());
    if (left_aside.empty()) left_aside = std::move(log->left_aside);
    for (std::string& warning : log->warnings)
      if (std::ranges::find(warnings, warning) == warnings.end()) warnings.push_back(std::move(warning));
    if (const Status appended = joined.append(part, std::move(log->tests)); !appended)
      return fail_in(part, appended.error());
  }
  std::vector<LogTest> tests = joined.take();
  for (const LogTest& test : tests)
    if (tests.size() > 1 && test.read.samples.time_s.size() < 2)
      return fail_in(parts.back(), error_at("row " + std::to_string(test.first_row) + ", column time", {},
                                            "the test that begins here has one sample alone",
                                            "take the row out, or log: {time_resets: join}"));
  const Result<Sidecar> sidecar = read_sidecar(parts.front(), plant);
  if (!sidecar) return fail(sidecar.error());
  std::vector<Recording> recordings;
  for (LogTest& test : tests) {
    Result<Recording> recording = recording_of(parts.front(), std::move(test), *sidecar, plant);
    if (!recording) return fail(recording.error());
    recording->left_aside = left_aside;
    recording->warnings = warnings;
    if (tests.size() > 1) recording->recording_id.append("#").append(std::to_string(recordings.size() + 1));
    recordings.push_back(std::move(*recording));
  }
  return recordings;
}

Result<Recording> read_recording(const std::string& path, const PlantDescription& plant, const ChannelMap& map) {
  Result<std::vector<Recording>> all = read_recordings(path, plant, map);
  if (!all) return fail(all.error());
  if (all->size() > 1)
    return fail_in(path, error_at({}, {}, "holds " + std::to_string(all->size()) + " tests where one is wanted"));
  return std::move(all->front());
}

}  // namespace sealwatch
