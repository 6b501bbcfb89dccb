// Rows of a journal's outputs and inputs as they are read.
#pragma once

#include <soci/soci.h>

#include <string>
#include <vector>

#include "sealwatch/message/topics.hpp"

namespace sealwatch {

struct MessageRow {
  long long order = 0;  ///< ordinal or receipt
  std::string topic;
  std::string payload;
  long long sequence = 0;
  long long published = 0;
  std::string message_id;
  std::string asset_id;
  std::string pst_id;
  std::string checksum;
};

/// What a query for rows_of begins with.
inline constexpr const char* kOutput =
    "SELECT ordinal, topic, payload, sequence, published, message_id, asset_id, pst_id, coalesce(checksum, '')"
    " FROM outputs WHERE ";

/// Rows of a query that begins so, or with the like of inputs, with :after bound.
[[nodiscard]] std::vector<MessageRow> rows_of(soci::session& sql, const std::string& query, long long after);

/// Whether it is of a topic that carries samples, and does.
[[nodiscard]] bool has_samples(const Message& message);

/// As it is once its samples are dropped: its producer says so (is_expired).
[[nodiscard]] Message without_samples(Message message);

/// Whether an output is as it was written, as far as its checksum tells.
[[nodiscard]] bool is_as_written(const MessageRow& output);

/// The message of a row; throws Error where it cannot be read.
[[nodiscard]] Message message_of(const MessageRow& row, const std::string& journal);

}  // namespace sealwatch
