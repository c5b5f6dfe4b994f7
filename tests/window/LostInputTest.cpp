// SPDX-License-Identifier: GPL-3.0-or-later
// What the window says when files go away or are cut short after they were listed: one sentence where the
// picture would be, and everything else goes on.
#include <gtest/gtest.h>

#include <filesystem>

#include "WindowDriver.h"
#include "WindowStudies.h"
#include "XWindow.h"

namespace vernier::ui {
namespace {

namespace fs = std::filesystem;
using test::smallStudy;
using test::volumeFile;
using test::WindowDriver;

void expectOneSentence(const std::string& s) {
  EXPECT_FALSE(s.empty());
  EXPECT_EQ(s.find('\n'), std::string::npos) << s;
  EXPECT_EQ(s.back(), '.') << s;
  EXPECT_EQ(s.find("/tmp"), std::string::npos) << s;  // nobody's folders on the screen
}

std::string sentenceOf(WindowDriver& w) {
  EXPECT_TRUE(w.settle());
  const auto& picture = w.desk().tileView(0).picture;
  return picture && picture->error ? picture->error->sentence : "";
}

TEST(LostInput, AFolderThatWasMoved) {
  vernier::test::TempDir dir;
  WindowDriver w;
  if (!w.here()) return;
  const std::string path = smallStudy(dir);
  w.open(path);
  fs::rename(path, dir.path() / "elsewhere");
  w.move(780, 420);
  w.wheel(-1);
  expectOneSentence(sentenceOf(w));
  fs::rename(dir.path() / "elsewhere", path);  // back again: the next picture is there
  w.wheel(-1);
  EXPECT_EQ(sentenceOf(w), "");
}

TEST(LostInput, AFileThatWasCutShort) {
  vernier::test::TempDir dir;
  WindowDriver w;
  if (!w.here()) return;
  const std::string path = smallStudy(dir);
  w.open(path);
  for (const auto& file : fs::directory_iterator(path))
    if (file.path().extension() == ".dcm") fs::resize_file(file, 4000);
  w.move(780, 420);
  w.wheel(-1);
  expectOneSentence(sentenceOf(w));
}

TEST(LostInput, AVolumeFileThatEndsEarly) {
  vernier::test::TempDir dir;
  WindowDriver w;
  if (!w.here()) return;
  const std::string path = volumeFile(dir, "short");
  fs::resize_file(path, fs::file_size(path) - 100);
  w.open(path);
  const Error* why = w.desk().volumeError(w.workspace().tile(0).source);
  ASSERT_NE(why, nullptr);
  expectOneSentence(why->sentence);
}

TEST(LostInput, AFolderOfNothing) {
  vernier::test::TempDir dir;
  WindowDriver w;
  if (!w.here()) return;
  w.open(dir.path().string());
  ASSERT_EQ(w.desk().messages().size(), 1u);
  expectOneSentence(w.desk().messages()[0]);
}

TEST(Window, TheNoticeSaysWhyItWillComeAgain) {
  HostOptions options;
  options.notice = true;
  options.noticeAccepted = [] { return std::string("The settings folder cannot be written."); };
  WindowDriver w(options);
  if (!w.here()) return;
  const Picture before = w.screenshot();
  w.key(GLFW_KEY_ENTER);
  EXPECT_EQ(w.host().gui().why(), "The settings folder cannot be written.");
  EXPECT_FALSE(w.screenshot().pixels == before.pixels);
}

// The same hands as a person's: events from the X server, through GLFW, into the loop.
TEST(Window, RealMouseAndKeys) {
  vernier::test::TempDir dir;
  WindowDriver w;
  if (!w.here()) return;
  if (!fs::exists("/usr/bin/xdotool")) {
    std::cout << "[  NOTE    ] no xdotool here: not checked\n";
    return;
  }
  w.open(smallStudy(dir));
  const std::int64_t middle = imageOf(w.workspace().tile(0).scene)->index;
  const std::string window = std::to_string(test::findWindow(std::getenv("DISPLAY"), "Vernier", 10));
  vernier::test::ProgramRun hands;
  std::atomic<bool> over = false;
  std::thread person([&] {
    hands = vernier::test::runProgram({"/usr/bin/xdotool",
                                       "windowfocus",
                                       window,
                                       "mousemove",
                                       "780",
                                       "420",
                                       "sleep",
                                       "0.3",  //
                                       "click",
                                       "5",
                                       "click",
                                       "5",
                                       "click",
                                       "5",
                                       "sleep",
                                       "0.3",  // three slices down
                                       "mousedown",
                                       "1",
                                       "mousemove_relative",
                                       "50",
                                       "0",
                                       "sleep",
                                       "0.3",
                                       "mouseup",
                                       "1",
                                       "sleep",
                                       "0.3",  //
                                       "key",
                                       "F4",
                                       "sleep",
                                       "0.5",
                                       "key",
                                       "ctrl+q"},
                                      30);
    std::this_thread::sleep_for(std::chrono::seconds(2));  // were it not closed by now, it would never be
    over = true;
    glfwPostEmptyEvent();
  });
  w.host().run([&] { return !over; });
  EXPECT_TRUE(w.host().gui().wantsToQuit());
  person.join();
  EXPECT_EQ(hands.exitCode, 0) << hands.err;
  EXPECT_EQ(w.workspace().shown().size(), 4u);
  const SliceLayer* axial = sliceOf(w.workspace().tile(0).scene);
  ASSERT_TRUE(axial && axial->window);
  EXPECT_GT(axial->window->width, 0);
  w.workspace().openStack();
  EXPECT_EQ(imageOf(w.workspace().tile(0).scene)->index, middle + 3);
}

}  // namespace
}  // namespace vernier::ui
