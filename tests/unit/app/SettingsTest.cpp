// SPDX-License-Identifier: GPL-3.0-or-later
#include "Settings.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <fstream>

#include "TestData.h"

namespace vernier::app {
namespace {

class SettingsTest : public ::testing::Test {
 protected:
  SettingsTest() {
    ::setenv("XDG_CONFIG_HOME", dir_.path().c_str(), 1);
    for (const char* v : {"VERNIER_THREADS", "VERNIER_ENGINE", "VERNIER_MEMORY_MB", "VERNIER_PLUGINS"})
      ::unsetenv(v);
  }
  void config(const std::string& text) {
    std::filesystem::create_directories(dir_.path() / "vernier");
    std::ofstream(dir_.path() / "vernier/config.json") << text;
  }
  test::TempDir dir_;
};

TEST_F(SettingsTest, FlagThenEnvironmentThenFileThenDefault) {
  EXPECT_EQ(readSettings({})->sources[0].source, "default");
  config(R"({"threads": 3, "engine": "native"})");
  EXPECT_EQ(readSettings({})->threads, 3);
  EXPECT_EQ(readSettings({})->engine, "native");
  EXPECT_EQ(readSettings({})->sources[0].source, "config.json");
  ::setenv("VERNIER_THREADS", "5", 1);
  EXPECT_EQ(readSettings({})->threads, 5);
  EXPECT_EQ(readSettings({})->sources[0].source, "VERNIER_THREADS");
  SettingFlags flags;
  flags.threads = 1;
  EXPECT_EQ(readSettings(flags)->threads, 1);
}

TEST_F(SettingsTest, BadValuesAreNamedWithTheirSource) {
  ::setenv("VERNIER_THREADS", "many", 1);
  const auto r = readSettings({});
  ASSERT_FALSE(r.ok());
  EXPECT_EQ(r.error().code, ErrorCode::OptionInvalid);
  EXPECT_EQ(r.error().where, "VERNIER_THREADS");
  ::unsetenv("VERNIER_THREADS");
  config("{");
  EXPECT_EQ(readSettings({}).error().where, "config.json");
  config(R"({"engine": "steam"})");
  EXPECT_FALSE(readSettings({}).ok());
  // A pipe is no settings file, and nobody waits for it.
  const std::filesystem::path file = dir_.path() / "vernier/config.json";
  std::filesystem::remove(file);
  ASSERT_EQ(::mkfifo(file.c_str(), 0600), 0);
  EXPECT_EQ(readSettings({}).error().where, "config.json");
}

TEST_F(SettingsTest, PluginFoldersAreAList) {
  ::setenv("VERNIER_PLUGINS", "one::two", 1);
  EXPECT_EQ(readSettings({})->pluginFolders, (std::vector<std::string>{"one", "two"}));
}

TEST_F(SettingsTest, ToldWhetherSettingsCanBeKept) {
  EXPECT_TRUE(checkSettingsFolder().ok());
  EXPECT_TRUE(std::filesystem::is_empty(dir_.path())) << "looking creates nothing";
  ::setenv("XDG_CONFIG_HOME", "/dev/null/nothing-can-be-made-here", 1);
  const Result<void> readOnly = checkSettingsFolder();
  ASSERT_FALSE(readOnly.ok());
  EXPECT_EQ(readOnly.error().code, ErrorCode::WriteFailed);
  std::ofstream(dir_.path() / "vernier") << "a file where the folder should be";
  ::setenv("XDG_CONFIG_HOME", dir_.path().c_str(), 1);
  EXPECT_FALSE(checkSettingsFolder().ok());
}

}  // namespace
}  // namespace vernier::app
