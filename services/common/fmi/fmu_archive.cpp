#include "services/common/fmi/fmu_archive.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zip.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <set>
#include <sstream>

#include "sealwatch/core/file.hpp"

namespace sealwatch::fmi {
namespace {

using Archive = std::unique_ptr<zip_t, decltype([](zip_t* archive) { zip_discard(archive); })>;
using Member = std::unique_ptr<zip_file_t, decltype([](zip_file_t* member) { zip_fclose(member); })>;
using Descriptor = std::unique_ptr<int, decltype([](const int* descriptor) {
                                     close(*descriptor);
                                     delete descriptor;
                                   })>;

struct Entry {
  zip_uint64_t index = 0;
  std::string name;
};

constexpr std::array kUnpacked = {"resources/", "binaries/linux64/", "binaries/x86_64-linux/"};

tl::unexpected<Error> refuse(const std::string& file, const std::string& member, std::string rule,
                             std::string advice = "export the FMU again with the tool that made it") {
  return fail(Error{.file = file,
                    .place = member.empty() ? std::string() : "member " + member,
                    .value = {},
                    .rule = std::move(rule),
                    .advice = std::move(advice)});
}

/// What is wrong with a name as a path inside the folder; "" where nothing is.
std::string fault_of_name(const std::string& name) {
  if (name.empty()) return "has no name";
  if (name.front() == '/' || (name.size() > 1 && name[1] == ':')) return "has a path from the root";
  if (std::ranges::any_of(name, [](char c) { return static_cast<unsigned char>(c) < 0x20; }))
    return "has control characters in its name";
  std::istringstream parts(name);
  for (std::string part; std::getline(parts, part, '/');) {
    if (part == "..") return "has a path that leads out of the archive";
    if (part.size() > 255) return "has too long a name";
  }
  return name.size() > 4000 ? "has too long a name" : "";
}

/// By the permissions that UNIX tools write beside a member; others write none.
std::string fault_of_kind(zip_t* archive, zip_uint64_t index) {
  zip_uint8_t system = 0;
  zip_uint32_t attributes = 0;
  if (zip_file_get_external_attributes(archive, index, 0, &system, &attributes) != 0) return "is damaged";
  const zip_uint32_t kind = (attributes >> 16U) & S_IFMT;
  if (system != ZIP_OPSYS_UNIX && system != ZIP_OPSYS_OS_X) return "";
  if (kind == S_IFLNK) return "is a symbolic link";
  return kind == 0 || kind == S_IFREG || kind == S_IFDIR ? "" : "is a special file";
}

bool is_unpacked(const std::string& name) {
  return name == kDescriptionName ||
         std::ranges::any_of(kUnpacked, [&](const char* folder) { return name.starts_with(folder); });
}

Result<std::vector<Entry>> checked_entries(zip_t* archive, const std::string& file, const ArchiveLimits& limits) {
  const zip_int64_t count = zip_get_num_entries(archive, 0);
  if (count < 0 || static_cast<std::uint64_t>(count) > limits.members)
    return refuse(file, {}, "has more than " + std::to_string(limits.members) + " members");
  std::vector<Entry> entries;
  std::set<std::string> names;
  for (zip_uint64_t index = 0; index < static_cast<zip_uint64_t>(count); ++index) {
    zip_stat_t about{};
    const char* text = zip_get_name(archive, index, ZIP_FL_ENC_GUESS);
    if (text == nullptr || zip_stat_index(archive, index, 0, &about) != 0)
      return refuse(file, "number " + std::to_string(index + 1), "is damaged");
    std::string name = text;
    std::ranges::replace(name, '\\', '/');  // some Windows tools write those
    if (name == "./") continue;
    if (name.starts_with("./")) name.erase(0, 2);
    std::string fault = fault_of_name(name);
    if (fault.empty()) fault = fault_of_kind(archive, index);
    if (fault.empty() && (about.valid & ZIP_STAT_ENCRYPTION_METHOD) != 0 && about.encryption_method != ZIP_EM_NONE)
      fault = "is encrypted";
    const bool again = !names.insert(name).second, is_folder = name.ends_with('/');
    if (fault.empty() && again && !is_folder) fault = "is there twice";
    if (!fault.empty()) return refuse(file, name, fault);
    if (again) continue;
    entries.push_back({index, std::move(name)});
  }
  return entries;
}

std::string message_of(zip_error_t* error) { return zip_error_strerror(error); }

/// Copies one member into `folder`, at most `limit` bytes of it, whatever size it says it has; returns how many.
Result<std::uint64_t> unpack(zip_t* archive, const std::string& file, const Entry& entry,
                             const std::filesystem::path& folder, std::uint64_t limit) {
  const std::filesystem::path target = folder / entry.name;
  std::error_code error;
  std::filesystem::create_directories(entry.name.back() == '/' ? target : target.parent_path(), error);
  if (error) return refuse(file, entry.name, "cannot be unpacked: " + error.message());
  if (entry.name.back() == '/') return 0;
  const Member member(zip_fopen_index(archive, entry.index, 0));
  if (!member) return refuse(file, entry.name, "cannot be read: " + message_of(zip_get_error(archive)));
  const int opened = open(target.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
  if (opened < 0) return refuse(file, entry.name, std::string("cannot be unpacked: ") + std::strerror(errno));
  const Descriptor output(new int(opened));
  std::array<char, 1U << 16U> block{};
  for (std::uint64_t total = 0;;) {
    const zip_int64_t got = zip_fread(member.get(), block.data(), block.size());
    if (got < 0) return refuse(file, entry.name, "is damaged: " + message_of(zip_file_get_error(member.get())));
    if (got == 0) return total;
    total += static_cast<std::uint64_t>(got);
    if (total > limit)
      return refuse(file, entry.name, "unpacks to more than " + std::to_string(limit >> 20U) + " MiB, the limit");
    if (write(*output, block.data(), static_cast<std::size_t>(got)) != got)
      return refuse(file, entry.name, std::string("cannot be unpacked: ") + std::strerror(errno),
                    "make room in the temporary folder, or set TMPDIR to another one");
  }
}

std::string& unpacked_folder() {
  static std::string folder;
  return folder;
}

UnpackedFmu in_folder(const std::string& file, const std::string& folder) {
  UnpackedFmu fmu{.file = file, .folder = TemporaryFolder::borrow(folder), .members = {}};
  std::error_code problem;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder, problem))
    fmu.members.push_back(std::filesystem::relative(entry.path(), folder, problem).generic_string());
  return fmu;
}

}  // namespace

