// SPDX-License-Identifier: GPL-3.0-or-later
// The menu under Help, and the check of the installation.
#include <spawn.h>
#include <sys/wait.h>

#include <cstdio>
#include <thread>

#include "Dialog.h"
#include "Gui.h"

extern char** environ;

namespace vernier::ui {
namespace {

constexpr std::size_t kMostNamed = 8;

// In the desktop's own browser; false where there is none.
bool openInBrowser(const std::string& file) {
  std::string program = "xdg-open", path = file;
  char* argv[] = {program.data(), path.data(), nullptr};
  pid_t child = 0;
  if (::posix_spawnp(&child, argv[0], nullptr, nullptr, argv, environ) != 0) return false;
  std::thread([child] { ::waitpid(child, nullptr, 0); }).detach();
  return true;
}

}  // namespace

void Gui::helpMenu(ImVec2 corner) {
  ImGui::SetNextWindowPos({corner.x, corner.y + theme_.px(4)}, ImGuiCond_Always, {1, 0});
  if (!ImGui::BeginPopup("##helpmenu")) return;
  if (ImGui::MenuItem("Mouse and keys", "F1")) help_ = true;
  if (ImGui::MenuItem("Check this installation")) {
    qualityShown_ = true;
    if (desk_.quality().state().phase == QualityState::Phase::Idle) desk_.quality().start();
  }
  ImGui::EndPopup();
}

void Gui::qualityResult(const QualityState& s) {
  const bool passed = s.notPassed.empty();
  ImGui::PushStyleColor(ImGuiCol_Text, passed ? colour::kGood : colour::kAmber);
  ImGui::PushFont(theme_.bold);
  ImGui::TextUnformatted(passed ? "Passed" : "Not passed");
  ImGui::PopFont();
  ImGui::PopStyleColor();
  for (const std::string& line : s.summary) ImGui::TextUnformatted(line.c_str());
  for (std::size_t k = 0; k < std::min(kMostNamed, s.notPassed.size()); ++k)
    ImGui::BulletText("%s", s.notPassed[k].c_str());
  if (s.notPassed.size() > kMostNamed)
    ImGui::TextDisabled("and %d more", static_cast<int>(s.notPassed.size() - kMostNamed));
  ImGui::Dummy({0, theme_.px(2)});
  ImGui::TextDisabled("The report, to be read and filed:");
  ImGui::TextUnformatted(s.report.c_str());
}

void Gui::quality() {
  if (!qualityShown_) return;
  using Phase = QualityState::Phase;
  const QualityState s = desk_.quality().state();
  const Dialog dialog(theme_, "##quality", "Check of this installation");
  ImGui::PushTextWrapPos(theme_.px(560));
  ImGui::TextDisabled(
      "Draws and measures phantoms whose answers are known, with both engines. It tests the software up to "
      "the "
      "picture in memory, not the display.");
  ImGui::Dummy({theme_.px(560), theme_.px(4)});
  if (s.phase == Phase::Running) {
    char text[64];
    std::snprintf(text, sizeof text, "%d of %d cases", s.done, s.total);
    ImGui::ProgressBar(s.total > 0 ? static_cast<float>(s.done) / static_cast<float>(s.total) : 0,
                       {theme_.px(560), theme_.px(22)}, text);
  } else if (s.phase == Phase::Finished) {
    qualityResult(s);
  } else if (s.phase == Phase::Failed) {
    ImGui::TextUnformatted(s.sentence.c_str());
  } else {
    ImGui::TextUnformatted("Not run.");
  }
  ImGui::PopTextWrapPos();
  ImGui::Dummy({0, theme_.px(6)});
  if (s.phase == Phase::Running) {
    if (dialogButton("Cancel", theme_.px(96))) desk_.quality().cancel();
  } else {
    if (s.phase == Phase::Finished && dialogButton("Open report", theme_.px(120)) && !openInBrowser(s.report))
      why_ = "No browser could be started; open the report by its name.";
    if (s.phase == Phase::Finished) ImGui::SameLine();
    if (dialogButton("Run again", theme_.px(110))) desk_.quality().start();
    ImGui::SameLine();
    if (dialogButton("Close", theme_.px(96))) qualityShown_ = false;
  }
}

}  // namespace vernier::ui
