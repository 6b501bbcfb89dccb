#include "services/common/recording/mat_container.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
#include <string_view>

#include "sealwatch/core/file.hpp"
#include "sealwatch/core/text.hpp"
#include "services/common/recording/columns.hpp"
#include "services/common/recording/recording_file.hpp"

namespace sealwatch {
namespace {

constexpr long kHeader_bytes = 128;
constexpr std::uint64_t kMostInflated_bytes = 1'000'000'000;  // of a file; zeros inflate a thousandfold
constexpr std::size_t kMostVariables = 10'000;
constexpr std::uint32_t kMostDimension_bytes = 128;  // 32 dimensions, as NumPy's most
constexpr std::uint32_t kMostName_bytes = 2048;      // MATLAB's longest name since 2025; 63 before

// Types of elements, and the classes of arrays from double to 64-bit unsigned.
enum Type : std::uint32_t { kInt8 = 1, kInt32 = 5, kUint32 = 6, kMatrix = 14, kCompressed = 15 };
constexpr std::uint32_t kCellClass = 1;  // then structs, objects, texts, sparse matrices; from 16 functions and handles
constexpr std::uint32_t kDoubleClass = 6;
constexpr std::uint32_t kUint64Class = 15;
constexpr std::uint32_t kOpaqueClass = 17;
constexpr std::uint32_t kComplex = 0x800;  // flag of an array

/// Bytes of one number by its type (int8, uint8, int16, uint16, int32, uint32, single, -, double, -, -, int64,
/// uint64); 0: no numbers.
constexpr std::array<std::uint64_t, 14> kNumber_bytes = {0, 1, 1, 2, 2, 4, 4, 4, 0, 8, 0, 0, 8, 8};

Status damaged() { return fail("the file is cut off or damaged"); }

/// The bytes of one element, as they stand in the file or inflated from it.
class ElementBytes {
 public:
  ElementBytes(std::FILE* file, std::uint32_t length, bool compressed)
      : file_(file), left_(length), compressed_(compressed) {
    if (compressed_ && inflateInit(&stream_) != Z_OK) left_ = 0;
  }
  ~ElementBytes() {
    if (compressed_) inflateEnd(&stream_);
  }
  ElementBytes(const ElementBytes&) = delete;
  ElementBytes& operator=(const ElementBytes&) = delete;

  /// Exactly `count` more bytes; false when the element ends before.
  bool read(unsigned char* to, std::size_t count) {
    if (compressed_) return inflate_to(to, count) == count;
    if (count > left_ || std::fread(to, 1, count, file_) != count) return false;
    left_ -= static_cast<std::uint32_t>(count);
    return true;
  }

  [[nodiscard]] std::uint64_t inflated() const { return compressed_ ? stream_.total_out : 0; }

  /// Everything that is left: inflated, it must end in its checksum before it is longer than `most`.
  bool ends_well(std::uint64_t most) {
    std::array<unsigned char, 32768> rest;
    while (compressed_ && !ended_ && inflated() <= most)
      if (inflate_to(rest.data(), rest.size()) == 0) break;
    return !compressed_ || ended_;
  }

 private:
  std::size_t inflate_to(unsigned char* to, std::size_t count) {
    stream_.next_out = to;
    stream_.avail_out = static_cast<uInt>(count);
    while (stream_.avail_out > 0 && !ended_) {
      if (stream_.avail_in == 0 && !fill()) break;
      const int result = inflate(&stream_, Z_NO_FLUSH);
      if (result == Z_STREAM_END)
        ended_ = true;
      else if (result != Z_OK)
        break;
    }
    return count - stream_.avail_out;
  }

  bool fill() {
    const std::size_t read = std::fread(input_.data(), 1, std::min<std::size_t>(left_, input_.size()), file_);
    left_ -= static_cast<std::uint32_t>(read);
    stream_.next_in = input_.data();
    stream_.avail_in = static_cast<uInt>(read);
    return read > 0;
  }

  std::FILE* file_;
  std::uint32_t left_;  // bytes of the element not yet read from the file
  bool compressed_;
  bool ended_ = false;
  z_stream stream_{};
  std::array<unsigned char, 32768> input_;
};

struct Tag {
  std::uint32_t type;
  std::uint32_t bytes;
};

/// An array: its own tag, then flags, dimensions, name and numbers, each a tag and its bytes up to a multiple of eight.
class ArrayElement {
 public:
  ArrayElement(ElementBytes& bytes, std::uint32_t length, bool swapped)
      : bytes_(bytes), left_(length), swapped_(swapped) {}

