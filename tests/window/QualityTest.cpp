// SPDX-License-Identifier: GPL-3.0-or-later
// The check of the installation from the window: by the program itself, beside the window.
#include "QualityCheck.h"

#include <fstream>
#include <nlohmann/json.hpp>

#include "Golden.h"
#include "TestData.h"
#include "WindowDriver.h"

namespace vernier::ui {
namespace {
using vernier::test::TempDir;
using Phase = QualityState::Phase;

// Until it is over, or `until` is true.
template <class Until>
QualityState wait(QualityCheck& check, Until&& until) {
  for (int k = 0; k < 2400; ++k) {
    const QualityState s = check.state();
    if (s.phase != Phase::Running || until(s)) return s;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return check.state();
}
QualityState wait(QualityCheck& check) {
  return wait(check, [](const QualityState&) { return false; });
}

TEST(QualityCheck, RunsTheSuiteAndKeepsTheReport) {
  const TempDir dir;
  std::atomic<int> woken = 0;
  QualityCheck check([&] { ++woken; });
  EXPECT_EQ(check.state().phase, Phase::Idle);
  check.useProgram(VERNIER_PROGRAM);
  check.start(dir.path().string());
  EXPECT_EQ(check.state().phase, Phase::Running);
  EXPECT_GE(check.state().total, 60);
  const QualityState s = wait(check);
  ASSERT_EQ(s.phase, Phase::Finished) << s.sentence;
  EXPECT_TRUE(s.notPassed.empty()) << s.notPassed.front();
  EXPECT_EQ(s.done, s.total);
  EXPECT_EQ(s.summary.size(), 2u);
  EXPECT_GT(woken, s.total);
  std::ifstream json(std::filesystem::path(s.report).parent_path() / "report.json");
  EXPECT_EQ(nlohmann::json::parse(json)["verdict"], "pass");
}

TEST(QualityCheck, CancelLeavesNothingBehind) {
  const TempDir dir;
  QualityCheck check([] {});
  check.useProgram(VERNIER_PROGRAM);
  check.start(dir.path().string());
  wait(check, [](const QualityState& s) { return s.done > 2; });
  check.cancel();
  EXPECT_EQ(wait(check).phase, Phase::Idle);
  EXPECT_TRUE(std::filesystem::is_empty(dir.path()));
}

// A suite with a case that fails beside one that passes, and a program that stands in its prefix by a link.
TEST(QualityCheck, NamesWhatDoesNotPass) {
  const TempDir dir;
  const auto prefix = dir.path() / "prefix";
  std::filesystem::create_directories(prefix / "bin");
  std::ofstream(prefix / "bin" / "vernier") << "#!/bin/sh\nexec '" << VERNIER_PROGRAM << "' \"$@\"\n";
  std::filesystem::permissions(prefix / "bin" / "vernier", std::filesystem::perms::owner_all);
  const auto write = [&](const std::string& name, int expected) {
    std::filesystem::create_directories(prefix / "share/vernier/clinic" / name);
    std::ofstream(prefix / "share/vernier/clinic" / name / "case.json")
        << R"({"schema": "vernier-qa-case/1", "title": "t", "why": "w", "data": {"recipe": "uniform"}, "checks": [)"
        << R"({"kind": "probe", "voxel": [1, 1, 1], "tolerance": 0, "expected": )" << expected << "}]}";
  };
  write("a", 1000);
  write("b", 1001);
  QualityCheck check([] {});
  check.useProgram((prefix / "bin" / "vernier").string());
  check.start((dir.path() / "reports").string());
  const QualityState s = wait(check);
  ASSERT_EQ(s.phase, Phase::Finished) << s.sentence;
  EXPECT_EQ(s.total, 2);
  EXPECT_EQ(s.notPassed, (std::vector<std::string>{"native: b", "gl: b"}));
}

TEST(QualityCheck, SaysWhyItCannotRun) {
  const TempDir dir;
  QualityCheck check([] {});
  check.useProgram((dir.path() / "bin" / "vernier").string());  // no suite beside it
  check.start(dir.path().string());
  EXPECT_EQ(check.state().phase, Phase::Failed);
  EXPECT_NE(check.state().sentence.find("not beside the program"), std::string::npos);
  check.useProgram(VERNIER_PROGRAM);
  std::ofstream(dir.path() / "file") << "no folder";
  check.start((dir.path() / "file").string());
  const QualityState s = wait(check);
  EXPECT_EQ(s.phase, Phase::Failed);
  EXPECT_NE(s.sentence.find("cannot be made"), std::string::npos) << s.sentence;
}

// To be looked at: where VERNIER_SHOW names a folder.
void show(test::WindowDriver& w, const char* name) {
  const char* const out = std::getenv("VERNIER_SHOW");
  if (!out) return;
  EXPECT_TRUE(writePng(std::string(out) + "/" + name + ".png", w.host().screenshot()).ok());
}

TEST(QualityWindow, HelpMenuRunsItAndShowsTheResult) {
  const TempDir dir;
  ::setenv("XDG_DATA_HOME", dir.path().c_str(), 1);
  test::WindowDriver w;
  if (!w.here()) return;
  w.desk().quality().useProgram(VERNIER_PROGRAM);
  ASSERT_TRUE(w.settle());
  w.click(1248, 23);
  w.host().frame();
  show(w, "menu");
  w.click(1180, 70);
  ASSERT_EQ(w.desk().quality().state().phase, Phase::Running);
  wait(w.desk().quality(), [](const QualityState& s) { return s.done > 20; });
  w.host().frame();
  w.host().frame();
  show(w, "running");
  ASSERT_EQ(wait(w.desk().quality()).phase, Phase::Finished);
  EXPECT_TRUE(w.desk().update());  // the window is told
  w.host().frame();
  w.host().frame();
  show(w, "result");
  w.key(GLFW_KEY_ESCAPE);
  ::unsetenv("XDG_DATA_HOME");
}

}  // namespace
}  // namespace vernier::ui
