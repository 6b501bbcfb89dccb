// Reads a MATLAB 7.3 file in a child process. Such a file is an HDF5 file, and HDF5 trusts what it finds in one: a
// damaged byte can make it follow a wild pointer, ask for all memory, leak, or loop. There it ends the child; here it
// is an error about the file.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sealwatch/core/result.hpp"

namespace sealwatch {

struct MatVariable {
  std::string name;
  std::vector<double> values;
  std::string unit = {};     ///< an attribute of HDF5; MATLAB has none
  std::string scaling = {};  ///< "gain 0.01": an attribute that says they are scaled, and was not followed
  std::string rule = {};     ///< which it breaks, so that it has no values here
  std::string advice = {};
};

/// What `read` returns, called in a child process of 4 GiB more memory than this one has and two minutes of processor
/// time; an Error where the child ended otherwise. `read` must start no thread.
[[nodiscard]] Result<std::vector<MatVariable>> in_child(const std::function<Result<std::vector<MatVariable>>()>& read);

}  // namespace sealwatch