  /// Whether it holds other arrays or texts, whose inside is not looked at.
  [[nodiscard]] bool is_nested() const { return nested_; }
  [[nodiscard]] const std::string& name() const { return name_; }

  /// Nothing when a length leaves the element, or the order of its parts is another.
  [[nodiscard]] Status check() {
    const std::optional<std::string> flags = part(kUint32, 8);
    if (!flags || flags->size() != 8) return damaged();
    const std::uint32_t array = number(flags->data()), kind = array & 0xFFU;
    nested_ = (kind >= kCellClass && kind < kDoubleClass) || (kind > kUint64Class && kind <= kOpaqueClass);
    if (kind == kOpaqueClass) return {};  // has no dimensions
    const std::optional<std::string> dimensions = part(kInt32, kMostDimension_bytes);
    if (!dimensions || dimensions->size() < 8 || dimensions->size() % 4 != 0) return damaged();
    const std::optional<std::string> name = part(kInt8, kMostName_bytes);
    if (!name) return damaged();
    name_ = *name;
    if (nested_) return {};
    if (kind < kDoubleClass || kind > kUint64Class)
      return fail(
          error_at("row 1, column " + printable(*name), {}, "must be one vector of real numbers", kTakeOutOrStore));
    const std::optional<Tag> numbers = tag();
    if (!numbers || numbers->bytes > left_ || numbers->type >= kNumber_bytes.size()) return damaged();
    // Of complex numbers this is the real part.
    if ((array & kComplex) == 0 && numbers->bytes != kNumber_bytes[numbers->type] * count_of(*dimensions))
      return damaged();
    return {};
  }

 private:
  [[nodiscard]] std::uint32_t number(const char* at) const {
    std::uint32_t value = 0;
    std::memcpy(&value, at, sizeof value);
    return swapped_ ? __builtin_bswap32(value) : value;
  }

  /// How many numbers arrays of these dimensions have; one that no element holds where they are absurd.
  [[nodiscard]] std::uint64_t count_of(const std::string& dimensions) const {
    std::uint64_t count = 1;
    for (std::size_t at = 0; at < dimensions.size(); at += 4)
      count = std::min<std::uint64_t>(count * number(dimensions.data() + at), 1ULL << 32U);
    return count;
  }

  [[nodiscard]] std::optional<std::string> take(std::uint32_t count) {
    std::string out(count, '\0');
    if (count > left_ || !bytes_.read(reinterpret_cast<unsigned char*>(out.data()), count)) return {};
    left_ -= count;
    return out;
  }

  /// A tag of eight bytes; of a small part, whose bytes stand in the tag itself, only the first four are taken.
  [[nodiscard]] std::optional<Tag> tag() {
    const std::optional<std::string> first = take(4);
    if (!first) return {};
    const std::uint32_t word = number(first->data());
    small_ = word >> 16U != 0;
    if (small_) return Tag{word & 0xFFFFU, word >> 16U};
    const std::optional<std::string> second = take(4);
    if (!second) return {};
    return Tag{word, number(second->data())};
  }

  [[nodiscard]] std::optional<std::string> part(std::uint32_t type, std::uint32_t most) {
    const std::optional<Tag> found = tag();
    if (!found || found->type != type || found->bytes > (small_ ? 4U : most)) return {};
    std::optional<std::string> bytes = take(small_ ? 4U : (found->bytes + 7U) / 8U * 8U);
    if (bytes) bytes->resize(found->bytes);
    return bytes;
  }

