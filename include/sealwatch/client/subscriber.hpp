// For other people's programs: sealwatch's messages as they come, without anything of DDS to know.
//
//   sealwatch::client::Subscriber subscriber({.domain = 0});
//   subscriber.on<sealwatch::Advisory>([](const sealwatch::Advisory& advisory) { ... });
//   const sealwatch::Status ended = subscriber.run();
//
// A new subscriber gets the last message of every asset first. For each asset and writer, messages come in the order in
// which they were concluded; repetitions (services send again what somebody missed) are left out. A handler that does
// not keep up loses the oldest messages; it never holds up the services.
#pragma once

#include <atomic>
#include <chrono>
#include <concepts>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "sealwatch/core/result.hpp"
#include "sealwatch/message/topics.hpp"

namespace sealwatch {
class DdsBus;
}

namespace sealwatch::client {

struct Options {
  std::int32_t domain = 0;
  /// Settings of Cyclone DDS (XML or file://...) where the environment has no CYCLONEDDS_URI; "": this machine only.
  std::string cyclonedds_uri = {};
  std::string name = "subscriber";  ///< who this is, in what it sends
};

/// One thread uses it; only stop() may be called from others and from a signal handler.
class Subscriber {
 public:
  explicit Subscriber(Options options = {});
  ~Subscriber();
  Subscriber(const Subscriber&) = delete;
  Subscriber& operator=(const Subscriber&) = delete;

  /// From the next run on, calls `handler` for every message of this type: Advisory, RemainingLife, HealthReport, ...
  template <class Content, std::invocable<const Content&> Handler>
  requires std::constructible_from<Message, Content>
  void on(Handler handler) {
    handlers_[topic_of(Message(Content{}))].push_back(
        [handler = std::move(handler)](const Message& message) { handler(std::get<Content>(message)); });
  }

  /// Calls handlers until stop(); an Error when the domain cannot be joined.
  [[nodiscard]] Status run() { return run_for(std::chrono::hours(24 * 365 * 100)); }
  /// The same, for at most `duration`.
  [[nodiscard]] Status run_for(std::chrono::milliseconds duration);
  /// Makes run return, or the next run when none is under way.
  void stop();

  /// Tells advisory_generation that `who` has seen an advisory; an Error when it cannot be reached.
  [[nodiscard]] Status acknowledge(const Advisory& advisory, const std::string& who, const std::string& remark = {});

 private:
  [[nodiscard]] Status connect();
  void deliver(const Message& message);

  Options options_;
  std::unique_ptr<DdsBus> bus_;
  std::atomic<DdsBus*> waiting_ = nullptr;  ///< what stop() has to wake
  std::atomic<bool> stopped_ = false;
  std::map<Topic, std::vector<std::function<void(const Message&)>>> handlers_;
  std::map<std::tuple<Topic, std::string, std::string>, std::uint64_t> delivered_;  ///< by topic, writer and asset
};

}  // namespace sealwatch::client
