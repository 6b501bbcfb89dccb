#include "services/common/recording/csv_rows.hpp"

#include <algorithm>
#include <cstring>

#include "services/common/recording/columns.hpp"
#include "services/common/recording/recording_file.hpp"

namespace sealwatch {
namespace {

constexpr std::size_t kBlock_bytes = std::size_t{1} << 16U;
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

Error cell_error(std::size_t row, std::size_t column, std::string_view text, std::string rule) {
  return error_at("row " + std::to_string(row) + ", column " + std::to_string(column), text, std::move(rule));
}

/// Takes a quoted cell that begins at `begin`, with its doubled quotes made single in place. Returns the byte after
/// its closing quote, or nullptr when there is none.
char* unquote(char* begin, char* end, std::string_view& cell) {
  char* write = begin;
  for (char* read = begin + 1; read != end; ++read) {
    if (*read == '"') {
      if (read + 1 == end || read[1] != '"') {
        cell = std::string_view(begin, static_cast<std::size_t>(write - begin));
        return read + 1;
      }
      ++read;
    }
    *write++ = *read;
  }
  return nullptr;
}

/// Runs of blanks and tabs become one blank, those at the ends none. Returns the new end.
char* single_blanks(char* begin, char* end) {
  char* write = begin;
  for (char* read = begin; read != end; ++read) {
    const bool blank = *read == ' ' || *read == '\t';
    if (blank && (write == begin || write[-1] == ' ')) continue;
    *write++ = blank ? ' ' : *read;
  }
  return write != begin && write[-1] == ' ' ? write - 1 : write;
}

}  // namespace

char line_break_of(std::string_view begin) {
  const bool old = begin.find('\n') == std::string_view::npos && begin.find('\r') != std::string_view::npos;
  return old ? '\r' : '\n';
}

/// Reads one more block behind what no row has taken yet; false at the end of the file.
bool CsvRows::fill() {
  if (begin_ > 0) std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  buffer_.resize(end_ + kBlock_bytes);
  in_.read(buffer_.data() + end_, static_cast<std::streamsize>(kBlock_bytes));
  const auto count = static_cast<std::size_t>(in_.gcount());
  hasher_.add({buffer_.data() + end_, count});
  end_ += count;
  if (row_ == 0) {
    const std::string_view first(buffer_.data(), end_);
    if (first.starts_with(kByteOrderMark)) begin_ = kByteOrderMark.size();
    line_break_ = line_break_of(first);
  }
  return count > 0;
}

/// Position of the line break that ends the row at begin_, or end_ when the file ends first. Line breaks inside quotes
/// do not count: the row has an even number of quotes before its end.
Result<std::size_t> CsvRows::find_row_end(bool quotes_count) {
  has_quotes_ = false;
  bool inside = false;
  std::size_t scanned = 0;  // bytes after begin_ that were looked at
  for (;;) {
    const char* const start = buffer_.data() + begin_ + scanned;
    const std::size_t count = end_ - begin_ - scanned;
    const auto* const feed = count > 0 ? static_cast<const char*>(std::memchr(start, line_break_, count)) : nullptr;
    const std::size_t line = feed != nullptr ? static_cast<std::size_t>(feed - start) : count;
    const auto quotes = quotes_count ? std::count(start, start + line, '"') : 0;
    has_quotes_ = has_quotes_ || quotes > 0;
    inside = inside != (quotes % 2 == 1);
    scanned += line;
    if (feed != nullptr && !inside) return begin_ + scanned;
    if (feed != nullptr) ++scanned;
    if (scanned > kLongestRow_bytes)
      return fail(cell_error(row_, 1, {}, "the row is longer than " + std::to_string(kLongestRow_bytes) + " bytes"));
    if (feed == nullptr && !fill()) return end_;
  }
}

Status CsvRows::split_row(char* begin, char* end, std::vector<std::string_view>& cells) const {
  for (char* at = begin;; ++at) {
    std::string_view cell;
    char* stop = nullptr;
    if (has_quotes_ && at != end && *at == '"') {
      stop = unquote(at, end, cell);
      if (stop == nullptr)
        return fail(cell_error(row_, cells.size() + 1, {at, static_cast<std::size_t>(end - at)},
                               "the quoted cell is cut off: it has no closing quote"));
      if (stop != end && *stop != delimiter_)
        return fail(cell_error(row_, cells.size() + 1, cell, "text follows the closing quote"));
    } else {
      const auto count = static_cast<std::size_t>(end - at);
      auto* const next = count > 0 ? static_cast<char*>(std::memchr(at, delimiter_, count)) : nullptr;
      stop = next != nullptr ? next : end;
      cell = std::string_view(at, static_cast<std::size_t>(stop - at));
      if (has_quotes_ && cell.find('"') != std::string_view::npos)
        return fail(cell_error(row_, cells.size() + 1, cell, "a quote stands inside an unquoted cell"));
    }
    cells.push_back(cell);
    if (stop == end) return {};
    at = stop;
  }
}

Result<bool> CsvRows::next(std::vector<std::string_view>& cells) {
  cells.clear();
  while (begin_ == end_)
    if (!fill()) return false;
  row_ += lines_;
  const Result<std::size_t> row_end = find_row_end(true);
  if (!row_end) return fail(row_end.error());
  char* const begin = buffer_.data() + begin_;
  char* end = buffer_.data() + *row_end;
  has_line_break_ = *row_end != end_;
  lines_ = 1 + (has_quotes_ ? static_cast<std::size_t>(std::count(begin, end, line_break_)) : 0);
  begin_ = *row_end + (has_line_break_ ? 1 : 0);
  while (end != begin && end[-1] == '\r') --end;  // a text file written as text on Windows has two
  if (delimiter_ == ' ') end = single_blanks(begin, end);
  if (const Status split = split_row(begin, end, cells); !split) return fail(split.error());
  return true;
}

Result<bool> CsvRows::skip_line() {
  while (begin_ == end_)
    if (!fill()) return false;
  row_ += lines_;
  const Result<std::size_t> row_end = find_row_end(false);
  if (!row_end) return fail(row_end.error());
  lines_ = 1;
  has_line_break_ = *row_end != end_;
  begin_ = *row_end + (has_line_break_ ? 1 : 0);
  return true;
}

}  // namespace sealwatch
