// SPDX-License-Identifier: GPL-3.0-or-later
#include "PluginHost.h"
#include "TestPaths.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>

#include "TestData.h"
#include "vernier/plan/MakePlan.h"
#include "vernier/plan/Plugin.h"

namespace vernier::app {
namespace {
namespace fs = std::filesystem;

class PluginHostTest : public ::testing::Test {
 protected:
  // A plugin folder with the library `library` of tests/plugins-bad and a card; returns the folder.
  fs::path install(const std::string& name, const std::string& library, const std::string& needs = "",
                   const std::string& interface = kPluginInterface) {
    const fs::path folder = dir_.path() / name;
    fs::create_directory(folder);
    fs::copy_file(fs::path(VERNIER_BUILD_DIR) / "tests/plugins-bad" / (library + ".so"),
                  folder / (library + ".so"));
    fs::permissions(folder / (library + ".so"), fs::perms::owner_all);
    std::ofstream(folder / "plugin.json")
        << R"({"name": ")" << name << R"(", "version": "1", "interface": ")"
        << interface << R"(", "library": ")" << library << R"(.so", "needs": [)" << needs << "]}";
    return folder;
  }
  const PluginInfo& load(const std::string& name) {
    host_.load({dir_.path().string()});
    return info(name);
  }
  const PluginInfo& info(const std::string& name) {
    for (const PluginInfo& p : host_.plugins())
      if (p.name == name) return p;
    ADD_FAILURE() << "plugin " << name << " is not listed";
    static const PluginInfo none;
    return none;
  }
  test::TempDir dir_;
  PluginHost host_{
      []() -> Result<gpu::Device*> { return makeError(ErrorCode::GlUnavailable, "not in this test"); }};
};

TEST_F(PluginHostTest, LoadsAGoodOne) {
  install("good", "good");
  EXPECT_EQ(load("good").state, PluginState::Loaded) << info("good").reason;
  EXPECT_NE(host_.techniques().find("good.technique"), nullptr);
  EXPECT_EQ(info("good").techniques, std::vector<std::string>{"good.technique"});
}

TEST_F(PluginHostTest, RefusesOtherAbiBeforeItsCodeRuns) {
  install("abi", "other_abi");
  EXPECT_EQ(load("abi").state, PluginState::OtherAbi);
  EXPECT_TRUE(host_.techniques().all().empty());
}

TEST_F(PluginHostTest, RefusesOtherInterfaceInLibraryAndInCard) {
  install("interface", "other_interface");
  install("card", "good", "", "vernier.technique/99");
  EXPECT_EQ(load("interface").state, PluginState::OtherInterface);
  EXPECT_EQ(info("card").state, PluginState::OtherInterface);
  EXPECT_NE(info("card").reason.find("vernier.technique/99"), std::string::npos);
}

TEST_F(PluginHostTest, RefusesMissingDependencyAndLoadsInOrder) {
  install("a-needs-good", "failing", "\"nowhere\"");
  install("b-first", "throws_at_work", "\"good\"");
  install("good", "good");
  EXPECT_EQ(load("a-needs-good").state, PluginState::MissingDependency);
  EXPECT_NE(info("a-needs-good").reason.find("nowhere"), std::string::npos);
  EXPECT_EQ(info("b-first").state, PluginState::Loaded);
}

TEST_F(PluginHostTest, RefusesDuplicateNameAndDuplicateTechnique) {
  install("good", "good");
  install("zz-second", "second");
  const fs::path copy = install("twin", "good");
  std::ofstream(copy / "plugin.json")
      << R"({"name":"good","version":"2","interface":")" << kPluginInterface << R"(","library":"good.so"})";
  host_.load({dir_.path().string()});
  int loaded = 0, duplicates = 0;
  for (const PluginInfo& p : host_.plugins()) {
    loaded += p.state == PluginState::Loaded;
    duplicates += p.state == PluginState::Duplicate;
  }
  EXPECT_EQ(loaded, 1);
  EXPECT_EQ(duplicates, 2);
  EXPECT_EQ(host_.techniques().find("second.own"), nullptr) << "registration is transactional";
}

TEST_F(PluginHostTest, RefusesDamagedCards) {
  const char* cards[] = {"",
                         "{",
                         "[]",
                         R"({"name": 3})",
                         R"({"name":"x","version":"1","interface":"i"})",
                         R"({"name":"x","version":"1","interface":"i","library":"../good.so"})",
                         R"({"name":"x","version":"1","interface":"i","library":"good.so","needs":"good"})"};
  int n = 0;
  for (const char* card : cards) {
    const fs::path folder = install("c" + std::to_string(n++), "good");
    std::ofstream(folder / "plugin.json") << card;
  }
  fs::create_directory(dir_.path() / "empty");
  host_.load({dir_.path().string()});
  EXPECT_EQ(host_.plugins().size(), std::size(cards) + 1);
  for (const PluginInfo& p : host_.plugins()) {
    EXPECT_EQ(p.state, PluginState::CardDamaged) << p.name;
    EXPECT_FALSE(p.reason.empty());
  }
}

