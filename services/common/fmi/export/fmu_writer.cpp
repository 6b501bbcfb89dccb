#include "services/common/fmi/export/fmu_writer.hpp"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zip.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>

#include "services/common/fmi/fmu_archive.hpp"
#include "services/common/fmi/temporary_folder.hpp"

namespace sealwatch::fmi {
namespace {

tl::unexpected<Error> refuse(const std::string& file, std::string rule, std::string advice) {
  return fail(Error{.file = file, .place = {}, .value = {}, .rule = std::move(rule), .advice = std::move(advice)});
}

/// Runs `cc`; returns what went wrong, "" where nothing did.
std::string compiled(const std::filesystem::path& source, const std::filesystem::path& binary) {
  std::array<std::string, 10> words = {"cc", "-O2",           "-fPIC",         "-shared", "-fvisibility=hidden",
                                       "-o", binary.string(), source.string(), "-lm",     "-ldl"};
  std::array<char*, 11> arguments{};
  for (std::size_t k = 0; k < words.size(); ++k) arguments[k] = words[k].data();
  pid_t child = -1;
  const int error = posix_spawnp(&child, "cc", nullptr, nullptr, arguments.data(), environ);
  if (error != 0) return std::string("there is no C compiler cc: ") + std::strerror(error);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? "" : "the C compiler cc failed";
}

using Archive = std::unique_ptr<zip_t, decltype([](zip_t* archive) { zip_discard(archive); })>;

/// What the unit that is carried needs to run, member by member into resources/inner.
bool carry(zip_t* from, zip_t* to) {
  const zip_int64_t count = zip_get_num_entries(from, 0);
  for (zip_int64_t index = 0; index < count; ++index) {
    const auto number = static_cast<zip_uint64_t>(index);
    const char* name = zip_get_name(from, number, 0);
    const std::string_view member(name == nullptr ? "" : name);
    const bool needed = member == kDescriptionName || member.starts_with("binaries/") ||
                        member.starts_with("resources/") || member.starts_with("licenses/");
    if (!needed || member.ends_with('/')) continue;
    zip_source_t* content = zip_source_zip(to, from, number, 0, 0, -1);
    const std::string target = "resources/inner/" + std::string(member);
    if (content == nullptr || zip_file_add(to, target.c_str(), content, ZIP_FL_ENC_UTF_8) < 0) return false;
  }
  return zip_dir_add(to, "resources/inner/resources", ZIP_FL_ENC_UTF_8) >= 0;
}

/// FMI 3.0 says beside the sources how they are built.
std::string build_description(const ExportedModel& model) {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiBuildDescription fmiVersion=\"3.0\">\n<BuildConfiguration "
         "modelIdentifier=\"" +
         model.identifier +
         "\">\n<SourceFileSet language=\"C99\"><SourceFile name=\"model.c\"/></SourceFileSet>\n"
         "<Library name=\"m\" external=\"true\"/>\n</BuildConfiguration>\n</fmiBuildDescription>\n";
}

}  // namespace

Result<WrittenFmu> write_fmu(const std::string& file, const ExportedModel& model) {
  const std::filesystem::path into = std::filesystem::path(file).parent_path();
  if (std::error_code unknown; !into.empty() && !std::filesystem::is_directory(into, unknown))
    return refuse(file, "cannot be written: there is no folder " + into.string(), "create it, or name another");
  auto folder = TemporaryFolder::create();
  if (!folder) return fail(folder.error());
  const std::filesystem::path source = folder->path() / "model.c", binary = folder->path() / "model.so";
  std::ofstream(source) << model.source;
  WrittenFmu written{.binary = false, .without_binary = compiled(source, binary)};
  written.binary = written.without_binary.empty();
  int code = 0;
  zip_t* archive = zip_open(file.c_str(), ZIP_CREATE | ZIP_EXCL, &code);
  if (archive == nullptr)
    return refuse(file, code == ZIP_ER_EXISTS ? "is there already" : "cannot be written", "give another name");
  bool sound = true;
  const auto add = [&](const std::string& name, zip_source_t* content) {
    sound = sound && content != nullptr && zip_file_add(archive, name.c_str(), content, ZIP_FL_ENC_UTF_8) >= 0;
  };
  add("modelDescription.xml", zip_source_buffer(archive, model.description.data(), model.description.size(), 0));
  add("sources/model.c", zip_source_buffer(archive, model.source.data(), model.source.size(), 0));
  const bool third = model.version == Version::fmi3;
  const std::string build = third ? build_description(model) : "";
  if (third) add("sources/buildDescription.xml", zip_source_buffer(archive, build.data(), build.size(), 0));
  if (written.binary)
    add((third ? "binaries/x86_64-linux/" : "binaries/linux64/") + model.identifier + ".so",
        zip_source_file(archive, binary.c_str(), 0, -1));
  const Archive carried(model.carried.empty() ? nullptr : zip_open(model.carried.c_str(), ZIP_RDONLY, &code));
  if (!model.carried.empty()) sound = sound && carried && carry(carried.get(), archive);
  if (sound && zip_close(archive) == 0) return written;
  const std::string why = zip_strerror(archive);
  zip_discard(archive);
  return refuse(file, "cannot be written: " + why,
                "look whether the disk is full, and whether the folder may be written to");
}

}  // namespace sealwatch::fmi
