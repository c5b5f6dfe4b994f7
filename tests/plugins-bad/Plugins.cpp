// SPDX-License-Identifier: GPL-3.0-or-later
// One source, several plugins: which one is said by a definition of the build.
#include <stdexcept>

#include "vernier/plan/Plugin.h"

namespace {

vernier::Technique technique(const std::string& name) {
  vernier::Technique t;
  t.name = name;
  t.kinds = {"test-kind"};
  t.passesFor = [name](const vernier::Layer&, std::size_t,
                       const vernier::PlanContext&) -> vernier::Result<std::vector<vernier::Pass>> {
    vernier::Pass p;
    p.name = "test";
    p.technique = name;
    return std::vector<vernier::Pass>{p};
  };
  t.execute = [](const vernier::Pass&, vernier::Images&, std::stop_token) -> vernier::Result<void> {
#ifdef PLUGIN_THROWS_AT_WORK
    throw std::runtime_error("a bad day");
#else
    return {};
#endif
  };
  return t;
}

[[maybe_unused]] vernier::Panel panel() {
  vernier::Panel p;
  p.title = "A panel";
  p.kind = "test-kind";
  p.controls = {vernier::PanelCheckbox{"on", "On", true}};
#ifdef PLUGIN_BAD_PANEL
  p.controls.push_back(vernier::PanelText{"on", "The same key again", ""});
#endif
  return p;
}

[[maybe_unused]] vernier::Result<void> registerIt(vernier::Host& host) {
#if defined(PLUGIN_SECOND)
  if (auto r = host.addTechnique(technique("second.own")); !r) return r;
  return host.addTechnique(technique("good.technique"));  // the good plugin has this one
#else
  if (auto r = host.addTechnique(technique(std::string(PLUGIN_NAME) + ".technique")); !r) return r;
#if defined(PLUGIN_PANEL) || defined(PLUGIN_BAD_PANEL) || defined(PLUGIN_SAME_PANEL)
  return host.addPanel(panel());
#elif defined(PLUGIN_THROWING)
  throw std::runtime_error("thrown while registering");
#elif defined(PLUGIN_FAILING)
  return vernier::makeError(vernier::ErrorCode::GlUnavailable, "No graphics here.");
#else
  return {};
#endif
#endif
}

}  // namespace

#if defined(PLUGIN_NO_ENTRIES)
extern "C" VERNIER_API int somethingElse() { return 1; }
#elif defined(PLUGIN_OTHER_ABI) || defined(PLUGIN_OTHER_INTERFACE)
#ifdef PLUGIN_OTHER_ABI
extern "C" VERNIER_API const char* vernier_plugin_abi() { return "built elsewhere"; }
extern "C" VERNIER_API const char* vernier_plugin_interface() { return vernier::kPluginInterface; }
#else
extern "C" VERNIER_API const char* vernier_plugin_abi() { return VERNIER_ABI_ID; }
extern "C" VERNIER_API const char* vernier_plugin_interface() { return "vernier.technique/0"; }
#endif
// Must never be reached.
extern "C" VERNIER_API bool vernier_plugin_register(vernier::Host*, vernier::Error*) { std::abort(); }
#else
VERNIER_PLUGIN(registerIt)
#endif
