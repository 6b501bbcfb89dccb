// Tables on the terminal: aligned columns, at most kPageWidth characters a line.
#pragma once

#include <string>
#include <vector>

namespace sealwatch::cli {

inline constexpr std::size_t kPageWidth = 100;

using TableRow = std::vector<std::string>;

/// An empty line, the heading, then the rows in columns behind two blanks. The last column is wrapped where a line would
/// exceed kPageWidth. Nothing where there are no rows.
void print_table(const std::string& heading, const std::vector<TableRow>& rows);

/// The same without heading, behind `indent` blanks.
void print_columns(const std::vector<TableRow>& rows, std::size_t indent);

/// Text behind `indent` blanks, wrapped at kPageWidth.
void print_wrapped(const std::string& text, std::size_t indent);

}  // namespace sealwatch::cli
