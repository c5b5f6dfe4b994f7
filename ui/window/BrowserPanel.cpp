// SPDX-License-Identifier: GPL-3.0-or-later
// What is open: patients, studies, series and stacks, with thumbnails and findings.
#include <algorithm>
#include <cstring>

#include "Gui.h"

namespace vernier::ui {
namespace {

constexpr float kThumb = 60;
constexpr ImGuiWindowFlags kFlags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                    ImGuiWindowFlags_NoSavedSettings |
                                    ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoNav;

// "20240131" as "2024-01-31"; anything else as it stands.
std::string shownDate(const std::string& da) {
  if (da.size() != 8 || da.find_first_not_of("0123456789") != std::string::npos) return da;
  return da.substr(0, 4) + "-" + da.substr(4, 2) + "-" + da.substr(6, 2);
}

std::string joined(std::initializer_list<std::string> parts, const char* by) {
  std::string all;
  for (const std::string& p : parts)
    if (!p.empty()) all += (all.empty() ? "" : by) + p;
  return all;
}

std::vector<const Finding*> findingsOf(const Series& series, const Stack& stack) {
  std::vector<const Finding*> all;
  for (const Finding& f : stack.findings) all.push_back(&f);
  for (const Finding& f : series.findings) all.push_back(&f);
  return all;
}

// Of what has no images: the first object says whose the series is.
bool ofPatient(const StudySet& set, const Series& series, const Patient& p) {
  return series.instances.empty() || set.instances[series.instances.front()].patient >= set.patients.size() ||
         &set.patients[set.instances[series.instances.front()].patient] == &p;
}

std::string counted(std::size_t n, const char* one) {
  return std::to_string(n) + " " + one + (n == 1 ? "" : "s");
}

}  // namespace

void Gui::openField() {
  ImGui::SetNextItemWidth(-FLT_MIN);
  if (ImGui::InputTextWithHint("##path", "Open a folder or file: type its path, Enter", path_, sizeof path_,
                               ImGuiInputTextFlags_EnterReturnsTrue) &&
      path_[0] != 0) {
    desk_.open({path_});
    path_[0] = 0;
  }
}

void Gui::browser(Rect r) {
  ImGui::SetNextWindowPos({r.x, r.y});
  ImGui::SetNextWindowSize({r.w, r.h});
  ImGui::Begin("##browser", nullptr, kFlags);
  openField();
  ImGui::Dummy({0, theme_.px(2)});
  ImGui::BeginChild("##list");
  int closing = -1;
  for (const auto& d : desk_.documents()) {
    ImGui::PushID(d->number);
    ImGui::PushFont(theme_.small);
    ImGui::TextDisabled("%s", d->title.c_str());
    const float x = ImGui::GetContentRegionMax().x - ImGui::CalcTextSize("Close").x;
    ImGui::SameLine(std::max(x, ImGui::GetCursorPosX()));
    ImGui::TextDisabled("Close");
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("Takes this input off the list; files are not touched");
    if (ImGui::IsItemClicked()) closing = d->number;
    ImGui::PopFont();
    document(*d);
    ImGui::Dummy({0, theme_.px(8)});
    ImGui::PopID();
  }
  if (desk_.documents().empty()) {
    ImGui::PushTextWrapPos(0);
    ImGui::TextDisabled(
        "No study is open. Drop a folder of DICOM files, or volume files, anywhere on the window.");
    ImGui::PopTextWrapPos();
  }
  ImGui::EndChild();
  ImGui::GetWindowDrawList()->AddLine({r.x + r.w - 1, r.y}, {r.x + r.w - 1, r.y + r.h}, colour::kLine);
  ImGui::End();
  if (closing >= 0) desk_.close(closing);
}

void Gui::document(Document& d) {
  const StudySet& set = d.session->study();
  for (const Patient& p : set.patients) {
    ImGui::PushFont(theme_.bold);
    const std::string name = shownName(p.name);
    ImGui::TextUnformatted(name.empty() ? "No name" : name.c_str());
    ImGui::PopFont();
    ImGui::PushFont(theme_.small);
    const std::string about = joined({p.id.empty() ? "no ID" : "ID " + p.id,
                                      p.birthDate.empty() ? "" : "born " + shownDate(p.birthDate), p.sex},
                                     "   ");
    ImGui::TextDisabled("%s", about.c_str());
    ImGui::PopFont();
    for (const std::size_t st : p.studies) {
      const Study& study = set.studies[st];
      ImGui::Dummy({0, theme_.px(2)});
      ImGui::TextUnformatted(joined({shownDate(study.date), study.description}, "  ").c_str());
      for (const std::size_t s : study.series) {
        const Series& series = set.series[s];
        if (series.stacks.empty() && ofPatient(set, series, p)) objects(set, series);
        for (std::size_t k = 0; k < series.stacks.size(); ++k) {
          const Stack& stack = series.stacks[k];
          if (patientOf(set, stack) && patientOf(set, stack) != &p) continue;  // a study of several patients
          const std::string title =
              joined({series.description.empty()
                          ? "Series " + (series.number ? std::to_string(*series.number) : "without number")
                          : series.description},
                     "");
          const std::string rows =
              joined({series.modality, counted(stack.slices.size(), "image"), stack.label}, "  ");
          stackRow(d, series, stack, {d.number, d.session->sourceName({s, k})}, title, rows);
        }
      }
    }
    ImGui::Dummy({0, theme_.px(4)});
  }
  volumeFiles(d);
}

// What of a series is no image: presentation states, reports and the like.
void Gui::objects(const StudySet& set, const Series& series) {
  ImGui::PushFont(theme_.small);
  std::size_t states = 0;
  for (std::size_t n = 0; n < set.presentations.size(); ++n) {
    const PresentationState& p = set.presentations[n];
    if (std::find(series.instances.begin(), series.instances.end(), p.instance) == series.instances.end())
      continue;
    ++states;
    const std::string name = joined({p.label, p.description}, ": ");
    ImGui::TextDisabled("%s", joined({series.modality, "presentation state", p.label}, "  ").c_str());
    if (!ImGui::IsItemHovered()) continue;
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(theme_.px(400));
    if (!name.empty()) ImGui::TextUnformatted(name.c_str());
    const std::string how = p.whyNot.empty()
                                ? "The window shows the image without it; `vernier render STUDY --view stack "
                                  "--presentation " +
                                      std::to_string(n + 1) + "` applies it."
                                : "Listed only: " + p.whyNot + ".";
    ImGui::TextDisabled("%s", how.c_str());
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
  }
  if (const std::size_t others = series.instances.size() - states; others > 0)
    ImGui::TextDisabled(
        "%s", joined({series.modality, series.description, counted(others, "object") + ", not shown"}, "  ")
                  .c_str());
  ImGui::PopFont();
}

void Gui::volumeFiles(Document& d) {
  static const Series none;
  static const Stack noStack;
  const auto& files = d.session->volumeFiles();
  for (std::size_t v = 0; v < files.size(); ++v) {
    const std::string title = titleOf(*d.session, files[v]);
    if (files[v].facts) {
      const SourceId source{d.number, d.session->sourceName({0, 0, v})};
      stackRow(d, none, noStack, source, title, "volume file  " + files[v].facts->format);
      continue;
    }
    ImGui::PushFont(theme_.small);
    ImGui::TextDisabled("%s  not shown", title.c_str());
    if (ImGui::IsItemHovered() && files[v].error) ImGui::SetTooltip("%s", files[v].error->sentence.c_str());
    ImGui::PopFont();
  }
}

void Gui::stackRow(Document& d, const Series& series, const Stack& stack, const SourceId& source,
                   const std::string& title, const std::string& about) {
  const float size = std::round(theme_.px(kThumb));
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x;
  ImGui::PushID(source.name.c_str());
  const Workspace& w = desk_.workspace();
  bool active = false, shown = false;
  for (int t : w.shown()) {
    if (w.tile(t).source != source) continue;
    shown = true;
    active = active || t == w.now().active;
  }
  ImGui::PushStyleColor(ImGuiCol_Header, active ? colour::kAccentDark : colour::kRaised);
  const bool clicked =
      ImGui::Selectable("##row", shown, ImGuiSelectableFlags_AllowDoubleClick, {width, size + theme_.px(6)});
  ImGui::PopStyleColor();
  if (clicked && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) desk_.openSource(source, w.now().active);
  const bool hovered = ImGui::IsItemHovered();
  if (ImGui::BeginDragDropSource()) {
    std::vector<char> payload(sizeof(int) + source.name.size() + 1);
    std::memcpy(payload.data(), &source.document, sizeof(int));
    std::memcpy(payload.data() + sizeof(int), source.name.c_str(), source.name.size() + 1);
    ImGui::SetDragDropPayload("vernier.source", payload.data(), payload.size());
    ImGui::TextUnformatted(title.c_str());
    ImGui::EndDragDropSource();
  }
  if (ImGui::IsItemVisible()) {
    ImDrawList* draw = ImGui::GetWindowDrawList();
    const float pad = theme_.px(3);
    const ImVec2 a{at.x + pad, at.y + pad}, b{a.x + size, a.y + size};
    draw->AddRectFilled(a, b, colour::kImage, theme_.px(2));
    if (const auto it = d.thumbnails.find(source); it != d.thumbnails.end())
      if (const auto texture =
              textures_.get("thumb" + std::to_string(source.document) + source.name, 1, it->second))
        draw->AddImage(reinterpret_cast<ImTextureID>(texture), a, b);
    const float x = b.x + theme_.px(9);
    const float line = theme_.body->FontSize, small = theme_.small->FontSize;
    float y = a.y + (size - line - small - theme_.px(4)) / 2;
    draw->PushClipRect({x, at.y}, {at.x + width - theme_.px(22), at.y + size + 2 * pad}, true);
    draw->AddText(theme_.body, line, {x, y}, colour::kText, title.c_str());
    y += line + theme_.px(4);
    draw->AddText(theme_.small, small, {x, y}, colour::kDim, about.c_str());
    draw->PopClipRect();
    const std::vector<const Finding*> findings = findingsOf(series, stack);
    badge(findings, {at.x + width - theme_.px(20), a.y + theme_.px(4)});
    if (hovered && !ImGui::IsMouseDragging(ImGuiMouseButton_Left)) {
      ImGui::BeginTooltip();
      ImGui::PushTextWrapPos(theme_.px(400));
      ImGui::TextUnformatted(title.c_str());
      ImGui::TextDisabled("%s", about.c_str());
      if (!stack.volume3d && !stack.why2d.empty()) ImGui::TextUnformatted(("No MPR: " + stack.why2d).c_str());
      for (const Finding* f : findings) ImGui::BulletText("%s", f->sentence.c_str());
      ImGui::TextDisabled("Double click opens it here; drag it onto a picture.");
      ImGui::PopTextWrapPos();
      ImGui::EndTooltip();
    }
  }
  ImGui::PopID();
}

// Info stays in the tooltip; what changes a number or the picture shows.
void Gui::badge(const std::vector<const Finding*>& findings, ImVec2 at) {
  Severity worst = Severity::Info;
  for (const Finding* f : findings) worst = std::max(worst, f->severity);
  if (worst < Severity::Warning) return;
  const float size = theme_.px(15);
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const ImU32 c = worst == Severity::Refusal ? colour::kRed : colour::kAmber;
  const ImVec2 middle{at.x + size / 2, at.y + size / 2};
  draw->AddCircleFilled(middle, size / 2, c);
  const ImVec2 s = theme_.bold->CalcTextSizeA(size * 0.85f, 1e6f, 0, "!");
  draw->AddText(theme_.bold, size * 0.85f, {middle.x - s.x / 2, middle.y - s.y / 2}, colour::kBack, "!");
}

}  // namespace vernier::ui
