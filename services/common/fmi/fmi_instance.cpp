#include "services/common/fmi/fmi_instance.hpp"

namespace sealwatch::fmi {

Group::Group(std::vector<Handle> variables) : handles(std::move(variables)), size(elements(handles)) {
  for (const Handle& handle : handles) {
    references.push_back(handle.reference);
    all_float64 = all_float64 && handle.type == FmiType::float64;
  }
}

Library::Library(const std::string& file) : handle_(dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL)) {
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
  if (status == kOkStatus) return;  // a chatty binary's news would push out its complaints
  text_ += (text_.empty() ? "" : "; ") + (category.empty() ? "" : category + ": ") + message;
  if (text_.size() > kMost) text_.erase(0, text_.size() - kMost);
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
