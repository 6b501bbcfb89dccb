#include "sealwatch/core/text.hpp"

#include <algorithm>
#include <cctype>
#include <cstdint>

#include "services/common/text/format.hpp"

namespace sealwatch {
namespace {

char lower(char letter) { return static_cast<char>(std::tolower(static_cast<unsigned char>(letter))); }

}  // namespace

std::size_t edit_distance(std::string_view a, std::string_view b) {
  const std::size_t width = b.size() + 1;
  std::vector<std::size_t> table((a.size() + 1) * width);
  const auto at = [&](std::size_t i, std::size_t j) -> std::size_t& { return table[i * width + j]; };
  for (std::size_t i = 0; i <= a.size(); ++i) at(i, 0) = i;
  for (std::size_t j = 0; j <= b.size(); ++j) at(0, j) = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t change = lower(a[i - 1]) == lower(b[j - 1]) ? 0 : 1;
      at(i, j) = std::min({at(i - 1, j) + 1, at(i, j - 1) + 1, at(i - 1, j - 1) + change});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        at(i, j) = std::min(at(i, j), at(i - 2, j - 2) + 1);
    }
  }
  return at(a.size(), b.size());
}

constexpr std::size_t kFewestLetters = 3;

std::string nearest(std::string_view word, std::span<const std::string> candidates) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(word.size() / 2, 1);
  for (const std::string& candidate : candidates) {
    const bool cut_short = word.size() >= kFewestLetters && candidate.starts_with(word);  // 'asset' for 'asset_id'
    const std::size_t distance = cut_short ? 1 : edit_distance(word, candidate);
    if (distance <= best_distance && (best.empty() || distance < best_distance)) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

std::string suggest(std::string_view word, std::span<const std::string> candidates) {
  if (const std::string best = nearest(word, candidates); !best.empty()) return "did you mean '" + best + "'?";
  std::string known = "known are: ";
  for (const std::string& candidate : candidates) {
    if (&candidate != candidates.data()) known += ", ";
    known += candidate;
  }
  return known;
}

void ContentHasher::add(std::string_view bytes) {
  for (const char byte : bytes) {
    hash_ ^= static_cast<unsigned char>(byte);
    hash_ *= 1099511628211ULL;  // FNV prime
  }
}

std::string ContentHasher::hex() const { return text::format("{:016x}", hash_); }

std::string content_hash(std::string_view bytes) {
  ContentHasher hasher;
  hasher.add(bytes);
  return hasher.hex();
}

int line_of_second_document(std::string_view text) {
  bool content = false;
  for (int line = 1; !text.empty(); ++line) {
    const std::string_view row = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(row.size() + 1, text.size()));
    const bool mark = row.starts_with("---") && (row.size() == 3 || row[3] == ' ' || row[3] == '\r');
    if (mark && content) return line;
    const std::size_t first = row.find_first_not_of(" \t\r");
    content = content || (first != std::string_view::npos && row[first] != '#');
  }
  return 0;
}

}  // namespace sealwatch
