// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "Cli.h"
#include "Version.h"
#include "vernier/study/Limits.h"

namespace vernier::app {
namespace {
using Json = nlohmann::ordered_json;

Json facts(Session& session, const Settings& settings) {
  const Capabilities& c = session.capabilities(true);
  Json j;
  j["schema"] = "vernier-doctor/1";
  j["vernier"] = kVersion;
  j["purpose"] = "not for primary diagnosis";
  j["native"] = {{"available", c.native}, {"simd", c.simd}, {"threads", c.threads}};
  j["gl"] = {{"available", c.gl},          {"why_not", c.glWhyNot},      {"renderer", c.glRenderer},
             {"version", c.glVersion},     {"software", c.glIsSoftware}, {"max_3d_texture", c.max3dTexture},
             {"max_texture", c.maxTexture}};
  j["memory_budget_mb"] = session.budget().limit() >> 20;
  j["limits"] = {{"rows", limits::kMaxRows},
                 {"columns", limits::kMaxColumns},
                 {"frames", limits::kMaxFrames},
                 {"decoded_frame_mb", limits::kMaxDecodedFrameBytes >> 20},
                 {"element_without_pixels_mb", limits::kMaxNonPixelElementBytes >> 20},
                 {"sequence_depth", limits::kMaxSequenceDepth},
                 {"files_per_study", limits::kMaxFilesPerStudy},
                 {"inflate_ratio", limits::kMaxInflateRatio},
                 {"inflated_mb", limits::kMaxInflatedBytes >> 20},
                 {"fragments", limits::kMaxFragments}};
  for (const Setting& s : settings.sources)
    j["settings"][s.name] = {{"value", s.value}, {"source", s.source}};
  j["plugins"] = Json::array();
  for (const PluginInfo& p : session.plugins())
    j["plugins"].push_back({{"name", p.name}, {"state", nameOf(p.state)}, {"reason", p.reason}});
  return j;
}

void print(const Json& j) {
  const auto text = [](const Json& v) { return v.is_string() ? v.get<std::string>() : v.dump(); };
  std::printf("vernier %s (not for primary diagnosis)\n\n", text(j["vernier"]).c_str());
  std::printf("Slices without a graphics card   yes: %s, %s threads\n", text(j["native"]["simd"]).c_str(),
              text(j["native"]["threads"]).c_str());
  if (j["gl"]["available"].get<bool>())
    std::printf("OpenGL                           yes: %s, %s%s\n", text(j["gl"]["version"]).c_str(),
                text(j["gl"]["renderer"]).c_str(), j["gl"]["software"].get<bool>() ? " (software)" : "");
  else
    std::printf("OpenGL                           no: %s\n", text(j["gl"]["why_not"]).c_str());
  std::printf("Memory for volumes               %s MiB\n", text(j["memory_budget_mb"]).c_str());
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
  CLI::App* sub = app.add_subcommand("doctor", "What will run here and why; settings, limits, plugins");
  sub->add_flag("--json", *json, "JSON on standard output");
  sub->footer("Example:\n  vernier doctor");
  return {sub, [&global, json] { return run(global, *json); }};
}

}  // namespace vernier::app
