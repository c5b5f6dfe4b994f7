// SPDX-License-Identifier: GPL-3.0-or-later
// vernier compare: how far two pictures, stacks or reports are apart.
#include <cmath>
#include <filesystem>

#include "Compare.h"
#include "OptionChecks.h"
#include "OptionText.h"
#include "vernier/volume/PictureFile.h"

namespace vernier::app {
namespace {

int run(const GlobalOptions& global, const CompareOptions& o) {
  for (const auto& [file, option] : {std::pair{o.heatmap, "--heatmap"}, std::pair{o.out, "--out"}})
    if (const Result<void> r = keepSources(nullptr, {o.a, o.b}, file, option); !r) return report(r.error());
  if (o.mode.empty() != o.out.empty())
    return report(invalid(o.mode.empty() ? "--mode" : "--out",
                          "A picture of both needs --mode and a file for it, --out FILE.png."));
  const bool pictures = looksLikePicture(o.a) || looksLikePicture(o.b);
  const bool reports = isReport(o.a) && isReport(o.b);
  if ((pictures || reports) && (!o.offset.empty() || !o.seriesA.empty() || !o.seriesB.empty()))
    return report(invalid(!o.offset.empty() ? "--offset" : "--series-a", "It goes with two stacks."));
  if (pictures) return comparePictureFiles(o);
  if (reports) return compareReports(o);
  return compareStacks(global, o);
}
}  // namespace

nlohmann::ordered_json jsonNumber(double x) {
  if (std::isfinite(x)) return x;
  return std::isnan(x) ? "not a number" : x > 0 ? "infinite" : "minus infinite";
}

int judgeMaxError(const CompareOptions& o, double error, const std::string& unit) {
  if (!o.maxError || error <= *o.maxError) return 0;
  return report(makeError(
      ErrorCode::OutOfTolerance,
      "The difference is " + nlohmann::ordered_json(error).dump() + " " + unit + ", more than was asked for.",
      "--max-error"));
}

Command addCompare(CLI::App& app, GlobalOptions& global) {
  const auto o = std::make_shared<CompareOptions>();
  CLI::App* sub = app.add_subcommand("compare", "How far two pictures, stacks or reports are apart");
  sub->add_option("A", o->a, "Picture (PNG, TIFF, SGI), study or volume file, or report of `vernier render`")
      ->required();
  sub->add_option("B", o->b, "Another of the same kind")->required();
  sub->add_option("--heatmap", o->heatmap, "Pictures: write the differences as a picture, PNG");
  sub->add_option(
         "--mode", o->mode,
         "Pictures: both as one, wipe, checkerboard or difference (B brighter: orange, darker: blue)")
      ->check(CLI::IsMember({"wipe", "checkerboard", "difference"}));
  sub->add_option("--out", o->out, "Picture of --mode, PNG");
  sub->add_option("--wipe", o->wipe, "Place of the wipe, 0 to 1")->check(finiteFrom(0, 1));
  sub->add_option("--tile", o->tile_px, "Squares of the checkerboard, px")->check(CLI::Range(1, 4096));
  sub->add_flag(
      "--align", o->align,
      "Pictures: find how B lies on A (turn and shift), state what is left, and lay B so in --mode; the "
      "figures stay those of the pictures as they are");
  sub->add_option("--series-a", o->seriesA, "Stacks: series of A, as --series of render");
  sub->add_option("--series-b", o->seriesB, "Stacks: series of B");
  sub->add_option("--offset", o->offset, "Stacks: x,y,z in mm from A to B, where frames of reference differ");
  sub->add_flag("--json", o->json, "JSON on standard output");
  sub->add_option(
         "--max-error", o->maxError,
         "Exit 4 when any pixel (level) or voxel (unit) differs by more, or the error bound of either report "
         "is larger")
      ->check(finiteFrom(0, 1e9));
  sub->footer(
      "Examples:\n  vernier compare before.png after.png --heatmap diff.png --max-error 1\n"
      "  vernier compare before.png after.png --align --mode checkerboard --out both.png\n"
      "  vernier compare first-study second-study --series-a 2 --series-b 3 --json\n"
      "  vernier compare head.mhd denoised.mhd --offset 0,0,0\n"
      "  vernier compare native.json gl.json");
  return {sub, [&global, o] { return run(global, *o); }};
}

}  // namespace vernier::app
