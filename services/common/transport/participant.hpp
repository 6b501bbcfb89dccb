// A participant and the domain it lives in.
#pragma once

#include <string>

#include "dds/dds.h"
#include "sealwatch/config/configuration.hpp"
#include "sealwatch/core/result.hpp"

namespace sealwatch::transport {

/// Error of a DDS call: what was tried, and DDS's own word for what went wrong.
[[nodiscard]] tl::unexpected<Error> dds_failure(std::string what, dds_return_t code, std::string advice = {});

/// Whether the settings of Cyclone that count for this process have DDS Security in them.
[[nodiscard]] bool is_secured(const Configuration& configuration);

/// A domain's participant; its end deletes all that was made in it, then the domain when it was the process's last
/// there.
class Participant {
 public:
  [[nodiscard]] static Result<Participant> join(const Configuration& configuration);
  Participant(Participant&& other) noexcept;
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;
  Participant& operator=(Participant&&) = delete;
  ~Participant();
  [[nodiscard]] dds_entity_t handle() const { return handle_; }

 private:
  Participant(dds_entity_t handle, dds_domainid_t domain) : handle_(handle), domain_(domain) {}
  dds_entity_t handle_;
  dds_domainid_t domain_;
};

}  // namespace sealwatch::transport
