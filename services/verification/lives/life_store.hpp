// A folder of records: settings.txt says what was run, lives/000123.life is the record of one life.
//
// Each record is written to a file of another name and then renamed, so that an interrupted run leaves whole records
// only. Shards write to folders of their own.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "services/verification/lives/life_record.hpp"

namespace sealwatch::verification {

class LifeStore {
 public:
  /// Makes the folder. An Error when it holds records and `resume` is not set, or records of another setting.
  [[nodiscard]] static Result<LifeStore> create(const std::string& folder, const std::string& setting_text,
                                                bool resume);
  /// Opens one that was made before.
  [[nodiscard]] static Result<LifeStore> open(const std::string& folder);

  [[nodiscard]] const std::string& setting_text() const { return setting_text_; }
  [[nodiscard]] const std::string& folder() const { return folder_; }
  /// True for a whole, undamaged record.
  [[nodiscard]] bool has(std::uint32_t life) const { return read(life).has_value(); }
  [[nodiscard]] Status write(const LifeRecord& record) const;
  [[nodiscard]] Result<LifeRecord> read(std::uint32_t life) const;
  /// Numbers of the lives that have a file, in increasing order.
  [[nodiscard]] Result<std::vector<std::uint32_t>> lives() const;

 private:
  LifeStore(std::string folder, std::string setting_text)
      : folder_(std::move(folder)), setting_text_(std::move(setting_text)) {}
  [[nodiscard]] std::string file_of(std::uint32_t life) const;

  std::string folder_;
  std::string setting_text_;
};

/// The lives of one run, wherever their records are.
class LifeCollection {
 public:
  /// All lives 0 .. n-1 of one setting, each once. An Error for stores of different settings, a life that is missing,
  /// or one whose records differ.
  [[nodiscard]] static Result<LifeCollection> make(std::vector<LifeStore> stores);

  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(store_of_.size()); }
  [[nodiscard]] Result<LifeRecord> read(std::uint32_t life) const { return stores_[store_of_[life]].read(life); }
  [[nodiscard]] const std::string& setting_text() const { return stores_.front().setting_text(); }
  /// Values of a key of the setting, in their order.
  [[nodiscard]] std::vector<std::string> values_of(const std::string& key) const;

 private:
  std::vector<LifeStore> stores_;
  std::vector<std::size_t> store_of_;  ///< by life
};

/// The first line in which two settings differ, for people.
[[nodiscard]] std::string first_difference(const std::string& ours, const std::string& theirs);

}  // namespace sealwatch::verification
