// What stands in an archive may be anything: each fault is refused by name, and nothing is written beside the
// temporary folder, which goes.
#include <gmock/gmock.h>
#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): setenv
#include <sys/stat.h>

#include <fstream>

#include "services/common/fmi/fmu_file.hpp"
#include "tests/unit/fmi/fmu_builder.hpp"

namespace sealwatch::fmi {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class FmuArchive : public testing::Test {
 protected:
  FmuArchive() {
    std::filesystem::create_directory(folder_ / "tmp");
    setenv("TMPDIR", (folder_ / "tmp").c_str(), 1);
  }
  ~FmuArchive() override {
    EXPECT_TRUE(std::filesystem::is_empty(folder_ / "tmp")) << "a temporary folder is left";
    unsetenv("TMPDIR");
  }
  std::string refused(const std::vector<TestMember>& members, const ArchiveLimits& limits = {}) {
    write_archive(folder_ / "a.fmu", members);
    const Result<UnpackedFmu> unpacked = unpack_fmu((folder_ / "a.fmu").string(), limits);
    if (unpacked) return "unpacked";
    EXPECT_EQ(unpacked.error().file, (folder_ / "a.fmu").string());
    EXPECT_FALSE(unpacked.error().advice.empty());
    return unpacked.error().describe();
  }
  TestFolder folder_;
  const TestMember description_{"modelDescription.xml", "<x/>"};
};

TEST_F(FmuArchive, UnpacksWhatASimulationNeedsAndKeepsItsNames) {
  write_archive(folder_ / "a.fmu",
                {description_, {"resources\\deep\\table.txt", "1 2"}, {"sources/model.c", "int x;"}});
  std::filesystem::path inside;
  {
    const Result<UnpackedFmu> unpacked = unpack_fmu((folder_ / "a.fmu").string());
    ASSERT_TRUE(unpacked) << unpacked.error().describe();
    inside = unpacked->folder.path();
    EXPECT_TRUE(std::filesystem::exists(inside / "resources/deep/table.txt"));
    EXPECT_FALSE(std::filesystem::exists(inside / "sources"));
    EXPECT_TRUE(unpacked->has("sources/model.c"));
    EXPECT_EQ(std::filesystem::status(inside).permissions(), std::filesystem::perms::owner_all);
  }
  EXPECT_FALSE(std::filesystem::exists(inside));
}

TEST_F(FmuArchive, NamesMayBeginWithTheFolderThatTheyAreIn) {
  write_archive(folder_ / "a.fmu", {{"./modelDescription.xml", "<x/>"}, {"./resources/table.txt", "1 2"}});
  const Result<UnpackedFmu> unpacked = unpack_fmu((folder_ / "a.fmu").string());
  ASSERT_TRUE(unpacked) << unpacked.error().describe();
  EXPECT_TRUE(unpacked->has("resources/table.txt"));
  EXPECT_THAT(refused({description_, {"./../evil", "x"}}), HasSubstr("leads out"));
  EXPECT_THAT(refused({description_, {"./modelDescription.xml", "x"}}), HasSubstr("twice"));
}

TEST_F(FmuArchive, AFolderMayBeNamedAgain) {
  write_archive(folder_ / "a.fmu", {description_, {"resources/", ""}, {"./resources/", ""}, {"resources/a", "1"}});
  const Result<UnpackedFmu> unpacked = unpack_fmu((folder_ / "a.fmu").string());
  ASSERT_TRUE(unpacked) << unpacked.error().describe();
  EXPECT_TRUE(unpacked->has("resources/a"));
}

TEST_F(FmuArchive, NamesThatLeadOutAreRefused) {
  for (const char* name : {"../evil", "resources/../../evil", "/etc/evil", "resources/..", "C:/evil", "..\\evil"})
    EXPECT_THAT(refused({description_, {name, "x"}}), HasSubstr("path")) << name;
  EXPECT_THAT(refused({description_, {"resources/a\nb", "x"}}), HasSubstr("control characters"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "evil"));
}

TEST_F(FmuArchive, LinksAndSpecialFilesAreRefused) {
  EXPECT_THAT(refused({description_, {"resources/link", "/etc/passwd", S_IFLNK | 0777U}}), HasSubstr("symbolic link"));
  EXPECT_THAT(refused({description_, {"resources/pipe", "", S_IFIFO | 0666U}}), HasSubstr("special file"));
}

TEST_F(FmuArchive, LimitsAreKeptWhateverAMemberSays) {
  const std::string large(3U << 20U, '\0');  // packs to some kilobytes
  ArchiveLimits limits;
  limits.member_bytes = 2U << 20U;
  EXPECT_THAT(refused({description_, {"resources/bomb", large}}, limits), HasSubstr("more than 2 MiB"));
  limits.member_bytes = 4U << 20U;
  limits.total_bytes = 4U << 20U;
  EXPECT_THAT(refused({description_, {"resources/one", large}, {"resources/two", large}}, limits),
              HasSubstr("member resources/two"));
  limits.members = 1;
  EXPECT_THAT(refused({description_, {"resources/one", "x"}}, limits), HasSubstr("more than 1 members"));
}

TEST_F(FmuArchive, WhatIsNoArchiveIsRefused) {
  EXPECT_THAT(refused({{"readme.txt", "x"}}), HasSubstr("no modelDescription.xml"));
  const std::string file = (folder_ / "b.fmu").string();
  std::ofstream(file) << "this is no archive";
  EXPECT_THAT(unpack_fmu(file).error().describe(), HasSubstr("ZIP archive"));
  EXPECT_THAT(unpack_fmu((folder_ / "absent.fmu").string()).error().describe(), HasSubstr("cannot be opened"));
  EXPECT_THAT(unpack_fmu(folder_.path().string()).error().describe(), HasSubstr("is a directory"));
}

TEST_F(FmuArchive, AFlippedOrCutByteNeverPassesSilently) {
  write_archive(folder_ / "a.fmu", {{"modelDescription.xml", description_of(spring_return("fmu_spring_return2"))}});
  std::string bytes(std::filesystem::file_size(folder_ / "a.fmu"), '\0');
  std::ifstream(folder_ / "a.fmu", std::ios::binary).read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  std::string damaged = bytes;
  damaged[bytes.size() / 2] = static_cast<char>(damaged[bytes.size() / 2] ^ 0x55);  // in the packed text
  std::ofstream(folder_ / "b.fmu", std::ios::binary) << damaged;
  EXPECT_THAT(unpack_fmu((folder_ / "b.fmu").string()).error().describe(), HasSubstr("damaged"));
  std::ofstream(folder_ / "c.fmu", std::ios::binary) << bytes.substr(0, bytes.size() - 30);
  EXPECT_FALSE(unpack_fmu((folder_ / "c.fmu").string()));
}

TEST_F(FmuArchive, TheResourcesHaveAUniformResourceIdentifier) {
  const std::filesystem::path odd = folder_ / "a b%\xc3\xa4#";
  std::filesystem::create_directory(odd);
  const char* before = getenv("TMPDIR");
  const std::string kept = before == nullptr ? "" : before;
  setenv("TMPDIR", odd.c_str(), 1);
  const auto fmu = FmuFile::open(folder_.build(spring_return("fmu_spring_return2")));
  before == nullptr ? unsetenv("TMPDIR") : setenv("TMPDIR", kept.c_str(), 1);
  ASSERT_TRUE(fmu) << fmu.error().describe();
  Selection nothing;
  const auto setup = (*fmu)->setup(nothing);
  ASSERT_TRUE(setup) << setup.error().describe();
  EXPECT_THAT(setup->resources, AllOf(testing::StartsWith("file:///"), HasSubstr("/a%20b%25%C3%A4%23/"),
                                      testing::EndsWith("/resources")));
}

TEST_F(FmuArchive, AnotherPlatformIsNamed) {
  const std::string xml = description_of(spring_return("fmu_spring_return2"));
  const auto open = [&](const std::vector<TestMember>& members) {
    write_archive(folder_ / "a.fmu", members);
    const auto fmu = FmuFile::open((folder_ / "a.fmu").string());
    return fmu ? std::string("opened") : fmu.error().describe();
  };
  EXPECT_THAT(open({{"modelDescription.xml", xml}, {"binaries/win64/model.dll", "MZ"}, {"binaries/darwin64/x", "y"}}),
              HasSubstr("it has some for darwin64, win64"));
  EXPECT_THAT(open({{"modelDescription.xml", xml}}),
              AllOf(HasSubstr("it has none for any platform"), Not(HasSubstr("sources"))));
  EXPECT_THAT(open({{"modelDescription.xml", xml}, {"sources/model.c", "int x;"}}),
              HasSubstr("compile those in sources/"));
  EXPECT_THAT(open({{"modelDescription.xml", xml}, {"binaries/linux64/model.so", "MZ and so on"}}),
              HasSubstr("for Windows"));
  std::string arm(64, '\0');
  arm.replace(0, 5,
              "\x7f"
              "ELF\x02");
  arm[18] = static_cast<char>(183);
  EXPECT_THAT(open({{"modelDescription.xml", xml}, {"binaries/linux64/model.so", arm}}),
              HasSubstr("another processor (ELF machine 183)"));
  EXPECT_THAT(open({{"modelDescription.xml", xml}, {"binaries/linux64/model.so", "hello"}}),
              HasSubstr("is not a binary for Linux"));
  EXPECT_THAT(open({{"modelDescription.xml", xml}, {"binaries/linux64/Model-1.so", "x"}}),
              HasSubstr("has no binary binaries/linux64/model.so, after its modelIdentifier, but "
                        "binaries/linux64/Model-1.so"));
}

}  // namespace
}  // namespace sealwatch::fmi
