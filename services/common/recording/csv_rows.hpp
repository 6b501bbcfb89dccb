// Rows of an RFC 4180 file, read in blocks: memory does not grow with the file.
//
//   row  = cell *("," cell) line-break         line-break = [CR] LF, may be missing after the last row; CR where no LF is
//   cell = plain text | '"' *(text | '""') '"'
// A UTF-8 byte order mark before the first row is skipped. Other delimiters than the comma serve foreign logs; blanks as
// delimiters stand in runs of any length, tabs among them.
#pragma once

#include <cstddef>
#include <istream>
#include <string>
#include <string_view>
#include <vector>

#include "sealwatch/core/result.hpp"
#include "sealwatch/core/text.hpp"

namespace sealwatch {

/// What ends the rows of a file that begins like this: LF, or the CR of old instruments, which write no LF.
[[nodiscard]] char line_break_of(std::string_view begin);

class CsvRows {
 public:
  explicit CsvRows(std::istream& in, char delimiter = ',') : in_(in), delimiter_(delimiter) {}

  /// Takes the next row; false at the end of the file. `cells` stay valid until the next call.
  [[nodiscard]] Result<bool> next(std::vector<std::string_view>& cells);

  /// Passes over a line of any text, quotes or not; false at the end of the file.
  [[nodiscard]] Result<bool> skip_line();

  [[nodiscard]] std::size_t row() const { return row_; }                    ///< of the last row taken, 1 for the first
  [[nodiscard]] bool has_line_break() const { return has_line_break_; }     ///< of the last row taken
  [[nodiscard]] std::string content_hash() const { return hasher_.hex(); }  ///< of all bytes read so far

 private:
  [[nodiscard]] bool fill();
  [[nodiscard]] Result<std::size_t> find_row_end(bool quotes_count);
  [[nodiscard]] Status split_row(char* begin, char* end, std::vector<std::string_view>& cells) const;

  std::istream& in_;
  char delimiter_;
  char line_break_ = '\n';
  std::vector<char> buffer_;
  std::size_t begin_ = 0;  ///< first byte in buffer_ that no row has taken
  std::size_t end_ = 0;    ///< past the last byte in buffer_
  std::size_t row_ = 0;
  std::size_t lines_ = 1;  ///< of the row before the next one: its quoted cells may have line breaks
  bool has_line_break_ = false;
  bool has_quotes_ = false;  ///< of the row being taken
  ContentHasher hasher_;
};

}  // namespace sealwatch