void use_unpacked(const std::string& folder) { unpacked_folder() = folder; }

bool UnpackedFmu::has(const std::string& member) const { return std::ranges::find(members, member) != members.end(); }

Result<UnpackedFmu> unpack_fmu(const std::string& file, const ArchiveLimits& limits) {
  if (!unpacked_folder().empty()) return in_folder(file, unpacked_folder());
  if (const Status is_file = check_file(file, limits.total_bytes); !is_file)
    return refuse(file, {}, is_file.error().rule, "give the path of an FMU");
  int code = 0;
  const Archive archive(zip_open(file.c_str(), ZIP_RDONLY, &code));
  if (!archive) {
    zip_error_t error;
    zip_error_init_with_code(&error, code);
    const std::string reason = message_of(&error);
    zip_error_fini(&error);
    return refuse(file, {}, "cannot be read as an FMU, which is a ZIP archive: " + reason);
  }
  const Result<std::vector<Entry>> entries = checked_entries(archive.get(), file, limits);
  if (!entries) return fail(entries.error());
  Result<TemporaryFolder> folder = TemporaryFolder::create();
  if (!folder) return fail(folder.error());
  std::uint64_t left = limits.total_bytes;
  UnpackedFmu fmu{.file = file, .folder = std::move(*folder), .members = {}};
  for (const Entry& entry : *entries) {
    fmu.members.push_back(entry.name);
    if (!is_unpacked(entry.name)) continue;
    const std::uint64_t limit =
        std::min(left, entry.name == kDescriptionName ? limits.description_bytes : limits.member_bytes);
    const Result<std::uint64_t> size = unpack(archive.get(), file, entry, fmu.folder.path(), limit);
    if (!size) return fail(size.error());
    left -= *size;
  }
  if (!fmu.has(kDescriptionName))
    return refuse(file, {}, "is not an FMU: the archive has no modelDescription.xml at its top");
  return fmu;
}

}  // namespace sealwatch::fmi
