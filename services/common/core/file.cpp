#include "sealwatch/core/file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>

namespace sealwatch {
namespace {

namespace fs = std::filesystem;

tl::unexpected<Error> refuse(const std::string& path, std::string rule, std::string advice = {}) {
  return fail(Error{.file = path, .place = {}, .value = {}, .rule = std::move(rule), .advice = std::move(advice)});
}

tl::unexpected<Error> too_large(const std::string& path, std::uint64_t most_bytes) {
  constexpr std::uint64_t kMB = 1'000'000;
  return refuse(path, most_bytes < kMB ? "is longer than " + std::to_string(most_bytes) + " bytes"
                                       : "is larger than " + std::to_string(most_bytes / kMB) + " MB");
}

/// "" for a file.
std::string no_file(fs::file_type type) {
  switch (type) {
    case fs::file_type::directory:
      return "is a directory";
    case fs::file_type::fifo:
      return "is a pipe, whose reader may wait for ever";
    case fs::file_type::block:
    case fs::file_type::character:
      return "is a device, whose reader may wait or read for ever";
    case fs::file_type::socket:
      return "is a socket";
    default:
      return "";  // opening what is not there says so
  }
}

Status write_all(int descriptor, const std::string& content) {
  for (std::size_t done = 0; done < content.size();) {
    const ssize_t written = ::write(descriptor, content.data() + done, content.size() - done);
    if (written < 0 && errno != EINTR) return fail(std::string("cannot be written: ") + std::strerror(errno));
    done += written > 0 ? static_cast<std::size_t>(written) : 0;
  }
  return {};
}

}  // namespace

Result<std::ifstream> open_file(const std::string& path, std::uint64_t most_bytes) {
  std::error_code ignored;
  if (const std::string what = no_file(fs::status(path, ignored).type()); !what.empty())
    return refuse(path, what, "give a file");
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in) return refuse(path, std::string("cannot be opened: ") + std::strerror(errno));
  const std::uintmax_t size = fs::file_size(path, ignored);
  if (!ignored && size > most_bytes) return too_large(path, most_bytes);
  return in;
}

Status check_file(const std::string& path, std::uint64_t most_bytes) {
  const Result<std::ifstream> in = open_file(path, most_bytes);
  return in ? Status{} : fail(in.error());
}

Result<std::string> read_file(const std::string& path, std::uint64_t most_bytes) {
  Result<std::ifstream> in = open_file(path, most_bytes);
  if (!in) return fail(in.error());
  constexpr std::size_t kBlock_bytes = std::size_t{1} << 16U;
  std::string content;
  for (std::size_t more = kBlock_bytes; more == kBlock_bytes && content.size() <= most_bytes;) {
    content.resize(content.size() + kBlock_bytes);
    in->read(content.data() + content.size() - kBlock_bytes, static_cast<std::streamsize>(kBlock_bytes));
    more = static_cast<std::size_t>(in->gcount());
    content.resize(content.size() - kBlock_bytes + more);
  }
  if (in->bad()) return refuse(path, "cannot be read");
  if (content.size() > most_bytes) return too_large(path, most_bytes);
  return content;
}

Status write_file(const std::string& path, const std::string& content) {
  // Without waiting for whoever may some day read a pipe; once there is a reader, it is waited for.
  const int opened = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NONBLOCK | O_CLOEXEC, 0666);
  if (opened < 0)
    return refuse(path, errno == ENXIO ? "is a pipe or a socket that nobody reads"
                                       : std::string("cannot be written: ") + std::strerror(errno));
  ::fcntl(opened, F_SETFL, 0);
  const Status written = write_all(opened, content);
  const bool closed = ::close(opened) == 0;
  if (!written) return refuse(path, written.error().rule);
  return closed ? Status{} : refuse(path, std::string("cannot be written: ") + std::strerror(errno));
}

}  // namespace sealwatch
