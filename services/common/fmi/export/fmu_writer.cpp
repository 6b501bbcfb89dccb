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

#include "services/common/fmi/temporary_folder.hpp"

namespace sealwatch::fmi {
namespace {

tl::unexpected<Error> refuse(const std::string& file, std::string rule, std::string advice) {
  return fail(Error{.file = file, .place = {}, .value = {}, .rule = std::move(rule), .advice = std::move(advice)});
}

/// Runs `cc`; returns what went wrong, "" where nothing did.
std::string compiled(const std::filesystem::path& source, const std::filesystem::path& binary) {
  std::array<std::string, 9> words = {"cc", "-O2",           "-fPIC",         "-shared", "-fvisibility=hidden",
                                      "-o", binary.string(), source.string(), "-lm"};
  std::array<char*, 10> arguments{};
  for (std::size_t k = 0; k < words.size(); ++k) arguments[k] = words[k].data();
  pid_t child = -1;
  const int error = posix_spawnp(&child, "cc", nullptr, nullptr, arguments.data(), environ);
  if (error != 0) return std::string("there is no C compiler cc: ") + std::strerror(error);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? "" : "the C compiler cc failed";
}

}  // namespace

Result<WrittenFmu> write_fmu(const std::string& file, const ExportedModel& model) {
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
  if (written.binary)
    add("binaries/linux64/" + model.identifier + ".so", zip_source_file(archive, binary.c_str(), 0, -1));
  if (sound && zip_close(archive) == 0) return written;
  zip_discard(archive);
  return refuse(file, "cannot be written", "look whether the disk is full");
}

}  // namespace sealwatch::fmi
