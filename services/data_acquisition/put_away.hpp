// A recording and its sidecar leave the folder where recordings are dropped, and overwrite nothing: strangers write
// there, and the same name may come again.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "sealwatch/core/result.hpp"

namespace sealwatch {

/// Why a file of the folder is not looked at: it, or its sidecar, is a symbolic link, which may lead anywhere.
[[nodiscard]] std::optional<Error> not_a_file_of_its_own(const std::filesystem::path& recording);

/// Moves `recording`, then its sidecar, to `folder` beside it, which is made if need be and must be no symbolic link.
/// Where the name is taken, both become NAME.2, NAME.3, ...; of one too long for a reason beside it the end is cut.
/// Returns where the recording is now.
[[nodiscard]] Result<std::filesystem::path> put_away(const std::filesystem::path& recording, const std::string& folder);

/// Writes a new file; never through a link or over one that is there.
void write_new(const std::filesystem::path& file, const std::string& text);

}  // namespace sealwatch
