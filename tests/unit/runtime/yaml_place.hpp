// A directory with configuration files of a test.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/unit/store/place.hpp"

namespace sealwatch::testing {

class YamlPlace {
 public:
  /// Writes `text` to the file `name` in the directory and returns its path.
  std::string write(const std::string& name, const std::string& text) const {
    const std::filesystem::path file = place_.directory() / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text;
    return file.string();
  }
  [[nodiscard]] std::string directory() const { return place_.directory().string(); }
  /// The text without this test's directory in front of file names.
  [[nodiscard]] std::string bare(std::string text) const {
    const std::string prefix = directory() + "/";
    for (std::size_t at = text.find(prefix); at != std::string::npos; at = text.find(prefix))
      text.erase(at, prefix.size());
    return text;
  }

 private:
  Place place_;
};

}  // namespace sealwatch::testing
