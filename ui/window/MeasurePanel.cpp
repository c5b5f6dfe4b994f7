// SPDX-License-Identifier: GPL-3.0-or-later
// The list of measurements: what each says, where its millimetres come from, and its file.
#include <cstdio>

#include "Gui.h"

namespace vernier::ui {
namespace {

constexpr ImGuiWindowFlags kFixed = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                    ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus;

std::string titleOf(const measure::Measurement& m, int number) {
  std::string kind = measure::kindOf(m.shape);
  if (std::holds_alternative<measure::Cobb>(m.shape)) kind = "cobb angle";
  if (std::holds_alternative<measure::Bidirectional>(m.shape)) kind = "diameters";
  if (std::holds_alternative<measure::FreehandRegion>(m.shape)) kind = "outline by hand";
  kind[0] = static_cast<char>(kind[0] - 32);
  return std::to_string(number) + "  " + (m.label.empty() ? kind : m.label);
}

}  // namespace

void Gui::measureRow(const Drawn& d, int number) {
  Workspace& w = desk_.workspace();
  const std::string id = d.what.id;
  ImGui::PushID(id.c_str());
  const float button = theme_.px(22);
  if (ImGui::Selectable(titleOf(d.what, number).c_str(), selected_ == id, 0,
                        {ImGui::GetContentRegionAvail().x - button - theme_.px(4), 0})) {
    selected_ = id;
    if (d.what.on.space == measure::Space::Image)  // to the image that it stands on
      for (const int t : w.shown())
        if (w.tile(t).source == SourceId{d.document, d.what.on.source}) {
          w.setImage(t, d.what.on.frame);
          break;
        }
  }
  ImGui::SameLine();
  const bool away = ImGui::SmallButton("x");
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("Takes it away (Del)");
  ImGui::PushFont(theme_.small);
  ImGui::PushTextWrapPos(0);
  const Result<measure::Measured>* said = desk_.said(d);
  if (!said)
    ImGui::TextDisabled("its volume is loading");
  else if (!*said)
    ImGui::TextWrapped("%s", said->error().sentence.c_str());
  else {
    for (const measure::Quantity& q : (*said)->quantities)
      ImGui::TextUnformatted((q.name + "  " + measure::displayText(q)).c_str());
    if ((*said)->values) ImGui::TextUnformatted(measure::displayStatistics(**said).c_str());
    if (!(*said)->quantities.empty() && (*said)->quantities.front().unit != "deg")
      ImGui::TextDisabled("%s", (*said)->originText.c_str());
    for (const std::string& note : (*said)->notes) ImGui::TextDisabled("%s", note.c_str());
  }
  if (selected_ == id) measureWords(d);
  if (w.canSnap(id)) {
    if (ImGui::SmallButton("Snap to acquired slice")) w.snap(id);
    if (ImGui::IsItemHovered())
      ImGui::SetTooltip(
          "Takes the region, and its picture, to the nearest acquired slice: values of stored pixels");
  }
  ImGui::PopTextWrapPos();
  ImGui::PopFont();
  ImGui::Dummy({0, theme_.px(3)});
  ImGui::PopID();
  if (!away) return;
  w.removeMeasurement(id);  // `d` is gone
  if (selected_ == id) selected_.clear();
}

// Of the chosen one: what the user calls it, or what an arrow or a text says.
void Gui::measureWords(const Drawn& d) {
  measure::Measurement m = d.what;
  auto* arrow = std::get_if<measure::Arrow>(&m.shape);
  auto* text = std::get_if<measure::Text>(&m.shape);
  std::string& words = arrow ? arrow->text : text ? text->text : m.label;
  if (wordsOf_ != m.id) {
    wordsOf_ = m.id;
    std::snprintf(words_, sizeof words_, "%s", words.c_str());
  }
  ImGui::SetNextItemWidth(-1);
  ImGui::InputTextWithHint("##words", arrow || text ? "Words" : "Label", words_, sizeof words_);
  if (!ImGui::IsItemActive() && !ImGui::IsItemDeactivated())
    std::snprintf(words_, sizeof words_, "%s", words.c_str());  // as undo left them
  if (!ImGui::IsItemDeactivatedAfterEdit() || (text && words_[0] == '\0')) return;
  words = words_;
  desk_.workspace().changeMeasurement(m);
}

// Measurements of the active picture's document.
void Gui::measureFile() {
  const Workspace& w = desk_.workspace();
  const int document = w.tile(w.now().active).source.document;
  ImGui::SetNextItemWidth(-1);
  ImGui::InputTextWithHint("##list", "File, JSON: its path", listPath_, sizeof listPath_);
  ImGui::BeginDisabled(listPath_[0] == '\0');
  if (ImGui::Button("Save")) {
    const Result<void> r = desk_.saveMeasurements(document, listPath_);
    why_ = r ? "" : r.error().sentence;
  }
  ImGui::SameLine();
  if (ImGui::Button("Load")) {
    const Result<void> r = desk_.loadMeasurements(document, listPath_);
    why_ = r ? "" : r.error().sentence + (r.error().where.empty() ? "" : " (" + r.error().where + ")");
  }
  ImGui::EndDisabled();
}

void Gui::measureList(Rect r) {
  ImGui::SetNextWindowPos({r.x, r.y});
  ImGui::SetNextWindowSize({r.w, r.h});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {theme_.px(10), theme_.px(8)});
  ImGui::Begin("##measurements", nullptr, kFixed);
  ImGui::PopStyleVar();
  ImGui::PushFont(theme_.bold);
  ImGui::TextUnformatted("Measurements");
  ImGui::PopFont();
  const float file = theme_.px(112);
  ImGui::BeginChild("##rows", {0, -file});
  const std::vector<Drawn> all = desk_.workspace().now().measurements;  // a row may take one away
  if (all.empty())
    ImGui::TextWrapped(
        "None yet. L measures a length, A an angle, E and B a region, V a value; Measure has them all.");
  for (std::size_t n = 0; n < all.size(); ++n) measureRow(all[n], static_cast<int>(n) + 1);
  ImGui::EndChild();
  measureFile();
  ImGui::PushFont(theme_.small);
  ImGui::TextWrapped("\u00b1 is k = 2; %s", measure::kNotIncluded);
  ImGui::PopFont();
  ImGui::End();
}

}  // namespace vernier::ui
