// The checksum that a row of the journal carries, by which a bit that the disk or the memory turned is noticed.
#pragma once

#include <charconv>
#include <cstdint>
#include <initializer_list>
#include <string>

#include "sealwatch/core/text.hpp"

namespace sealwatch {

/// In place of a checksum: the row was found damaged, and nobody reads it until it is concluded again.
inline constexpr const char* kDamaged = "damaged";

/// Of an output whose samples were dropped: what is left of it is not looked at.
inline constexpr const char* kExpiredRow = "expired";

/// Of the fields, each with its length before it: nothing moves from one to the next unseen.
[[nodiscard]] inline std::string row_checksum(std::initializer_list<std::string> fields) {
  ContentHasher hasher;
  for (const std::string& field : fields) {
    hasher.add(std::to_string(field.size()) + ":");
    hasher.add(field);
  }
  return hasher.hex();
}

/// Not of its number in a stream, under which a writer may send it again.
[[nodiscard]] inline std::string checksum_of_input(long long receipt, const std::string& topic,
                                                   const std::string& message_id, const std::string& asset_id,
                                                   const std::string& pst_id, const std::string& payload) {
  return row_checksum({std::to_string(receipt), topic, message_id, asset_id, pst_id, payload});
}

[[nodiscard]] inline std::string checksum_of_output(long long ordinal, const std::string& topic, long long sequence,
                                                    const std::string& message_id, const std::string& asset_id,
                                                    const std::string& pst_id, const std::string& payload) {
  return row_checksum(
      {std::to_string(ordinal), topic, std::to_string(sequence), message_id, asset_id, pst_id, payload});
}

[[nodiscard]] inline std::string checksum_of_position(const std::string& topic, const std::string& writer_id,
                                                      long long sequence) {
  return row_checksum({topic, writer_id, std::to_string(sequence)});
}

[[nodiscard]] inline std::string checksum_of_meta(const std::string& service, const std::string& writer_id) {
  return row_checksum({service, writer_id});
}

/// Of rows that are only added, in whatever order: each adds its checksum, modulo 2^64. Table meta keeps the sum.
[[nodiscard]] inline std::uint64_t checksum_of_anchor(const std::string& service, long long sequence,
                                                      const std::string& hash) {
  const std::string checksum = row_checksum({service, std::to_string(sequence), hash});
  std::uint64_t number = 0;
  std::from_chars(checksum.data(), checksum.data() + checksum.size(), number, 16);
  return number;
}

}  // namespace sealwatch
