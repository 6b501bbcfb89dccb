// For other people's programs that send tests: the contract of a sender (docs/topics.md) kept for them.
//
//   sealwatch::client::Sender sender({.domain = 0});
//   sender.add(block);                                    // a RawSamples with a message_id of its own
//   while (sender.unconfirmed() > 0) sender.run_for(std::chrono::milliseconds(100));
//
// A message counts as delivered when data_acquisition has it in its journal, not when it was sent: until then it is kept
// here, sent again when it is asked for or nobody answers, and never more than a window is on its way. Where
// data_acquisition asks for what it had confirmed (its journal was lost, or restored from a backup), what is kept goes
// on as a stream of a new name, as the old one would wait for ever for what is forgotten here. Who may be killed keeps what is unconfirmed on a disk and adds it again: a message that comes twice is taken once, by its message_id.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sealwatch/core/result.hpp"
#include "sealwatch/message/service.hpp"
#include "sealwatch/message/topics.hpp"

namespace sealwatch {
class DdsBus;
}

namespace sealwatch::client {

/// One thread uses it.
class Sender {
 public:
  struct Options {
    std::int32_t domain = 0;
    /// Settings of Cyclone DDS where the environment has no CYCLONEDDS_URI; "": this machine only.
    std::string cyclonedds_uri = {};
    std::string name = "sender";  ///< who this is; each object is a writer of its own
  };

  explicit Sender(Options options);
  ~Sender();
  Sender(const Sender&) = delete;
  Sender& operator=(const Sender&) = delete;

  /// Takes a block of samples to send; an Error when it has no message_id, by which it would be known again.
  [[nodiscard]] Status add(RawSamples block);
  /// Sends, repeats, and hears what has arrived; an Error when the domain cannot be joined.
  [[nodiscard]] Status run_for(std::chrono::milliseconds duration);
  [[nodiscard]] std::size_t unconfirmed() const { return waiting_.size(); }
  /// Message ids that data_acquisition has journaled since the last call: forget them.
  [[nodiscard]] std::vector<std::string> take_confirmed() { return std::exchange(confirmed_, {}); }

 private:
  using Clock = std::chrono::steady_clock;
  [[nodiscard]] Status connect();
  void send_next();
  void send_again(std::uint64_t first, std::uint64_t last);
  void repeat_unanswered();
  void answer(const ResendRequest& request);
  void start_anew();
  void take(const ServiceStatus& status);

  Options options_;
  std::string writer_id_;
  std::unique_ptr<DdsBus> bus_;
  std::deque<RawSamples> waiting_;                 ///< not yet confirmed, by number without a gap
  std::uint64_t added_ = 0;                        ///< number of the last one added
  std::uint64_t sent_ = 0;                         ///< number of the last one sent
  Clock::time_point moved_ = Clock::now();         ///< last confirmed or repeated
  Clock::time_point confirmed_at_ = Clock::now();  ///< or nothing waited
  std::vector<std::string> confirmed_;
};

}  // namespace sealwatch::client
