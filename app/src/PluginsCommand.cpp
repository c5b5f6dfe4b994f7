// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>

#include "Cli.h"

namespace vernier::app {
namespace {
using Json = nlohmann::ordered_json;

Json controlJson(const PanelControl& control) {
  Json j{{"type", typeOf(control)}};
  if (const auto* label = std::get_if<PanelLabel>(&control)) j["text"] = label->text;
  if (const auto* s = std::get_if<PanelSlider>(&control))
    j.update({{"key", s->key},
              {"label", s->label},
              {"unit", s->unit},
              {"least", s->least},
              {"most", s->most},
              {"step", s->step},
              {"initial", s->initial}});
  if (const auto* c = std::get_if<PanelCheckbox>(&control))
    j.update({{"key", c->key}, {"label", c->label}, {"initial", c->initial}});
  if (const auto* t = std::get_if<PanelText>(&control))
    j.update({{"key", t->key}, {"label", t->label}, {"initial", t->initial}});
  return j;
}

Json panelJson(const Panel& panel) {
  Json controls = Json::array();
  for (const PanelControl& c : panel.controls) controls.push_back(controlJson(c));
  return {{"title", panel.title}, {"kind", panel.kind}, {"controls", controls}};
}

// Data files that a plugin brings: its sub-folders, each with the names of its JSON files, sorted.
std::map<std::string, std::vector<std::string>> dataOf(const PluginInfo& plugin) {
  namespace fs = std::filesystem;
  std::map<std::string, std::vector<std::string>> data;
  std::error_code ec;
  for (fs::directory_iterator it(plugin.folder, ec), end; !ec && it != end; it.increment(ec)) {
    std::error_code inner;
    std::vector<std::string> names;
    for (fs::directory_iterator file(it->path(), inner), last; !inner && file != last; file.increment(inner))
      if (file->path().extension() == ".json") names.push_back(file->path().stem().string());
    std::sort(names.begin(), names.end());
    if (!names.empty()) data[it->path().filename().string()] = std::move(names);
  }
  return data;
}

int run(const GlobalOptions& global, bool json) {
  const auto session = makeSession(global);
  if (!session) return 2;
  if (json) {
    Json list = Json::array();
    for (const PluginInfo& p : session->plugins()) {
      Json panels = Json::array();
      for (const Panel& panel : p.panels) panels.push_back(panelJson(panel));
      list.push_back({{"name", p.name},
                      {"version", p.version},
                      {"state", nameOf(p.state)},
                      {"reason", p.reason},
                      {"kinds", p.kinds},
                      {"views", p.views},
                      {"techniques", p.techniques},
                      {"data", dataOf(p)},
                      {"panels", panels}});
    }
    std::cout << Json{{"schema", "vernier-plugins/1"}, {"plugins", list}}.dump(2) << "\n";
    return 0;
  }
  if (session->plugins().empty()) std::printf("No plugin was found; slices need the plugin mpr.\n");
  for (const PluginInfo& p : session->plugins()) {
    std::printf("%-14s %-8s %s\n", p.name.c_str(), p.version.c_str(), nameOf(p.state));
    if (!p.reason.empty()) std::printf("               %s\n", p.reason.c_str());
    if (!p.description.empty()) std::printf("               %s\n", p.description.c_str());
    for (const std::string& t : p.techniques) std::printf("               technique %s\n", t.c_str());
    for (const auto& [folder, names] : dataOf(p)) {
      std::printf("               %s", folder.c_str());
      for (const std::string& n : names) std::printf(" %s", n.c_str());
      std::printf("\n");
    }
    for (const Panel& panel : p.panels)
      std::printf("               panel \"%s\" for layers of kind %s\n", panel.title.c_str(),
                  panel.kind.c_str());
  }
  return 0;
}
}  // namespace

Command addPlugins(CLI::App& app, GlobalOptions& global) {
  const auto json = std::make_shared<bool>(false);
  CLI::App* sub = app.add_subcommand("plugins", "Plugins: loaded, or refused and why");
  sub->add_flag("--json", *json, "JSON on standard output");
  sub->footer("Example:\n  vernier plugins --plugins my/plugins");
  return {sub, [&global, json] { return run(global, *json); }};
}

}  // namespace vernier::app
