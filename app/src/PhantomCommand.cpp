// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdio>

#include "Cli.h"
#include "vernier/phantoms/Phantoms.h"

namespace vernier::app {
namespace {
struct Options {
  std::string name, out, format = "dicom";
  std::vector<std::string> settings;
};

void list() {
  for (const PhantomRecipe& r : phantomRecipes()) {
    std::printf("%-16s %s\n", r.name.c_str(), r.summary.c_str());
    for (const PhantomSetting& s : r.settings)
      std::printf("                 --set %s=%s  %s\n", s.name.c_str(), s.defaultValue.c_str(),
                  s.about.c_str());
  }
}

int run(const GlobalOptions& global, const Options& o) {
  if (o.name == "list") {
    list();
    return 0;
  }
  if (o.out.empty())
    return report(makeError(ErrorCode::OptionInvalid, "Say where the study goes with --out DIR.", "--out"));
  const auto session = makeSession(global);  // for the thread count
  if (!session) return 2;
  PhantomOptions options;
  options.format = o.format == "mha" ? PhantomFormat::MetaImage : PhantomFormat::Dicom;
  options.stop = interruptToken();
  for (const std::string& s : o.settings) {
    const std::size_t eq = s.find('=');
    if (eq == std::string::npos)
      return report(makeError(ErrorCode::OptionInvalid, "'" + s + "' is not NAME=VALUE.", "--set"));
    options.settings[s.substr(0, eq)] = s.substr(eq + 1);
  }
  const Result<PhantomInfo> written = writePhantom(o.name, o.out, options, terminalProgress(global));
  if (!written) return report(written.error());
  std::printf("%s: %llu files, %.1f MB; answers in %s\n", written->data.c_str(),
              static_cast<unsigned long long>(written->files), static_cast<double>(written->bytes) / 1e6,
              written->answers.c_str());
  return 0;
}
}  // namespace

Command addPhantom(CLI::App& app, GlobalOptions& global) {
  const auto o = std::make_shared<Options>();
  CLI::App* sub = app.add_subcommand("phantom", "Write a synthetic study whose exact answers are known");
  sub->add_option("NAME", o->name, "Recipe, or `list`")->required();
  sub->add_option("--out", o->out,
                  "Folder; the study is written to DIR/NAME, its answers to DIR/NAME.answers.json");
  sub->add_option("--format", o->format, "dicom, or mha for a MetaImage file")
      ->check(CLI::IsMember({"dicom", "mha"}));
  sub->add_option("--set", o->settings, "NAME=VALUE, a setting of the recipe (repeatable)");
  sub->footer(
      "Examples:\n  vernier phantom list\n  vernier phantom ct-head --out studies\n"
      "  vernier phantom orientation --set plane=sagittal --out studies");
  return {sub, [&global, o] { return run(global, *o); }};
}

}  // namespace vernier::app
