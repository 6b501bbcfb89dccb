// The id of a test, made once: "<asset>-<start time>-<content>", e.g. "XT03-MV2-20310412T030000Z-1a2b3c4d". Without a
// start time the recording's name stands in its place; without either, "undated".
#pragma once

#include <string>

#include "sealwatch/message/data_acquisition.hpp"

namespace sealwatch {

/// `first_block` is the first block of the test that came; its content counts when the sender gives no content_hash.
/// Characters that do not belong into an id become '_'.
[[nodiscard]] std::string make_pst_id(const RawSamples& first_block);

}  // namespace sealwatch
