// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "Cli.h"

namespace vernier::app {
namespace {
int run(const GlobalOptions& global, bool json) {
  const auto session = makeSession(global);
  if (!session) return 2;
  if (json) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const PluginInfo& p : session->plugins())
      list.push_back({{"name", p.name},
                      {"version", p.version},
                      {"state", nameOf(p.state)},
                      {"reason", p.reason},
                      {"kinds", p.kinds},
                      {"views", p.views},
                      {"techniques", p.techniques}});
    std::cout << nlohmann::ordered_json{{"schema", "vernier-plugins/1"}, {"plugins", list}}.dump(2) << "\n";
    return 0;
  }
  if (session->plugins().empty()) std::printf("No plugin was found; slices need the plugin mpr.\n");
  for (const PluginInfo& p : session->plugins()) {
    std::printf("%-14s %-8s %s\n", p.name.c_str(), p.version.c_str(), nameOf(p.state));
    if (!p.reason.empty()) std::printf("               %s\n", p.reason.c_str());
    if (!p.description.empty()) std::printf("               %s\n", p.description.c_str());
    for (const std::string& t : p.techniques) std::printf("               technique %s\n", t.c_str());
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
