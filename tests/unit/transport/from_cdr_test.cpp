// Bytes from the network that say of themselves what is not so: never read beyond, never a message of something else.
#include "services/common/transport/from_cdr.hpp"

#include <gtest/gtest.h>

#include "sealwatch/message/service.hpp"

namespace sealwatch::transport {
namespace {

/// Bytes as XCDR2 has them.
class Bytes {
 public:
  Bytes& number(std::uint32_t value) {
    while (bytes_.size() % 4 != 0) bytes_.push_back({});
    for (int k = 0; k < 4; ++k) bytes_.push_back(static_cast<std::byte>(value >> 8 * k));
    return *this;
  }
  Bytes& text(std::string_view letters) {
    number(static_cast<std::uint32_t>(letters.size() + 1));
    for (const char letter : letters) bytes_.push_back(static_cast<std::byte>(letter));
    bytes_.push_back({});
    return *this;
  }
  /// With its size before it.
  [[nodiscard]] std::vector<std::byte> sized(std::int64_t lie = 0) const {
    Bytes all;
    all.number(static_cast<std::uint32_t>(static_cast<std::int64_t>(bytes_.size()) + lie));
    all.bytes_.insert(all.bytes_.end(), bytes_.begin(), bytes_.end());
    return all.bytes_;
  }

 private:
  std::vector<std::byte> bytes_;
};

/// writer_id, topic, sequence numbers 7 and 9.
Bytes request() { return Bytes().text("w").text("advisory").number(7).number(0).number(9).number(0); }

/// A copy of just this size, so that a sanitizer sees what is read beyond.
bool read(const std::vector<std::byte>& bytes, ResendRequest& message) {
  const std::vector<std::byte> alone(bytes);
  return FromCdr(alone).read(message);
}

TEST(FromCdr, OfAnOlderWriterNewFieldsAreEmptyAndOfANewerOneTheyArePassedOver) {
  ResendRequest message;
  ASSERT_TRUE(read(request().sized(), message));
  EXPECT_EQ(message, (ResendRequest{"w", "advisory", 7, 9, ""}));
  ASSERT_TRUE(read(request().text("me").text("of tomorrow").number(3).sized(), message));
  EXPECT_EQ(message, (ResendRequest{"w", "advisory", 7, 9, "me"}));
}

TEST(FromCdr, WhatIsCutOffOrLiesAboutItsSizeIsNoMessage) {
  ResendRequest message;
  const std::vector<std::byte> whole = request().text("me").sized();
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_FALSE(read({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)}, message)) << size;
  EXPECT_FALSE(read(request().sized(1), message)) << "more than there is";
  EXPECT_FALSE(read(request().sized(-1), message)) << "ends within a field";
  EXPECT_FALSE(read(Bytes().number(0xFFFF'FFFF).number(7).sized(), message)) << "a string of four gigabytes";
}

TEST(FromCdr, AStructInsideEndsWhereItSays) {
  const auto status = [](std::uint32_t size_of_position, std::uint32_t positions) {
    Bytes bytes;
    for (int k = 0; k < 3; ++k) bytes.text("x");  // service, writer_id, version
    for (int k = 0; k < 7; ++k) bytes.number(0);  // two times, process, pending_inputs
    bytes.number(32).number(positions);           // written: its size, how many
    bytes.number(size_of_position).text("abc").text("def").number(5).number(0);
    return bytes.sized();
  };
  ServiceStatus message;
  const std::vector<std::byte> good = status(24, 1);
  ASSERT_TRUE(FromCdr(good).read(message));
  ASSERT_EQ(message.written.size(), 1U);
  EXPECT_EQ(message.written[0], (StreamPosition{"abc", "def", 5}));
  for (const auto& bad : {status(23, 1), status(25, 1), status(0x7FFF'FFFF, 1), status(24, 2), status(24, 0x7FFF'FFFF)})
    EXPECT_FALSE(FromCdr(bad).read(message));
}

TEST(FromCdr, NothingIsNoMessage) {
  FromCdr reader{std::span<const std::byte>()};
  ServiceAlarm alarm;
  EXPECT_FALSE(reader.read(alarm));
}

}  // namespace
}  // namespace sealwatch::transport
