#include "services/cli/columns.hpp"

#include <algorithm>
#include <cstdio>

#include "services/cli/terminal.hpp"

namespace sealwatch::cli {
namespace {

constexpr std::size_t kNarrowest = 24;  // of the last column, which otherwise begins on a line of its own

std::vector<std::size_t> widths_of(const std::vector<TableRow>& rows) {
  std::vector<std::size_t> width;
  for (const TableRow& row : rows) {
    width.resize(std::max(width.size(), row.size()), 0);
    for (std::size_t k = 0; k + 1 < row.size(); ++k) width[k] = std::max(width[k], letters(row[k]));
  }
  return width;
}

}  // namespace

void print_wrapped(const std::string& text, std::size_t indent) {
  std::printf("%s%s\n", std::string(indent, ' ').c_str(), wrapped(text, kPageWidth, indent).c_str());
}

void print_columns(const std::vector<TableRow>& rows, std::size_t indent) {
  const std::vector<std::size_t> width = widths_of(rows);
  for (const TableRow& row : rows) {
    std::string line(indent, ' ');
    for (std::size_t k = 0; k + 1 < row.size(); ++k) line += padded(row[k], width[k]) + "  ";
    std::size_t column = letters(line);
    const bool below = column + kNarrowest > kPageWidth && column + letters(row.back()) > kPageWidth;
    if (below || row.back().empty()) line.erase(line.find_last_not_of(' ') + 1);
    if (below) {
      column = indent + 4;
      line.append("\n").append(column, ' ');
    }
    std::printf("%s%s\n", line.c_str(), wrapped(row.back(), kPageWidth, column).c_str());
  }
}

void print_table(const std::string& heading, const std::vector<TableRow>& rows) {
  if (rows.empty()) return;
  std::printf("\n%s\n", heading.c_str());
  print_columns(rows, 2);
}

}  // namespace sealwatch::cli
