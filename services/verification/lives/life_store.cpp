#include "services/verification/lives/life_store.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>
#include <utility>

#include "sealwatch/core/file.hpp"
#include "services/common/text/format.hpp"

namespace sealwatch::verification {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSettingFile = "settings.txt";
constexpr std::uint64_t kLargestLife_bytes = 100'000'000;
constexpr const char* kLives = "lives";
constexpr std::string_view kSuffix = ".life";

Error about(const std::string& file, std::string rule, std::string advice = {}) {
  return {.file = file, .place = {}, .value = {}, .rule = std::move(rule), .advice = std::move(advice)};
}

Result<std::string> contents(const fs::path& file) { return read_file(file.string(), kLargestLife_bytes); }

Status write_whole(const fs::path& file, const std::string& bytes) {
  std::ostringstream unique;
  unique << file.string() << "." << std::this_thread::get_id() << ".part";
  const fs::path part = unique.str();
  std::ofstream stream(part, std::ios::binary | std::ios::trunc);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  std::error_code problem;
  if (stream) fs::rename(part, file, problem);
  if (!stream || problem) return fail(about(file.string(), "cannot be written", "is there space and permission?"));
  return {};
}

bool same_record(const LifeStore& a, const LifeStore& b, std::uint32_t life) {
  const auto one = a.read(life);
  const auto other = b.read(life);
  return one && other && *one == *other;
}

}  // namespace

std::string first_difference(const std::string& ours, const std::string& theirs) {
  std::istringstream a(ours), b(theirs);
  std::string one, other;
  while (true) {
    const bool more_a = static_cast<bool>(std::getline(a, one));
    const bool more_b = static_cast<bool>(std::getline(b, other));
    if (!more_a && !more_b) return {};
    if (!more_a) one = "(nothing)";
    if (!more_b) other = "(nothing)";
    if (one != other) return std::string("'").append(one).append("' against '").append(other).append("'");
  }
}

Result<LifeStore> LifeStore::create(const std::string& folder, const std::string& setting_text, bool resume) {
  std::error_code problem;
  fs::create_directories(fs::path(folder) / kLives, problem);
  if (problem) return fail(about(folder, "cannot be made: " + problem.message()));
  const fs::path setting_file = fs::path(folder) / kSettingFile;
  LifeStore store(folder, setting_text);
  if (fs::exists(setting_file)) {
    const auto before = contents(setting_file);
    if (!before) return fail(before.error());
    const auto known = store.lives();
    if (!known) return fail(known.error());
    if (!known->empty() && !resume)
      return fail(about(folder, "holds " + std::to_string(known->size()) + " lives of an earlier run",
                        "--resume goes on with it, or choose another folder"));
    if (!known->empty() && *before != setting_text)
      return fail(about(folder, "holds lives of another setting: " + first_difference(*before, setting_text),
                        "resume with the same options, or choose another folder"));
  }
  if (const Status written = write_whole(setting_file, setting_text); !written) return fail(written.error());
  return store;
}

Result<LifeStore> LifeStore::open(const std::string& folder) {
  auto text = contents(fs::path(folder) / kSettingFile);
  if (!text)
    return fail(about(folder, "is not a folder of a verification", "give the --out of `sealwatch verify rul`"));
  return LifeStore(folder, std::move(*text));
}

std::string LifeStore::file_of(std::uint32_t life) const {
  return (fs::path(folder_) / kLives / text::format("{:06}{}", life, kSuffix)).string();
}

Status LifeStore::write(const LifeRecord& record) const { return write_whole(file_of(record.life), to_bytes(record)); }

Result<LifeRecord> LifeStore::read(std::uint32_t life) const {
  const std::string file = file_of(life);
  const auto bytes = contents(file);
  if (!bytes) return fail(bytes.error());
  auto record = life_from_bytes(*bytes);
  if (!record) {
    record.error().file = file;
    return record;
  }
  if (record->life != life) return fail(about(file, "is the record of life " + std::to_string(record->life)));
  return record;
}

Result<std::vector<std::uint32_t>> LifeStore::lives() const {
  std::vector<std::uint32_t> numbers;
  std::error_code problem;
  for (const auto& entry : fs::directory_iterator(fs::path(folder_) / kLives, problem)) {
    const std::string name = entry.path().filename().string();
    if (!name.ends_with(kSuffix)) continue;
    const std::string digits = name.substr(0, name.size() - kSuffix.size());
    if (digits.empty() || digits.size() > 9 || digits.find_first_not_of("0123456789") != std::string::npos) continue;
    numbers.push_back(static_cast<std::uint32_t>(std::stoul(digits)));
  }
  if (problem) return fail(about(folder_, "has no lives: " + problem.message()));
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

Result<LifeCollection> LifeCollection::make(std::vector<LifeStore> stores) {
  if (stores.empty()) return fail("there is nothing to merge", "give the folders of the shards");
  LifeCollection collection;
  collection.stores_ = std::move(stores);
  const std::string& setting = collection.setting_text();
  for (const LifeStore& store : collection.stores_)
    if (store.setting_text() != setting)
      return fail(about(store.folder(), "is of another run: " + first_difference(setting, store.setting_text()),
                        "merge shards of one run only"));
  const std::vector<std::string> lives = collection.values_of("lives");
  const std::size_t count = lives.size() == 1 ? std::stoul(lives.front()) : 0;
  constexpr std::size_t kNowhere = static_cast<std::size_t>(-1);
  collection.store_of_.assign(count, kNowhere);
  for (std::size_t k = 0; k < collection.stores_.size(); ++k) {
    const auto numbers = collection.stores_[k].lives();
    if (!numbers) return fail(numbers.error());
    for (const std::uint32_t life : *numbers) {
      if (life >= count)
        return fail(about(collection.stores_[k].folder(),
                          "has life " + std::to_string(life) + " of a run of " + std::to_string(count)));
      std::size_t& place = collection.store_of_[life];
      if (place != kNowhere && !same_record(collection.stores_[place], collection.stores_[k], life))
        return fail(about(collection.stores_[k].folder(),
                          "has another life " + std::to_string(life) + " than " + collection.stores_[place].folder()));
      if (place == kNowhere) place = k;
    }
  }
  const auto missing = std::count(collection.store_of_.begin(), collection.store_of_.end(), kNowhere);
  const auto first = std::find(collection.store_of_.begin(), collection.store_of_.end(), kNowhere);
  if (count == 0 || missing > 0)
    return fail(std::to_string(missing) + " of " + std::to_string(count) + " lives are missing, the first is number " +
                    std::to_string(first - collection.store_of_.begin()),
                "run the shard that has it, or resume it");
  return collection;
}

std::vector<std::string> LifeCollection::values_of(const std::string& key) const {
  std::vector<std::string> values;
  std::istringstream text(setting_text());
  for (std::string line; std::getline(text, line);)
    if (line.starts_with(key + " = ")) values.push_back(line.substr(key.size() + 3));
  return values;
}

}  // namespace sealwatch::verification
