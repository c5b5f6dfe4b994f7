// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/plan/Panel.h"

#include <array>
#include <cmath>
#include <set>

#include "JsonText.h"
#include "Numbers.h"
#include "SceneReader.h"
#include "vernier/base/Guarded.h"
#include "vernier/plan/SceneJson.h"

namespace vernier {
namespace {

template <class... Ts>
struct Overloaded : Ts... {
  using Ts::operator()...;
};

// Keys that every layer has: a control must not edit them.
constexpr std::array<const char*, 3> kReserved = {"kind", "version", "source"};

Error panelError(const Panel& panel, const std::string& what) {
  return makeError(ErrorCode::PluginFailed, "The panel '" + panel.title + "' " + what + ".", panel.kind);
}

std::string textOf(const std::string& s) {
  return nlohmann::json(s).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string textOf(const PanelValue& value) {
  return std::visit(
      Overloaded{[](std::monostate) { return std::string("null"); }, [](double x) { return shortest(x); },
                 [](bool on) { return std::string(on ? "true" : "false"); },
                 [](const std::string& s) { return textOf(s); }},
      value);
}

PanelValue initialOf(const PanelControl& control) {
  return std::visit(Overloaded{[](const PanelLabel&) { return PanelValue(); },
                               [](const auto& c) { return PanelValue(c.initial); }},
                    control);
}

// "" when the value suits the control, else what is wrong with it.
std::string faultOf(const PanelControl& control, const PanelValue& value) {
  if (value.index() != initialOf(control).index())
    return std::string("does not suit a control of type ") + typeOf(control);
  const auto* slider = std::get_if<PanelSlider>(&control);
  if (!slider) return "";
  const double x = std::get<double>(value);
  if (x >= slider->least && x <= slider->most) return "";
  return "is " + shortest(x) + ", outside " + shortest(slider->least) + " to " + shortest(slider->most);
}

Result<void> checkSlider(const Panel& panel, const PanelSlider& s) {
  for (const double x : {s.least, s.most, s.step, s.initial})
    if (!std::isfinite(x)) return panelError(panel, "has a number under '" + s.key + "' that is not finite");
  if (s.least >= s.most || s.step < 0)
    return panelError(panel, "has a slider '" + s.key + "' without a range or with a negative step");
  if (const std::string fault = faultOf(s, s.initial); !fault.empty())
    return panelError(panel, "has a slider '" + s.key + "' whose initial value " + fault);
  return {};
}

Result<PanelValue> valueIn(const nlohmann::json& layer, const PanelControl& control) {
  const std::string& key = keyOf(control);
  if (key.empty() || !layer.contains(key)) return initialOf(control);
  const ObjectReader o(layer, "");
  const PanelValue value =
      std::visit(Overloaded{[&](const PanelLabel&) { return PanelValue(); },
                            [&](const PanelSlider&) { return PanelValue(o.number(key)); },
                            [&](const PanelCheckbox&) { return PanelValue(o.flag(key)); },
                            [&](const PanelText&) { return PanelValue(o.text(key)); }},
                 control);
  if (const std::string fault = faultOf(control, value); !fault.empty())
    throw JsonFault{"The value " + fault + ".", pointerTo("", key)};
  return value;
}

}  // namespace

const std::string& keyOf(const PanelControl& control) {
  static const std::string none;
  return std::visit(Overloaded{[](const PanelLabel&) -> const std::string& { return none; },
                               [](const auto& c) -> const std::string& { return c.key; }},
                    control);
}

const char* typeOf(const PanelControl& control) {
  constexpr std::array<const char*, 4> names = {"label", "slider", "checkbox", "text"};
  static_assert(names.size() == std::variant_size_v<PanelControl>);
  return names[control.index()];
}

Result<void> checkPanel(const Panel& panel) {
  if (panel.title.empty() || panel.kind.empty() || panel.version < 1)
    return panelError(panel, "has no title, no layer kind or a version below 1");
  if (panel.controls.empty() || panel.controls.size() > kMaxPanelControls)
    return panelError(panel, "has " + std::to_string(panel.controls.size()) + " controls, expected 1 to " +
                                 std::to_string(kMaxPanelControls));
  std::set<std::string> keys(kReserved.begin(), kReserved.end());
  for (const PanelControl& control : panel.controls) {
    if (std::holds_alternative<PanelLabel>(control)) continue;
    const std::string& key = keyOf(control);
    if (key.empty() || !keys.insert(key).second)
      return panelError(
          panel, "binds a control to the key '" + key + "', which is empty, repeated or every layer's own");
    if (const auto* slider = std::get_if<PanelSlider>(&control))
      if (Result<void> r = checkSlider(panel, *slider); !r) return r;
  }
  const Result<CustomLayer> layer = newLayer(panel, "");
  if (!layer)
    return panelError(panel, "is for the kind '" + panel.kind + "', which cannot be a plugin's own");
  return {};
}

Result<CustomLayer> newLayer(const Panel& panel, const std::string& source) {
  std::string json = R"({"kind":)" + textOf(panel.kind) + R"(,"version":)" + std::to_string(panel.version) +
                     R"(,"source":)" + textOf(source);
  for (const PanelControl& control : panel.controls)
    if (!std::holds_alternative<PanelLabel>(control))
      json += "," + textOf(keyOf(control)) + ":" + textOf(initialOf(control));
  return customLayer(json + "}");
}

Result<PanelValue> panelValue(const CustomLayer& layer, const PanelControl& control) {
  try {
    return valueIn(parseJson(layer.json), control);
  } catch (const JsonFault& fault) {
    return makeError(ErrorCode::SceneInvalid, fault.sentence, fault.path);
  } catch (const std::exception&) {
    return errorFromCurrentException("panel");
  }
}

Result<CustomLayer> withPanelValue(const CustomLayer& layer, const PanelControl& control,
                                   const PanelValue& value) {
  const std::string& key = keyOf(control);
  if (key.empty()) return layer;
  if (const std::string fault = faultOf(control, value); !fault.empty())
    return makeError(ErrorCode::SceneInvalid, "The value " + fault + ".", "/" + key);
  return customLayer(withMember(layer.json, key, textOf(value)));
}

}  // namespace vernier
