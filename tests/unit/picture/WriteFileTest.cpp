// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/picture/WriteFile.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <iterator>

#include "TestData.h"

namespace vernier {
namespace {

namespace fs = std::filesystem;

std::string contentOf(const fs::path& p) {
  std::ifstream in(p, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
int filesIn(const fs::path& p) {
  return static_cast<int>(std::distance(fs::directory_iterator(p), fs::directory_iterator()));
}

TEST(WriteFile, WritesAndReplacesWhole) {
  const test::TempDir dir;
  const fs::path file = dir.path() / "report.json";
  ASSERT_TRUE(writeFileWhole(file.string(), "one").ok());
  EXPECT_EQ(contentOf(file), "one");
  ASSERT_TRUE(writeFileWhole(file.string(), "").ok());
  EXPECT_EQ(contentOf(file), "");
  EXPECT_EQ(filesIn(dir.path()), 1) << "no temporary file stays";
  struct stat s {};
  ASSERT_EQ(::stat(file.c_str(), &s), 0);
  const mode_t mask = ::umask(0);
  ::umask(mask);
  EXPECT_EQ(s.st_mode & 0777, 0666 & ~mask) << "as any new file";
}

TEST(WriteFile, FollowsLinks) {
  const test::TempDir dir;
  std::ofstream(dir.path() / "real") << "old";
  fs::create_symlink(dir.path() / "real", dir.path() / "link");
  ASSERT_TRUE(writeFileWhole((dir.path() / "link").string(), "new").ok());
  EXPECT_EQ(contentOf(dir.path() / "real"), "new");
  EXPECT_TRUE(fs::is_symlink(dir.path() / "link"));
}

TEST(WriteFile, RefusesWhatIsNoFileAndLeavesNothing) {
  const test::TempDir dir;
  fs::create_directory(dir.path() / "folder");
  for (const std::string& path : {(dir.path() / "folder").string(), (dir.path() / "none" / "a").string(),
                                  std::string(), std::string("/dev/null")}) {
    const auto r = writeFileWhole(path, "x");
    ASSERT_FALSE(r.ok()) << path;
    EXPECT_EQ(r.error().code, ErrorCode::WriteFailed);
    EXPECT_EQ(r.error().where, path);
  }
  EXPECT_EQ(filesIn(dir.path()), 1);
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

}  // namespace
}  // namespace vernier
