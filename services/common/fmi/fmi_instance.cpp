#include "services/common/fmi/fmi_instance.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "services/common/text/words.hpp"

namespace sealwatch::fmi {

Group::Group(std::vector<Handle> variables) : handles(std::move(variables)), size(elements(handles)) {
  for (const Handle& handle : handles) {
    references.push_back(handle.reference);
    all_float64 = all_float64 && handle.type == FmiType::float64;
  }
}

namespace {

// What a binary needs may lie beside it, in any order of need. Known by their names, they are found once loaded.
void load_beside(const std::filesystem::path& file) {
  std::vector<std::filesystem::path> waiting;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(file.parent_path(), ignored))
    if (entry.path() != file && entry.path().filename().string().find(".so") != std::string::npos)
      waiting.push_back(entry.path());
  const auto loads = [](const auto& one) { return dlopen(one.c_str(), RTLD_NOW | RTLD_LOCAL) != nullptr; };
  while (std::erase_if(waiting, loads) > 0) {
  }
}

}  // namespace

Library::Library(const std::string& file) : handle_(dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL)) {
  if (handle_ != nullptr) return;
  load_beside(file);
  handle_ = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle_ != nullptr) return;
  const char* reason = dlerror();
  throw Failure{std::string("the binary cannot be loaded: ") + (reason == nullptr ? "" : reason)};
}

void* Library::symbol(const char* name, bool needed) const {
  void* found = dlsym(handle_, name);
  if (found == nullptr && needed) throw Failure{std::string("the binary has no function ") + name};
  return found;
}

void Messages::add(int status, const std::string& category, const std::string& message) {
  constexpr std::size_t kMost = 1000;
  const std::string words = (category.empty() ? "" : category + ": ") + message;
  // A chatty binary's news would push out its complaints; where it has none, they are its last words.
  if (status == kOkStatus) {
    if (text_.empty()) keep(words);
    return;
  }
  text::add_to_list(text_, words, "; ");
  if (text_.size() > kMost) text_.erase(0, text_.size() - kMost);
  keep(text_);
}

void Messages::keep(std::string_view text) const {
  if (room_.empty()) return;
  const std::string_view end = text.substr(text.size() - std::min(text.size(), room_.size() - 1));
  std::ranges::copy(end, room_.begin());
  room_[end.size()] = '\0';
}

std::vector<Constant> constants_of(const Setup& setup) {
  std::vector<Constant> constants;
  std::size_t at = 0;
  for (std::size_t k = 0; k < setup.constants.size(); ++k) {
    const std::size_t end = setup.constant_texts.find('\0', at);
    constants.push_back({setup.constants[k], setup.constant_texts.substr(at, end - at), k < setup.structural});
    at = end + 1;
  }
  return constants;
}

std::vector<double> numbers_of(const Constant& constant) {
  std::vector<double> values;
  std::istringstream parts(constant.text);
  for (std::string part; parts >> part;)
    values.push_back(part == "true" ? 1.0 : part == "false" ? 0.0 : std::strtod(part.c_str(), nullptr));
  return values;
}

Messages& messages() {
  static Messages all;
  return all;
}

void check(int status, const char* function) {
  constexpr std::array kNames = {"OK", "Warning", "Discard", "Error", "Fatal", "Pending"};
  if (status == kOkStatus || status == kWarning) return;
  const bool known = status >= 0 && status < static_cast<int>(kNames.size());
  throw Failure{std::string(function) + " answered " +
                (known ? kNames[static_cast<std::size_t>(status)] : std::to_string(status))};
}

}  // namespace sealwatch::fmi
