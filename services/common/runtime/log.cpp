#include "services/common/runtime/log.hpp"

#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/rotating_file_sink.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "sealwatch/core/visible_text.hpp"

namespace sealwatch {
namespace {

std::atomic<bool> is_silent = false;

std::shared_ptr<spdlog::logger>& logger() {
  static std::shared_ptr<spdlog::logger> instance;
  return instance;
}

spdlog::level::level_enum spdlog_level(LogLevel level) {
  switch (level) {
    case LogLevel::trace:
      return spdlog::level::trace;
    case LogLevel::debug:
      return spdlog::level::debug;
    case LogLevel::info:
      return spdlog::level::info;
    case LogLevel::warn:
      return spdlog::level::warn;
    case LogLevel::error:
      break;
  }
  return spdlog::level::err;
}

/// A line tells enough of a text that fills a screen: what a stranger sends drives no older lines out of the files.
std::string shortened(const std::string& value) {
  constexpr std::size_t kMost = 4000;
  if (value.size() <= kMost) return value;
  return value.substr(0, kMost) + "... (" + std::to_string(value.size()) + " bytes)";
}

/// The value as it stands, or in quotes where a reader could not tell where it ends.
std::string quoted(const std::string& given) {
  std::string value = visible(given);
  if (!value.empty() && value.find_first_of(" \"\n\t=") == std::string::npos) return value;
  std::string text = "\"";
  for (const char letter : value) {
    if (letter == '"' || letter == '\\') text += '\\';
    text += letter == '\n' ? ' ' : letter;
  }
  return text + "\"";
}

/// In its file system; zero of none.
ino_t number_of(const std::filesystem::path& file) {
  struct stat found {};
  return ::stat(file.c_str(), &found) == 0 ? found.st_ino : 0;
}

/// What others rename or remove, to keep logs elsewhere or few, is left to them: the next line begins a new file. Who
/// went on with the old one would write what nobody finds.
class LogFile final : public spdlog::sinks::sink {
 public:
  LogFile(const LoggingConfig& config, const std::string& service)
      : config_(config), file_(std::filesystem::path(config.directory) / (service + ".log")) {
    open();
  }
  void log(const spdlog::details::log_msg& line) override {
    const std::lock_guard lock(mutex_);
    if (number_of(file_) != number_) open_again();
    sink_->log(line);
    number_ = number_of(file_);  // a full one was renamed
  }
  void flush() override {
    const std::lock_guard lock(mutex_);
    sink_->flush();
  }
  void set_pattern(const std::string& pattern) override {
    set_formatter(std::make_unique<spdlog::pattern_formatter>(pattern));
  }
  void set_formatter(std::unique_ptr<spdlog::formatter> formatter) override {
    const std::lock_guard lock(mutex_);
    formatter_ = std::move(formatter);
    sink_->set_formatter(formatter_->clone());
  }

 private:
  void open() {
    std::filesystem::create_directories(config_.directory);
    std::error_code none;
    if (std::filesystem::is_fifo(file_, none))  // to open it would wait for ever for somebody who reads it
      throw std::runtime_error(file_.filename().string() + " is a pipe");
    const auto most_bytes = static_cast<std::size_t>(config_.rotate_at_MB * 1e6);
    sink_ = std::make_shared<spdlog::sinks::rotating_file_sink_st>(file_.string(), most_bytes,
                                                                   static_cast<std::size_t>(config_.rotated_files));
    if (formatter_) sink_->set_formatter(formatter_->clone());
    number_ = number_of(file_);
  }
  void open_again() {
    try {
      open();
    } catch (const std::exception&) {  // tried again with the next line, which goes where the last one went
    }
  }

  LoggingConfig config_;
  std::filesystem::path file_;
  std::mutex mutex_;
  std::unique_ptr<spdlog::formatter> formatter_;
  std::shared_ptr<spdlog::sinks::sink> sink_;
  ino_t number_ = 0;
};

/// "<4>" before a line: its priority for systemd's journal (sd-daemon(3)), which takes a line without for information.
class JournalPriority final : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&, spdlog::memory_buf_t& line) override {
    constexpr std::string_view kDebug = "<7>", kInformation = "<6>", kWarning = "<4>", kError = "<3>";
    const std::string_view priority = message.level >= spdlog::level::err    ? kError
                                      : message.level == spdlog::level::warn ? kWarning
                                      : message.level == spdlog::level::info ? kInformation
                                                                             : kDebug;
    line.append(priority.data(), priority.data() + priority.size());
  }
  [[nodiscard]] std::unique_ptr<custom_flag_formatter> clone() const override {
    return std::make_unique<JournalPriority>();
  }
};

/// systemd sets JOURNAL_STREAM where standard error goes to its journal.
std::unique_ptr<spdlog::formatter> format(bool for_journal) {
  auto formatter = std::make_unique<spdlog::pattern_formatter>(spdlog::pattern_time_type::utc);
  if (for_journal) formatter->add_flag<JournalPriority>('*');
  formatter->set_pattern(std::string(for_journal ? "%*" : "") + "%Y-%m-%dT%H:%M:%S.%eZ %l %n %v");
  return formatter;
}

}  // namespace

Status start_logging(const LoggingConfig& config, const std::string& service) {
  try {
    std::vector<spdlog::sink_ptr> sinks = {std::make_shared<spdlog::sinks::stderr_sink_mt>()};
    sinks.front()->set_formatter(format(std::getenv("JOURNAL_STREAM") != nullptr));
    if (!config.directory.empty()) {
      sinks.front()->set_level(spdlog::level::warn);
      sinks.push_back(std::make_shared<LogFile>(config, service));
      sinks.back()->set_formatter(format(false));
    }
    logger() = std::make_shared<spdlog::logger>(service, sinks.begin(), sinks.end());
  } catch (const std::exception& exception) {
    return fail(Error{.file = config.directory,
                      .place = "key logging.directory",
                      .value = {},
                      .rule = exception.what(),
                      .advice = "name a directory that this user may write to"});
  }
  logger()->set_level(spdlog_level(value_of<LogLevel>(config.level).value_or(LogLevel::info)));
  logger()->flush_on(spdlog::level::info);
  return {};
}

void stop_logging() { logger().reset(); }

void silence_log() { is_silent = true; }

bool logs(LogLevel level) { return !is_silent && logger() != nullptr && logger()->should_log(spdlog_level(level)); }

void log_event(LogLevel level, std::string_view event, const LogFields& fields) {
  if (!logs(level)) return;
  std::string line(event);
  for (const auto& [key, value] : fields) line.append(" ").append(key).append("=").append(quoted(shortened(value)));
  logger()->log(spdlog_level(level), line);
}

void log_message(LogLevel level, std::string_view event, const Message& message, LogFields fields) {
  if (!logs(level)) return;
  const Header& header = header_of(message);
  const LogFields about = {{"topic", std::string(name_of(topic_of(message)))},
                           {"pst", header.pst_id},
                           {"asset", asset_of(message)},
                           {"message", header.message_id}};
  fields.insert(fields.begin(), about.begin(), about.end());
  log_event(level, event, fields);
}

}  // namespace sealwatch
