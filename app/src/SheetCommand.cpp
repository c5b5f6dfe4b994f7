// SPDX-License-Identifier: GPL-3.0-or-later
// vernier sheet: the slices of a study on one picture, with time and measured error under each.
#include <cstdio>
#include <iostream>
#include <utility>

#include "Annotations.h"
#include "OptionChecks.h"
#include "OptionText.h"
#include "Report.h"
#include "vernier/picture/ContactSheet.h"
#include "vernier/picture/Png.h"

namespace vernier::app {
namespace {

constexpr int kLeastCell_px = 320, kLargestCell_px = 512;  // the captions need some room

struct Options {
  ViewOptions view;
  std::string out, title = "Vernier";
  std::vector<std::string> views{"stack", "axial", "coronal", "sagittal", "oblique", "slab"};
  int columns = 3;
};

std::string shortNumber(double x) {
  char text[32];
  std::snprintf(text, sizeof text, x >= 10 ? "%.0f" : "%.2g", x);
  return text;
}

// The median of a few frames: the first one also fills caches.
Result<double> frame_ms(Session& session, const RenderRequest& r, double step, std::stop_token stop) {
  Quality quality = r.quality;
  quality.step = step;
  RenderOptions options = r.options;
  options.measure = false;
  std::vector<double> ms;
  Frame buffers;
  for (int i = 0; i < 7; ++i) {
    Result<Rendered> again = session.render(r.scene, r.view, quality, options, stop, std::move(buffers));
    if (!again) return again.error();
    ms.push_back(again->frame.render_ms);
    buffers = std::move(again->frame);
  }
  return median(ms);
}

bool rendersVolume(const std::string& view) {
  return view.starts_with("dvr") || view == "iso" || view == "lens";
}

// Of the options of looks through a volume each view takes its own.
void keepOwn(const std::string& view, ViewOptions& o) {
  const VolumeOptions given = std::exchange(o.volume, {});
  if (view.starts_with("shells")) {
    o.volume = given;
    o.volume.cue.reset(), o.volume.gain_perMm.reset();
  }
  if (view == "mip") o.volume.cue = given.cue;
  if (view == "sum" || view == "attenuation") o.volume.gain_perMm = given.gain_perMm;
  RenderingOptions rendering = std::exchange(o.rendering, {});
  if (view == "iso") {
    o.rendering.iso = rendering.iso, o.rendering.combiner = rendering.combiner;
    o.rendering.lights = rendering.lights;
  } else if (rendersVolume(view)) {
    o.rendering = rendering;
    o.rendering.iso.reset();
    if (view == "dvr") o.rendering.lights.clear(), o.rendering.shading.clear();
  }
}

// One word after a view's colon; false: it has no meaning there.
bool applyWord(const std::string& view, const std::string& word, ViewOptions& o) {
  if (word == "nearest" || word == "linear" || word == "cubic") {
    o.interpolation = word;
  } else if (word == "cued" && view == "mip") {
    o.volume.cue = 0.6;
  } else if (word == "cued" && view.starts_with("shells")) {
    o.volume.a = 0.6, o.volume.b = 0.4;
  } else if (rendersVolume(view) && word.find('.') != std::string::npos) {
    o.technique = word;
  } else if (rendersVolume(view) && (word == "x1" || word == "x2" || word == "x4" || word == "x8")) {
    o.quality = "draft", o.step = 1.0 / (word[1] - '0');
  } else if (view == "dvr-shaded" && (word == "global-ambient" || word == "colour-per-voxel")) {
    o.rendering.shading = word;
  } else if ((view == "dvr-shaded" || view == "iso") && word == "two-lights") {
    o.rendering.lights = {"-1,-1,0.5", "1,-0.2,0.3,0.25,0.45,1"};  // a white one and a blue one
  } else {
    return false;
  }
  return true;
}

// "oblique:cubic" is the view oblique with cubic interpolation, "mip:cued" a depth-cued maximum,
// "dvr:dvr.stacks+x2" a technique at half the step.
Result<ViewOptions> optionsFor(const Options& o, const std::string& name) {
  ViewOptions one = o.view;
  const std::size_t colon = name.find(':');
  const std::string view = one.view = name.substr(0, colon);
  keepOwn(view, one);
  if (colon != std::string::npos)
    for (const std::string& word : split(name.substr(colon + 1), '+'))
      if (!applyWord(view, word, one))
        return makeError(
            ErrorCode::OptionInvalid,
            "'" + name +
                "' is no view; after the colon stands nearest, linear or cubic; of mip and shells "
                "cued; of dvr, dvr-shaded and iso a technique, x1 to x8, two-lights or a shading.",
            "--views");
  const bool free =
      view == "oblique" || view == "slab";  // each option goes to the views that have a use for it
  if (free || view == "curved") one.slice.reset();
  if (!free) one.plane.clear();
  if (view != "slab") one.slab_mm.reset(), one.slabMode.clear();
  if (view != "curved") one.path.clear(), one.form.clear(), one.pathUp.clear(), one.width_mm.reset();
  if (view == "stack" || view == "curved") one.lens = {};
  if (view == "stack" && one.interpolation == "cubic") one.interpolation.clear();
  return one;
}

Result<SheetEntry> entryFor(Session& session, const Options& o, const Settings& settings,
                            const std::string& view, const ProgressFn& progress, std::stop_token stop) {
  const Result<ViewOptions> options = optionsFor(o, view);
  if (!options) return options.error();
  const ViewOptions& one = *options;
  const Result<RenderRequest> request = makeRequest(session, one, settings, progress, stop);
  if (!request) return request.error();
  const Result<Rendered> rendered =
      session.render(request->scene, request->view, request->quality, request->options, stop);
  if (!rendered) return rendered.error();
  const Result<double> ms = frame_ms(session, *request, rendered->step, stop);
  if (!ms) return ms.error();
  Result<Picture> picture =
      finishedPicture(session, request->scene, request->view, *rendered, o.view.maxError, 1.0);
  if (!picture) return picture.error();
  SheetEntry entry;
  entry.picture = std::move(*picture);
  entry.caption = view;
  entry.lines = {shortNumber(*ms) + " ms, " + rendered->frame.technique};
  if (rendered->error && rendered->error->bound) {
    const quality::ErrorReport& e = *rendered->error;
    entry.lines.push_back(errorLine(*e.bound, 99).text + ", max " +
                          (e.max < 0.01 ? "< 0.01" : shortNumber(e.max)));
  }
  if (!rendered->goalNote.empty()) entry.lines.push_back(rendered->goalNote);
  return entry;
}

int run(const GlobalOptions& global, const Options& o) {
  if (!o.view.view.empty() || !o.view.sceneFile.empty())
    return report(makeError(ErrorCode::OptionInvalid, "A sheet shows several views; name them with --views.",
                            o.view.view.empty() ? "--scene" : "--view"));
  const Result<Settings> settings = readSettings(global.flags);
  if (!settings) return report(settings.error());
  const auto session = makeSession(global);
  if (!session) return 2;
  const std::stop_token stop = interruptToken();
  if (const Result<void> r = session->open(o.view.inputs, terminalProgress(global), stop); !r)
    return report(r.error());
  if (const Result<void> r = keepSources(session.get(), o.view.inputs, o.out, "--out"); !r)
    return report(r.error());
  std::vector<SheetEntry> entries;
  std::optional<Error> last;
  for (const std::string& view : o.views) {
    Result<SheetEntry> entry = entryFor(*session, o, *settings, view, terminalProgress(global), stop);
    if (entry) {
      std::cout << view;
      for (const std::string& line : entry->lines) std::cout << "  " << line;
      std::cout << "\n";
      entries.push_back(std::move(*entry));
    } else {  // one view that cannot be shown (2-D only, say) does not lose the others
      if (!last || last->text() != entry.error().text()) (void)report(entry.error());
      last = entry.error();
    }
  }
  if (entries.empty()) return last ? exitCode(last->code) : 1;
  int cell_px = kLeastCell_px;  // pictures as they are, up to a size at which three stand side by side
  for (const SheetEntry& e : entries) cell_px = std::max({cell_px, e.picture.width, e.picture.height});
  const Result<Picture> sheet = contactSheet(o.title, entries, o.columns, std::min(cell_px, kLargestCell_px));
  if (!sheet) return report(sheet.error());
  if (const Result<void> r = writePng(o.out, *sheet); !r) return report(r.error());
  return 0;
}
}  // namespace

Command addSheet(CLI::App& app, GlobalOptions& global) {
  const auto o = std::make_shared<Options>();
  CLI::App* sub =
      app.add_subcommand("sheet", "A contact sheet of a study's slices, with time and error under each");
  addViewOptions(*sub, o->view);
  sub->add_option("--out", o->out, "Contact sheet, PNG")->required();
  sub->add_option("--title", o->title, "Title of the sheet");
  sub->add_option("--views", o->views,
                  "Views, in order; oblique:cubic for another interpolation, mip:cued for a depth cue, "
                  "dvr:TECHNIQUE+x2 for a technique at half the step, iso:two-lights")
      ->delimiter(',');
  sub->add_option("--columns", o->columns, "Pictures in a row")->check(CLI::Range(1, 20));
  sub->footer(
      "Examples:\n"
      "  vernier sheet STUDY --out sheet.png --preset brain\n"
      "  vernier sheet STUDY --out sheet.png --views axial,oblique,oblique:cubic,curved --path "
      "\"0,0,-40;9,2,0;0,5,40\"\n"
      "  vernier sheet STUDY --out looks.png --views mip,mip:cued,shells,shells-sum,sum --surface screw.stl\n"
      "  vernier sheet STUDY --out dvr.png --views dvr,dvr-shaded,iso:two-lights,dvr:dvr.native+x2");
  return {sub, [&global, o] { return run(global, *o); }};
}

}  // namespace vernier::app
