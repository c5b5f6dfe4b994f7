// SPDX-License-Identifier: GPL-3.0-or-later
// Combiners by their names: where the files are looked for, and which ones ship.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "CombinerForTest.h"

namespace vernier::dvr {
namespace {
namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsSupersetOf;

constexpr const char* kShipped[] = {"four-slices",   "intermediate-slice", "intermediate-slice-weighted",
                                    "iso",           "iso-two-colours",    "iso-two-lights",
                                    "shaded-global", "shaded-own-colour",  "shaded-per-voxel",
                                    "strip",         "two-slices"};

struct Folder {
  Folder() : path(fs::path(VERNIER_BUILD_DIR) / "tests" / ("combiners-" + name())) {
    fs::remove_all(path);
    fs::create_directories(path);
  }
  ~Folder() { fs::remove_all(path); }
  static std::string name() { return testing::UnitTest::GetInstance()->current_test_info()->name(); }
  void write(const std::string& file, const std::string& text) const { std::ofstream(path / file) << text; }
  fs::path path;
};

TEST(CombinerFiles, AllShippedOnesAreRightAndSayWhereTheyComeFrom) {
  const std::vector<std::string> names = combinerNames(test::shippedFolder());
  EXPECT_EQ(names, std::vector<std::string>(std::begin(kShipped), std::end(kShipped)));
  for (const std::string& name : names) {
    const Combiner c = test::shipped(name);
    EXPECT_EQ(c.name, name);
    EXPECT_FALSE(c.title.empty()) << name;
    EXPECT_FALSE(c.source.empty()) << name;
    EXPECT_EQ(c.test == FragmentTest::Level, name.starts_with("iso")) << name;
    EXPECT_EQ(c.blend == Blending::Transmission, name.ends_with("slices")) << name;
  }
}

TEST(CombinerFiles, TheBuildHasThemWhereTheProgramLooks) {
  const std::vector<std::string> folders = combinerFolders();
  ASSERT_GE(folders.size(), 1u);
  EXPECT_TRUE(fs::equivalent(folders[0], fs::path(VERNIER_BUILD_DIR) / "lib/vernier/plugins/dvr/combiners"));
  EXPECT_THAT(combinerNames(), IsSupersetOf(kShipped));
  EXPECT_TRUE(findCombiner("iso").ok());
}

TEST(CombinerFiles, AnUnknownNameIsToldTheKnownOnes) {
  for (const char* name : {"isos", "", "../iso", "iso.json", "iso\n", "/etc/passwd"}) {
    const auto c = findCombiner(name, test::shippedFolder());
    ASSERT_FALSE(c.ok()) << name;
    EXPECT_EQ(c.error().code, ErrorCode::SceneInvalid);
    EXPECT_THAT(c.error().sentence, HasSubstr("; there are four-slices, intermediate-slice, "));
  }
  const auto none = findCombiner("iso", {"/nonexistent"});
  ASSERT_FALSE(none.ok());
  EXPECT_THAT(none.error().sentence, HasSubstr("reinstall the plugin dvr"));
}

TEST(CombinerFiles, UsersMayAddTheirOwnButNotReplaceShippedOnes) {
  const Folder user;
  std::vector<std::string> folders = test::shippedFolder();
  folders.push_back(user.path.string());
  user.write("mine.json", R"({"schema": 1, "title": "Mine", "base": "iso", "test": "none"})");
  user.write("iso.json", "{}");
  user.write("notes.txt", "");
  user.write("bad name.json", "{}");
  const auto mine = findCombiner("mine", folders);
  ASSERT_TRUE(mine.ok()) << mine.error().text();
  EXPECT_EQ(mine->title, "Mine");
  EXPECT_EQ(mine->test, FragmentTest::None);
  EXPECT_EQ(mine->stages, test::shipped("iso").stages);
  EXPECT_TRUE(findCombiner("iso", folders).ok());
  EXPECT_EQ(combinerNames(folders).size(), std::size(kShipped) + 1);
}

TEST(CombinerFiles, TheUsersFolderIsAmongTheirSettings) {
  const Folder config;
  const fs::path folder = config.path / "vernier" / "combiners";
  fs::create_directories(folder);
  std::ofstream(folder / "mine.json") << R"({"schema": 1, "title": "Mine", "base": "strip"})";
  const char* before = std::getenv("XDG_CONFIG_HOME");
  const std::string kept = before ? before : "";
  setenv("XDG_CONFIG_HOME", config.path.c_str(), 1);
  EXPECT_EQ(combinerFolders().back(), folder.string());
  const auto mine = findCombiner("mine");
  before ? setenv("XDG_CONFIG_HOME", kept.c_str(), 1) : unsetenv("XDG_CONFIG_HOME");
  ASSERT_TRUE(mine.ok()) << mine.error().text();
  EXPECT_EQ(mine->title, "Mine");
}

TEST(CombinerFiles, FilesThatCannotBeUsed) {
  const Folder user;
  user.write("large.json", std::string(70000, ' '));
  user.write("round.json", R"({"schema": 1, "title": "t", "base": "about"})");
  user.write("about.json", R"({"schema": 1, "title": "t", "base": "round"})");
  fs::create_directories(user.path / "folder.json");
  const std::vector<std::string> folders{user.path.string()};
  EXPECT_THAT(findCombiner("large", folders).error().sentence, HasSubstr("more than 65536 bytes"));
  EXPECT_EQ(findCombiner("large", folders).error().where, "large.json#");
  EXPECT_THAT(findCombiner("round", folders).error().sentence,
              HasSubstr("circle: round, based on about, based on round."));
  EXPECT_FALSE(findCombiner("folder", folders).ok());
}

}  // namespace
}  // namespace vernier::dvr
