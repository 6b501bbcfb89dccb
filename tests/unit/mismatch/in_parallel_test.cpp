#include "services/common/mismatch/in_parallel.hpp"

#include <gtest/gtest.h>

#include <new>

namespace sealwatch::mismatch {
namespace {

TEST(InParallel, ResultsComeInTheOrderOfTheParts) {
  const auto squares = in_parallel<std::size_t>(100, 3, [](std::size_t k) { return k * k; });
  for (std::size_t k = 0; k < squares.size(); ++k) EXPECT_EQ(squares[k], k * k);
}

TEST(InParallel, MemoryThatEndsInOnePartIsTheCallersToTell) {
  const auto part = [](std::size_t k) { return k == 7 ? throw std::bad_alloc() : k; };
  EXPECT_THROW(static_cast<void>(in_parallel<std::size_t>(100, 3, part)), std::bad_alloc);
}

}  // namespace
}  // namespace sealwatch::mismatch