TEST_F(PluginHostTest, RefusesThrowingAndFailingRegister) {
  install("throwing", "throwing");
  install("failing", "failing");
  EXPECT_EQ(load("throwing").state, PluginState::RegisterFailed);
  EXPECT_NE(info("throwing").reason.find("thrown while registering"), std::string::npos);
  EXPECT_EQ(info("failing").state, PluginState::RegisterFailed);
  EXPECT_TRUE(host_.techniques().all().empty()) << "nothing of a failed registration stays";
}

TEST_F(PluginHostTest, RefusesWhatOthersMayWrite) {
  const fs::path library = install("library", "good") / "good.so";
  ::chmod(library.c_str(), 0777);
  const fs::path card = install("card", "good") / "plugin.json";
  ::chmod(card.c_str(), 0666);
  ::chmod(install("folder", "good").c_str(), 0777);
  // A stranger's group or file: only root can give files away.
  std::vector<std::string> names{"library", "card", "folder"};
  if (::geteuid() == 0) {
    const fs::path group = install("group", "good") / "good.so", owner = install("owner", "good") / "good.so";
    ASSERT_EQ(::chown(group.c_str(), 0, 12345), 0);
    ASSERT_EQ(::chmod(group.c_str(), 0775), 0);
    ASSERT_EQ(::chown(owner.c_str(), 12345, 0), 0);
    names.insert(names.end(), {"group", "owner"});
  }
  host_.load({dir_.path().string()});
  for (const std::string& name : names) EXPECT_EQ(info(name).state, PluginState::WritableByOthers) << name;
}

TEST_F(PluginHostTest, NamesWhatIsNoPluginAndWhatCannotBeLoaded) {
  install("entries", "no_entries");
  std::ofstream(install("text", "good") / "good.so") << "this is no library";
  fs::remove(install("gone", "good") / "good.so");
  EXPECT_EQ(load("entries").state, PluginState::NotAPlugin);
  EXPECT_EQ(info("text").state, PluginState::LoadFailed);
  EXPECT_EQ(info("gone").state, PluginState::LibraryMissing);
}

TEST_F(PluginHostTest, SwitchesOffAPluginThatThrowsAtWork) {
  install("worker", "throws_at_work");
  ASSERT_EQ(load("worker").state, PluginState::Loaded);
  const Technique* t = host_.techniques().find("throws_at_work.technique");
  ASSERT_NE(t, nullptr);
  Images images;
  const Result<void> first = t->execute(Pass{}, images, {});
  ASSERT_FALSE(first.ok());
  EXPECT_EQ(first.error().code, ErrorCode::PluginFailed);
  EXPECT_EQ(info("worker").state, PluginState::Failed);
  EXPECT_NE(info("worker").reason.find("a bad day"), std::string::npos);
  EXPECT_EQ(t->execute(Pass{}, images, {}).error().code, ErrorCode::PluginFailed);
}

TEST_F(PluginHostTest, APanelBelongsToItsLayerKind) {
  install("panel", "panel");
  ASSERT_EQ(load("panel").state, PluginState::Loaded) << info("panel").reason;
  ASSERT_NE(host_.panelOf("test-kind"), nullptr);
  EXPECT_EQ(host_.panelOf("test-kind")->title, "A panel");
  EXPECT_EQ(host_.panelOf("slice"), nullptr);
  EXPECT_EQ(info("panel").panels.size(), 1u);
}

TEST_F(PluginHostTest, RefusesAPanelWithAFaultAndASecondOneForAKind) {
  install("a-bad", "bad_panel");
  install("b-first", "panel");
  install("c-second", "same_panel");
  EXPECT_EQ(load("a-bad").state, PluginState::RegisterFailed);
  EXPECT_NE(info("a-bad").reason.find("'on'"), std::string::npos) << info("a-bad").reason;
  EXPECT_EQ(info("b-first").state, PluginState::Loaded);
  EXPECT_EQ(info("c-second").state, PluginState::Duplicate);
  EXPECT_NE(info("c-second").reason.find("A panel for test-kind"), std::string::npos);
  EXPECT_EQ(host_.techniques().find("same_panel.technique"), nullptr) << "registration is transactional";
}

TEST_F(PluginHostTest, AMissingFolderIsNoError) {
  host_.load({(dir_.path() / "not-there").string()});
  EXPECT_TRUE(host_.plugins().empty());
}

TEST_F(PluginHostTest, TheMprPluginOfThisBuildLoads) {
  host_.load({std::string(VERNIER_BUILD_DIR) + "/lib/vernier/plugins"});
  EXPECT_EQ(info("mpr").state, PluginState::Loaded) << info("mpr").reason;
  EXPECT_NE(host_.techniques().find("mpr.native"), nullptr);
}

}  // namespace
}  // namespace vernier::app
