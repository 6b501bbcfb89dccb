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
  std::string unit = {};    ///< an attribute of HDF5; MATLAB has none
  bool is_complex = false;  ///< of MATLAB: then it has no values here
};

/// What `read` returns, called in a child process of 4 GiB more memory than this one has and two minutes of processor
/// time; an Error where the child ended otherwise. `read` must start no thread.
[[nodiscard]] Result<std::vector<MatVariable>> in_child(const std::function<Result<std::vector<MatVariable>>()>& read);

}  // namespace sealwatch
