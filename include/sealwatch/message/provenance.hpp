// The header of what is concluded from one test, or from one event that belongs to no test.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "sealwatch/message/common.hpp"

namespace sealwatch {

/// Id "<topic>/<pst_id>", or "<topic>/<id of the cause>" without a test; test, event time and replay flag of the cause.
[[nodiscard]] inline Header concluded_from(const Header& cause, const std::string& topic, const std::string& producer,
                                           std::vector<std::string> source_ids = {}) {
  Header header;
  header.message_id = topic + "/" + (cause.pst_id.empty() ? cause.message_id : cause.pst_id);
  header.pst_id = cause.pst_id;
  header.source_ids = std::move(source_ids);
  header.producer = producer;
  header.event_time_known = cause.event_time_known;
  header.event_time_ns = cause.event_time_ns;
  header.replay = cause.replay;
  return header;
}

}  // namespace sealwatch
