// The archive of an FMU: a ZIP file with modelDescription.xml, binaries/<platform>/ and resources/ (FMI 2.0.4 section
// 2.3, FMI 3.0.1 section 2.5). It comes from outside: every member's name and kind is checked before anything is
// written, and only what a simulation needs is unpacked, into a temporary folder that goes with the object.
//
// Refused by name: what is no archive or damaged, encrypted members, names that lead out of the folder (".." or from
// the root), symbolic links and other special files, a member twice, more or larger members than the limits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "services/common/fmi/temporary_folder.hpp"

namespace sealwatch::fmi {

struct ArchiveLimits {
  std::size_t members = 20000;
  std::uint64_t description_bytes = 64ULL << 20U;  ///< of modelDescription.xml
  std::uint64_t member_bytes = 1ULL << 30U;
  std::uint64_t total_bytes = 2ULL << 30U;  ///< of all that is unpacked
};

inline constexpr const char* kDescriptionName = "modelDescription.xml";

struct UnpackedFmu {
  std::string file;  ///< the archive, as the user named it
  TemporaryFolder folder;
  std::vector<std::string> members;  ///< names of all members, unpacked or not, with '/' between folders
  [[nodiscard]] std::filesystem::path path_of(const std::string& member) const { return folder.path() / member; }
  [[nodiscard]] bool has(const std::string& member) const;
};

/// From now on the one FMU that is opened is the one that lies unpacked in this folder, which is somebody else's.
void use_unpacked(const std::string& folder);
[[nodiscard]] Result<UnpackedFmu> unpack_fmu(const std::string& file, const ArchiveLimits& limits = {});

}  // namespace sealwatch::fmi
