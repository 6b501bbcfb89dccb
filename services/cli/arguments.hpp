// What the command lines of sealwatch's programs share: checks of arguments, and what an exit status means.
#pragma once

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>

namespace sealwatch::cli {

inline constexpr const char* kExitStatus =
    "Exit status: 0 ok; 1 it ran and the answer is \"no\"; 2 bad usage or input; 3 internal failure.";

/// Each check returns what is wrong, "" where nothing is.
inline std::string not_negative(const std::string& text) { return text.starts_with("-") ? "must not be negative" : ""; }

/// CLI::Range lets what is not a number pass.
inline std::string a_number(const std::string& text) {
  return std::isnan(std::strtod(text.c_str(), nullptr)) ? "must be a number" : "";
}

/// An asset is given by its file: whoever gives the id is told so. Of what is there its reader says more.
inline std::string an_asset_file(const std::string& text) {
  std::error_code none;
  if (std::filesystem::exists(text, none)) return {};
  return "takes an asset file, and there is no file '" + text + "'; for example --asset config/assets/xt03-mv2.yaml";
}

}  // namespace sealwatch::cli
