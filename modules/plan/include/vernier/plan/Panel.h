// SPDX-License-Identifier: GPL-3.0-or-later
// Panel: what a user may set on a plugin's own layer, as plain data. A plugin describes its controls, the
// window draws them with its own toolkit; the plugin links none. Each control is bound to one key of the
// layer's JSON object (CustomLayer::json), so a panel edits the scene and nothing else, and a scene file
// shows all that a panel set. Pure functions, safe on any thread.
#pragma once
#include <string>
#include <variant>
#include <vector>

#include "vernier/base/Api.h"
#include "vernier/base/Result.h"
#include "vernier/plan/Scene.h"

namespace vernier {

// Text that the user reads: what the layer is, in which unit its numbers are.
struct PanelLabel {
  std::string text;
};
// A number from `least` to `most`. `step` 0: any number between them, else least + n * step.
struct PanelSlider {
  std::string key, label;
  double least = 0, most = 1, step = 0;
  double initial = 0;
  std::string unit;  // shown behind the number: "HU", "mm", "" for none
};
struct PanelCheckbox {
  std::string key, label;
  bool initial = false;
};
struct PanelText {
  std::string key, label, initial;
};
using PanelControl = std::variant<PanelLabel, PanelSlider, PanelCheckbox, PanelText>;

struct Panel {
  std::string title;                   // "Value band"
  std::string kind;                    // the plugin's own layer kind that it edits, "example.band"
  int version = 1;                     // CustomLayer::version of the layers that it makes
  std::vector<PanelControl> controls;  // in the order in which they stand
};

// What stands under a control's key. A label has none.
using PanelValue = std::variant<std::monostate, double, bool, std::string>;

inline constexpr std::size_t kMaxPanelControls = 100;

// The key that a control edits; "" for a label.
VERNIER_API const std::string& keyOf(const PanelControl&);
VERNIER_API const char* typeOf(const PanelControl&);  // "label", "slider", "checkbox", "text"

// PluginFailed with the fault: no title, no kind, a kind of this program, no or more than kMaxPanelControls
// controls, an empty or repeated key, one of the keys that every layer has (kind, version, source), a slider
// whose numbers are not finite or whose initial value lies outside least..most.
VERNIER_API Result<void> checkPanel(const Panel&);

// A new layer with every control at its initial value, reading the volume `source`.
VERNIER_API Result<CustomLayer> newLayer(const Panel&, const std::string& source);

// What the layer says under the control's key, or the initial value when it says nothing. SceneInvalid when
// it says something of another type, or a number outside the slider's range.
VERNIER_API Result<PanelValue> panelValue(const CustomLayer&, const PanelControl&);

// The layer with that value; every other key stays as it was, token by token. SceneInvalid when the value is
// not of the control's type or out of its range.
VERNIER_API Result<CustomLayer> withPanelValue(const CustomLayer&, const PanelControl&, const PanelValue&);

}  // namespace vernier
