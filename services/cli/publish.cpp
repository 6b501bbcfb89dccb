#include "services/cli/publish.hpp"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

#include "sealwatch/client/sender.hpp"
#include "sealwatch/core/json_depth.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/session.hpp"
#include "services/common/message/json.hpp"

namespace sealwatch::cli {
namespace {

/// Blocks that may wait to be confirmed before more lines are read: whoever writes them waits then.
constexpr std::size_t kMostUnconfirmed = 512;
constexpr std::size_t kLongestLine = 16U << 20U;

/// Standard input line by line, without waiting for the next.
class Lines {
 public:
  [[nodiscard]] bool ended() const { return ended_; }
  [[nodiscard]] std::size_t number() const { return number_; }
  [[nodiscard]] bool too_long() const { return text_.size() > kLongestLine; }
  std::optional<std::string> next() {
    for (std::size_t end = text_.find('\n'); end == std::string::npos; end = text_.find('\n')) {
      pollfd input{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
      if (too_long()) ended_ = true;
      // A last line without its end is no line: its writer was killed, and writes it again.
      if (ended_ || ::poll(&input, 1, 0) <= 0) return std::nullopt;
      std::array<char, 65536> piece;
      const ssize_t count = ::read(STDIN_FILENO, piece.data(), piece.size());
      ended_ = count <= 0;
      if (count > 0) text_.append(piece.data(), static_cast<std::size_t>(count));
    }
    const std::size_t end = text_.find('\n');
    std::string line = text_.substr(0, end);
    text_.erase(0, end + 1);
    ++number_;
    return line;
  }

 private:
  std::string text_;
  bool ended_ = false;
  std::size_t number_ = 0;
};

/// A value that some writers put out of quotes, though JSON has no such number; "" none.
std::string no_number_in(const std::string& line) {
  bool quoted = false;
  for (std::size_t k = 0; k < line.size(); ++k) {
    if (line[k] == '"' && (k == 0 || line[k - 1] != '\\')) quoted = !quoted;
    for (const char* const word : {"NaN", "-Infinity", "Infinity"})
      if (!quoted && line.compare(k, std::string_view(word).size(), word) == 0) return word;
  }
  return {};
}

Result<RawSamples> block_of(const std::string& line) {
  if (is_nested_too_deeply(line))
    return fail(Error{.file = {},
                      .place = {},
                      .value = line.substr(0, 60),
                      .rule = kNestedTooDeeply,
                      .advice = "write a block as `sealwatch watch raw_samples --json` prints it"});
  const auto whole = nlohmann::json::parse(line, nullptr, false);
  if (const std::string word = whole.is_discarded() ? no_number_in(line) : std::string(); !word.empty())
    return fail(Error{.file = {},
                      .place = {},
                      .value = word,
                      .rule = "is not a number in JSON",
                      .advice = R"(write "nan", "inf" or "-inf", in quotes)"});
  if (!whole.is_object() || !whole.contains("topic") || !whole.contains("message"))
    return fail(Error{.file = {},
                      .place = {},
                      .value = line.substr(0, 60),
                      .rule = R"(must be {"topic": ..., "message": {...}})",
                      .advice = "as `sealwatch watch --json` prints it"});
  if (whole["topic"] != "raw_samples")
    return fail(Error{.file = {},
                      .place = "topic",
                      .value = whole["topic"].dump(),
                      .rule = "must be raw_samples",
                      .advice = "operators' acts have commands of their own"});
  Result<Message> message = message_from_json(Topic::raw_samples, whole["message"].dump());
  if (!message) return fail(message.error());
  return std::get<RawSamples>(std::move(*message));
}

/// One line for each block that data acquisition has journaled.
void tell_confirmed(client::Sender& sender) {
  for (const std::string& id : sender.take_confirmed())
    std::printf(
        "%s\n",
        nlohmann::json{{"confirmed", id}}.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
  std::fflush(stdout);
}

}  // namespace

int run_publish(const PublishOptions& options) {
  const std::optional<Configuration> configuration = load_or_explain(options.config);
  if (!configuration) return kBadInput;
  client::Sender sender(
      {.domain = configuration->domain, .cyclonedds_uri = configuration->cyclonedds_uri, .name = "publish"});
  catch_interrupts();
  Lines lines;
  bool refused = false;
  while (!interrupted() && (!lines.ended() || sender.unconfirmed() > 0)) {
    while (sender.unconfirmed() < kMostUnconfirmed) {
      const std::optional<std::string> line = lines.next();
      if (!line) break;
      Result<RawSamples> block = block_of(*line);
      const Status added = block ? sender.add(std::move(*block)) : fail(block.error());
      if (added) continue;
      Error error = added.error();
      error.file = "line " + std::to_string(lines.number());
      complain(error);
      refused = true;
    }
    if (const Status ran = sender.run_for(std::chrono::milliseconds(20)); !ran) {
      complain(ran.error());
      return kInternalFailure;
    }
    tell_confirmed(sender);
  }
  if (lines.too_long())
    complain(Error{.file = "line " + std::to_string(lines.number() + 1),
                   .place = {},
                   .value = {},
                   .rule = "is longer than 16 MB",
                   .advice = "send blocks of about a second, one a line"});
  if (refused || lines.too_long()) return kBadInput;
  return sender.unconfirmed() > 0 ? kAnswerIsNo : kOk;
}

}  // namespace sealwatch::cli
