// A folder of its own under the system's temporary folder ($TMPDIR, else /tmp), readable by its owner alone, removed
// with everything in it at the end.
#pragma once

#include <filesystem>

#include "sealwatch/core/result.hpp"

namespace sealwatch::fmi {

class TemporaryFolder {
 public:
  [[nodiscard]] static Result<TemporaryFolder> create();
  /// One that belongs to somebody else, who removes it.
  [[nodiscard]] static TemporaryFolder borrow(std::filesystem::path path);
  TemporaryFolder(TemporaryFolder&& other) noexcept;
  TemporaryFolder& operator=(TemporaryFolder&& other) noexcept;
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder();
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  explicit TemporaryFolder(std::filesystem::path path) : path_(std::move(path)) {}
  void remove() noexcept;
  std::filesystem::path path_;
  bool borrowed_ = false;
};

}  // namespace sealwatch::fmi
