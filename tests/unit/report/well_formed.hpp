// Whether a page is well formed as XML: tags close in the order in which they were opened, attributes are quoted and
// not given twice, no bare & or <. The pages are written so that they are both HTML and XML.
#pragma once

#include <cctype>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace sealwatch::report {

/// "" when well formed, else what is wrong and where. <!DOCTYPE> is passed over; the content of style and script is
/// not looked at.
inline std::string what_is_wrong(std::string_view page) {
  std::vector<std::string> open;
  const auto wrong = [&page](std::string text, std::size_t at) {
    return text.append(" at: ").append(page.substr(at, 80));
  };
  for (std::size_t at = 0; at < page.size(); ++at) {
    if (page[at] == '&') {
      const std::size_t end = page.find(';', at);
      const std::string_view name = page.substr(at, end == std::string_view::npos ? end : end - at + 1);
      static const std::set<std::string_view> kKnown = {"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"};
      if (!kKnown.contains(name)) return wrong("a bare &", at);
    }
    if (page[at] == '>') return wrong("a bare >", at);
    if (page[at] != '<') continue;
    if (page.substr(at).starts_with("<!DOCTYPE")) {
      at = page.find('>', at);
      continue;
    }
    const bool closing = at + 1 < page.size() && page[at + 1] == '/';
    std::size_t k = at + (closing ? 2 : 1);
    std::string name;
    while (k < page.size() && (std::isalnum(static_cast<unsigned char>(page[k])) != 0)) name += page[k++];
    if (name.empty()) return wrong("a bare <", at);
    if (closing) {
      if (open.empty() || open.back() != name) return wrong("closes what is not open", at);
      if (page[k] != '>') return wrong("a closing tag with more in it", at);
      open.pop_back();
      at = k;
      continue;
    }
    std::set<std::string> attributes;
    while (k < page.size() && page[k] != '>' && page[k] != '/') {
      if (page[k] == ' ' || page[k] == '\n') {
        ++k;
        continue;
      }
      std::string attribute;
      while (k < page.size() && page[k] != '=' && page[k] != '>' && page[k] != ' ') attribute += page[k++];
      if (page.substr(k, 2) != "=\"") return wrong("an attribute without quoted value", at);
      if (!attributes.insert(attribute).second) return wrong("an attribute given twice", at);
      const std::size_t end = page.find('"', k + 2);
      if (end == std::string_view::npos) return wrong("an open quote", at);
      if (page.substr(k + 2, end - k - 2).find('<') != std::string_view::npos) return wrong("< in an attribute", at);
      k = end + 1;
    }
    const bool empty = k < page.size() && page[k] == '/';
    if (empty) ++k;
    if (k >= page.size() || page[k] != '>') return wrong("an open tag", at);
    at = k;
    if (empty) continue;
    open.push_back(name);
    if (name == "style" || name == "script") at = page.find(std::string("</").append(name), at) - 1;
  }
  return open.empty() ? std::string() : std::string("never closed: ").append(open.back());
}

}  // namespace sealwatch::report
