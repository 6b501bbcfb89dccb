#include "services/verification/trial/mismatch_records.hpp"

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "sealwatch/core/file.hpp"

namespace sealwatch::cli {
namespace {

using Json = nlohmann::ordered_json;
using verification::MismatchRecord;

constexpr std::uint64_t kLargestRecords_bytes = 1'000'000'000;

template <class T>
constexpr bool kIsVector = false;
template <class T>
constexpr bool kIsVector<std::vector<T>> = true;

Json write(const Described auto& value);

template <class T>
Json write_value(const T& value) {
  if constexpr (std::is_floating_point_v<T>) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
  } else if constexpr (kIsVector<T>) {
    Json list = Json::array();
    for (const auto& element : value) list.push_back(write_value(element));
    return list;
  } else if constexpr (Described<T>) {
    return write(value);
  } else {
    return value;
  }
}

Json write(const Described auto& value) {
  Json json = Json::object();
  value.visit([&json](std::string_view name, const auto& field) { json[std::string(name)] = write_value(field); },
              value);
  return json;
}

template <class T>
void read_value(const Json& json, T& value) {
  if constexpr (Described<T>) {
    T::visit(
        [&json](std::string_view name, auto& field) {
          if (const auto found = json.find(name); found != json.end()) read_value(*found, field);
        },
        value);
  } else if constexpr (std::is_floating_point_v<T>) {
    value = json.is_null() ? std::numeric_limits<T>::infinity() : json.get<T>();
  } else if constexpr (kIsVector<T>) {
    value.clear();
    for (const Json& element : json) {
      value.emplace_back();
      read_value(element, value.back());
    }
  } else {
    value = json.get<T>();
  }
}

}  // namespace

std::string to_json_line(const MismatchRecord& record) { return write(record).dump(); }

Result<std::vector<MismatchRecord>> read_mismatch_records(const std::string& file) {
  std::vector<MismatchRecord> records;
  if (std::error_code none; !std::filesystem::exists(file, none)) return records;
  Result<std::ifstream> stream = open_file(file, kLargestRecords_bytes);
  if (!stream) return fail(stream.error());
  std::string line;
  for (int number = 1; std::getline(*stream, line); ++number) {
    const bool cut = stream->eof();
    try {
      MismatchRecord record;
      read_value(Json::parse(line), record);
      records.push_back(std::move(record));
    } catch (const Json::exception& problem) {
      if (cut) break;
      return fail(Error{.file = file,
                        .place = "line " + std::to_string(number),
                        .value = {},
                        .rule = std::string("is not a record of a trial: ") + problem.what(),
                        .advice = "remove the line: --resume makes the set again"});
    }
  }
  return records;
}

std::string tallies_to_json(std::span<const verification::TrialTally> tallies) {
  Json json = {{"schema", "sealwatch.mismatch_trial/1"}, {"strata", Json::array()}};
  for (const verification::TrialTally& tally : tallies) json["strata"].push_back(write(tally));
  return json.dump(1) + "\n";
}

}  // namespace sealwatch::cli
