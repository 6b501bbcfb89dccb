#include "services/common/fmi/temporary_folder.hpp"

#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): mkdtemp is not in <cstdlib>

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

namespace sealwatch::fmi {

Result<TemporaryFolder> TemporaryFolder::create() {
  std::error_code error;
  const std::filesystem::path parent = std::filesystem::temp_directory_path(error);
  std::string name = (parent / "sealwatch_fmu_XXXXXX").string();
  if (error || mkdtemp(name.data()) == nullptr)
    return fail(Error{.file = name,
                      .place = {},
                      .value = error ? error.message() : std::strerror(errno),
                      .rule = "no temporary folder can be made for the FMU",
                      .advice = "set TMPDIR to a folder that can be written"});
  return TemporaryFolder(name);
}

TemporaryFolder TemporaryFolder::borrow(std::filesystem::path path) {
  TemporaryFolder folder(std::move(path));
  folder.borrowed_ = true;
  return folder;
}

TemporaryFolder::TemporaryFolder(TemporaryFolder&& other) noexcept
    : path_(std::exchange(other.path_, {})), borrowed_(other.borrowed_) {}

TemporaryFolder& TemporaryFolder::operator=(TemporaryFolder&& other) noexcept {
  if (this != &other) {
    remove();
    path_ = std::exchange(other.path_, {});
    borrowed_ = other.borrowed_;
  }
  return *this;
}

TemporaryFolder::~TemporaryFolder() { remove(); }

void TemporaryFolder::remove() noexcept {
  std::error_code ignored;
  if (!path_.empty() && !borrowed_) std::filesystem::remove_all(path_, ignored);
}

}  // namespace sealwatch::fmi
