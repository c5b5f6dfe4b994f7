// SPDX-License-Identifier: GPL-3.0-or-later
// What will run on this machine and why; every sentence comes from where the work itself is refused.
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "Cli.h"
#include "UiLibrary.h"
#include "Version.h"
#include "WindowCheck.h"
#include "vernier/study/Limits.h"

namespace vernier::app {
namespace {
using Json = nlohmann::ordered_json;

Json windowFacts() {
  const Result<WindowFacts> window = checkWindow();
  if (!window) return {{"available", false}, {"why_not", window.error().sentence}};
  if (const Result<void> library = checkUiLibrary(); !library)
    return {{"available", false}, {"why_not", library.error().sentence}};
  return {{"available", true},
          {"why_not", ""},
          {"display", window->display},
          {"version", window->version},
          {"renderer", window->renderer},
          {"software", window->software},
          {"scale", window->scale}};
}

Json glFacts(const Capabilities& c) {
  return {{"available", c.gl},          {"why_not", c.glWhyNot},      {"renderer", c.glRenderer},
          {"version", c.glVersion},     {"software", c.glIsSoftware}, {"max_3d_texture", c.max3dTexture},
          {"max_texture", c.maxTexture}};
}

Json limitFacts() {
  Json j;
  for (const limits::Limit& l : limits::kAll)
    j[std::string(l.name) + (*l.unit ? std::string("_") + l.unit : "")] = l.value;
  return j;
}

Json settingFacts(const Settings& settings) {
  Json j;
  for (const Setting& s : settings.sources) j[s.name] = {{"value", s.value}, {"source", s.source}};
  return j;
}

Json pluginFacts(const Session& session) {
  Json list = Json::array();
  for (const PluginInfo& p : session.plugins())
    list.push_back(
        {{"name", p.name}, {"version", p.version}, {"state", nameOf(p.state)}, {"reason", p.reason}});
  return list;
}

Json facts(Session& session, const Settings& settings) {
  const Capabilities& c = session.capabilities(true);
  const Result<void> folder = checkSettingsFolder();
  Json j;
  j["schema"] = "vernier-doctor/1";
  j["vernier"] = kVersion;
  j["purpose"] = "not for primary diagnosis";
  j["native"] = {{"available", c.native}, {"simd", c.simd}, {"threads", c.threads}};
  j["gl"] = glFacts(c);
  j["window"] = windowFacts();
  j["memory_budget_mb"] = session.budget().limit() >> 20;
  j["settings"] = settingFacts(settings);
  j["settings_folder"] = {{"writable", folder.ok()}, {"why_not", folder ? "" : folder.error().sentence}};
  j["limits"] = limitFacts();
  j["plugins"] = pluginFacts(session);
  return j;
}

std::string text(const Json& v) { return v.is_string() ? v.get<std::string>() : v.dump(); }

void printOpenGl(const char* what, const Json& j) {
  if (j["available"].get<bool>())
    std::printf("%-32s yes: OpenGL %s, %s%s\n", what, text(j["version"]).c_str(), text(j["renderer"]).c_str(),
                j["software"].get<bool>() ? " (software)" : "");
  else
    std::printf("%-32s no: %s\n", what, text(j["why_not"]).c_str());
}

void print(const Json& j) {
  std::printf("vernier %s (not for primary diagnosis)\n\n", text(j["vernier"]).c_str());
  std::printf("%-32s yes: %s, %s threads\n", "Pictures without OpenGL", text(j["native"]["simd"]).c_str(),
              text(j["native"]["threads"]).c_str());
  printOpenGl("Pictures with OpenGL", j["gl"]);
  printOpenGl("A window", j["window"]);
  std::printf("%-32s %s MiB\n", "Memory for volumes", text(j["memory_budget_mb"]).c_str());
  std::printf("%-32s %s\n", "Settings are kept",
              j["settings_folder"]["writable"].get<bool>()
                  ? "yes"
                  : ("no: " + text(j["settings_folder"]["why_not"])).c_str());
  std::printf("\nSettings (value, source)\n");
  for (const auto& [name, s] : j["settings"].items())
    std::printf("  %-30s %s (%s)\n", name.c_str(), text(s["value"]).c_str(), text(s["source"]).c_str());
  std::printf("\nLimits on what a file may ask for\n");
  for (const auto& [name, v] : j["limits"].items())
    std::printf("  %-30s %s\n", name.c_str(), text(v).c_str());
  std::printf("\nPlugins\n");
  for (const Json& p : j["plugins"])
    std::printf("  %-30s %s %s\n", text(p["name"]).c_str(), text(p["state"]).c_str(),
                text(p["reason"]).c_str());
  if (j["plugins"].empty())
    std::printf("  none: nothing can be drawn; reinstall, or name a folder with --plugins\n");
}

int run(const GlobalOptions& global, bool json) {
  const Result<Settings> settings = readSettings(global.flags);
  if (!settings) return report(settings.error());
  const auto session = makeSession(global);
  if (!session) return 2;
  const Json j = facts(*session, *settings);
  if (json)
    std::cout << j.dump(2) << "\n";
  else
    print(j);
  return 0;
}
}  // namespace

Command addDoctor(CLI::App& app, GlobalOptions& global) {
  const auto json = std::make_shared<bool>(false);
  CLI::App* sub = app.add_subcommand(
      "doctor", "What will run here and why: window, OpenGL, memory, settings, limits, plugins");
  sub->add_flag("--json", *json, "JSON on standard output");
  sub->footer("Example:\n  vernier doctor");
  return {sub, [&global, json] { return run(global, *json); }};
}

}  // namespace vernier::app
