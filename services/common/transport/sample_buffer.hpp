// C samples that DDS writes into take after take. Their strings and sequences keep their memory, so that taking costs
// next to no allocation; and Cyclone's loans, whose array it overruns when a batch is smaller than one before (0.10),
// are not needed.
#pragma once

#include <cstddef>
#include <vector>

#include "dds/dds.h"

namespace sealwatch::transport {

class SampleBuffer {
 public:
  SampleBuffer(const dds_topic_descriptor_t& descriptor, std::size_t count) : descriptor_(&descriptor) {
    for (std::size_t k = 0; k < count; ++k) samples_.push_back(dds_alloc(descriptor.m_size));  // zeroed
  }
  ~SampleBuffer() {
    for (void* const sample : samples_) dds_sample_free(sample, descriptor_, DDS_FREE_ALL);
  }
  SampleBuffer(const SampleBuffer&) = delete;
  SampleBuffer& operator=(const SampleBuffer&) = delete;

  [[nodiscard]] void** data() { return samples_.data(); }
  [[nodiscard]] std::size_t size() const { return samples_.size(); }
  [[nodiscard]] const void* operator[](std::size_t index) const { return samples_[index]; }

 private:
  const dds_topic_descriptor_t* descriptor_;
  std::vector<void*> samples_;
};

}  // namespace sealwatch::transport
