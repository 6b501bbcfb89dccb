// The statements that run for every message, prepared once.
#pragma once

#include <soci/soci.h>

#include <string>

#include "sealwatch/core/time.hpp"
#include "sealwatch/message/topics.hpp"
#include "services/common/store/journal.hpp"

namespace sealwatch {

class JournalStatements {
 public:
  explicit JournalStatements(soci::session& sql);
  JournalStatements(const JournalStatements&) = delete;
  JournalStatements& operator=(const JournalStatements&) = delete;

  /// None where there is no input of that id.
  [[nodiscard]] std::optional<std::string> asset_of_input(const std::string& message_id);
  [[nodiscard]] std::optional<std::string> asset_of_output(const std::string& message_id);
  [[nodiscard]] std::string last_unnumbered_input(Topic topic, const std::string& asset_id);
  void add_input(long long receipt, const Message& message, const StreamPosition& stream, UtcTime received,
                 InputState state);
  /// Whether an open input of that id was there.
  bool consume(const std::string& message_id);
  /// Whether it was added; false when an output of this message id is there already.
  bool add_output(long long ordinal, const Message& message, std::uint64_t sequence, UtcTime publishing_time);
  void set_position(const StreamPosition& position);

 private:
  void bind_message(const Message& message);

  // What the statements' parameters are bound to.
  long long order_ = 0;
  std::string topic_;
  std::string writer_id_;
  long long sequence_ = 0;
  std::string message_id_;
  std::string asset_id_;
  std::string pst_id_;
  long long time_ = 0;
  int consumed_ = 0;
  std::string payload_;
  std::string checksum_;
  soci::indicator payload_there_ = soci::i_ok;

  soci::statement find_input_;
  soci::statement find_output_;
  soci::statement find_unnumbered_;
  soci::statement insert_input_;
  soci::statement consume_input_;
  soci::statement insert_output_;
  soci::statement upsert_position_;
};

}  // namespace sealwatch