  ElementBytes& bytes_;
  std::uint32_t left_;
  bool swapped_;
  bool small_ = false;
  bool nested_ = false;
  std::string name_;
};

std::uint32_t in_order(std::uint32_t value, bool swapped) { return swapped ? __builtin_bswap32(value) : value; }

/// What is known of the elements of a file so far.
struct Chain {
  std::uint64_t left = kMostInflated_bytes;  ///< to which all that follow may inflate
  bool allows_nested = false;
  bool is_nested = false;
};

/// One element of the file, at its first byte behind the tag.
Status check_element(std::FILE* file, Tag tag, bool swapped, Chain& chain) {
  if (tag.type != kMatrix && tag.type != kCompressed) return {};  // matio passes over it
  ElementBytes bytes(file, tag.bytes, tag.type == kCompressed);
  std::array<std::uint32_t, 2> inner = {kMatrix, tag.bytes};
  if (tag.type == kCompressed) {
    if (!bytes.read(reinterpret_cast<unsigned char*>(inner.data()), sizeof inner) ||
        in_order(inner[0], swapped) != kMatrix)
      return damaged();
    inner[1] = in_order(inner[1], swapped);
  }
  ArrayElement array(bytes, inner[1], swapped);
  if (Status checked = array.check(); !checked) return checked;
  if (array.is_nested() && !chain.allows_nested)
    return fail(error_at("row 1, column " + printable(array.name()), {}, "must be one vector of real numbers",
                         kTakeOutOrStore));
  chain.is_nested = chain.is_nested || array.is_nested();
  const bool ends_well = bytes.ends_well(chain.left);
  if (bytes.inflated() > chain.left)
    return fail("the file unpacks to more than " + std::to_string(kMostInflated_bytes / 1'000'000) + " MB",
                "one recording is one test: save its vectors alone");
  chain.left -= bytes.inflated();
  return ends_well ? Status{} : damaged();
}

Status cut_at(long size) {
  return fail(error_at("byte " + std::to_string(size), {}, "the file is cut off or damaged"));
}

/// The chain of elements behind a version 5 file's header, each 8 bytes of tag and as many bytes as the tag says: one
/// that leaves the file was cut off, which matio would take for the end.
Status check_chain(std::FILE* file, bool swapped, Chain& chain) {
  std::fseek(file, 0, SEEK_END);
  const long size = std::ftell(file);
  std::size_t variables = 0;
  for (long at = kHeader_bytes; at < size;) {
    if (++variables > kMostVariables)
      return fail("the file holds more than " + std::to_string(kMostVariables) + " variables",
                  "one recording is one test: save its vectors alone");
    std::array<std::uint32_t, 2> raw{};
    std::fseek(file, at, SEEK_SET);
    if (std::fread(raw.data(), sizeof raw, 1, file) != 1) return cut_at(size);
    const Tag tag = {in_order(raw[0], swapped), in_order(raw[1], swapped)};
    at += 8 + static_cast<long>(tag.bytes);
    if (at > size) return cut_at(size);
    if (Status element = check_element(file, tag, swapped, chain); !element) return element;
  }
  return {};
}

/// Version 4 has no header: its first variable's type, rows, columns, complex or not, and length of the name with its
/// zero. Decimal digits of the type: machine, 0, precision, kind of matrix.
bool is_version_4(std::string_view start) {
  std::array<std::uint32_t, 5> numbers{};
  if (start.size() <= sizeof numbers) return false;
  std::memcpy(numbers.data(), start.data(), sizeof numbers);
  for (const bool swapped : {false, true}) {
    const auto number = [&](std::size_t k) { return in_order(numbers[k], swapped); };
    const std::uint32_t type = number(0), name_bytes = number(4);
    const bool digits = type / 1000 <= 4 && type / 100 % 10 == 0 && type / 10 % 10 <= 5 && type % 10 <= 2;
    if (!digits || number(3) > 1 || name_bytes < 2 || name_bytes > kMostName_bytes) continue;
    const std::string_view name = start.substr(sizeof numbers, name_bytes);
    if (name.size() == name_bytes && name.find('\0') + 1 == name_bytes) return true;
  }
  return false;
}

}  // namespace

Result<MatFormat> check_mat_container(const std::string& path, bool nested) {
  if (const Status is_file = check_file(path, kLargestRecording_bytes); !is_file) return fail(is_file.error());
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file) return fail("cannot be opened");
  std::array<char, 520> start{};
  const std::string_view header(start.data(), std::fread(start.data(), 1, start.size(), file.get()));
  if (header.size() >= kHeader_bytes) {
    // A header ends in the version and "IM", or "MI" with bytes swapped. With a wrong one matio reads lengths of the
    // old version 4 where there are none. Version 7.3 is an HDF5 file behind a header of 512 bytes.
    const std::string_view mark = header.substr(kHeader_bytes - 4, 4);
    const bool swapped = mark == std::string_view("\1\0MI", 4);
    if (swapped || mark == std::string_view("\0\1IM", 4)) {
      Chain chain{.allows_nested = nested};
      if (const Status checked = check_chain(file.get(), swapped, chain); !checked) return fail(checked.error());
      return chain.is_nested ? MatFormat::version_5_nested : MatFormat::version_5;
    }
    if (mark == std::string_view("\0\2IM", 4) && header.size() == start.size() &&
        header.substr(512) == "\x89HDF\r\n\x1a\n")
      return MatFormat::version_7_3;
  }
  if (is_version_4(header))
    return fail("is a MATLAB file of version 4, which is not read", "save it again: save('NAME.mat', '-v7')");
  return fail("is not a MATLAB file of version 5 or 7.3, or it is damaged");
}

}  // namespace sealwatch
