// Functions that do the same to many numbers are compiled twice: for vectors of two doubles, which every x86-64 has,
// and of four, where the processor has them. Products and sums are the same ones in the same order: so is the result.
#pragma once

#include <cstddef>

// Not with sanitizers, which the choice at start-up comes before.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define SEALWATCH_WIDE_VECTORS [[gnu::target_clones("avx2", "default")]]
#else
#define SEALWATCH_WIDE_VECTORS
#endif

namespace sealwatch {

/// Four doubles, in several vectors where the processor has shorter ones. Not to be handed from function to function,
/// which is done differently with and without wide vectors.
using WideVector [[gnu::vector_size(32)]] = double;
inline constexpr std::size_t kWidth = 4;

}  // namespace sealwatch
