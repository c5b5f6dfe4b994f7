// SPDX-License-Identifier: GPL-3.0-or-later
// vernier render: one picture as PNG, its report, its plan.
#include <openssl/sha.h>

#include <iostream>

#include "Annotations.h"
#include "Clock.h"
#include "OptionChecks.h"
#include "Report.h"
#include "vernier/picture/Png.h"
#include "vernier/picture/Quantise.h"
#include "vernier/picture/WriteFile.h"

namespace vernier::app {
namespace {

struct Options {
  ViewOptions view;
  std::string out, report;
  bool explain = false, noLetters = false;
  double scale = 1;
};

std::string sha256(const std::vector<std::uint8_t>& bytes) {
  unsigned char digest[SHA256_DIGEST_LENGTH];
  SHA256(bytes.data(), bytes.size(), digest);
  std::string hex;
  for (unsigned char d : digest) {
    hex += "0123456789abcdef"[d >> 4];
    hex += "0123456789abcdef"[d & 15];
  }
  return hex;
}

int run(const GlobalOptions& global, const Options& o) {
  const Result<Settings> settings = readSettings(global.flags);
  if (!settings) return report(settings.error());
  const auto session = makeSession(global);
  if (!session) return 2;
  const std::stop_token stop = interruptToken();
  const auto begin = Clock::now();
  if (const Result<void> r = session->open(o.view.inputs, terminalProgress(global), stop); !r)
    return report(r.error());
  const auto keepAllSources = [&]() -> Result<void> {
    for (const auto& [file, option] : {std::pair{o.out, "--out"}, std::pair{o.report, "--report"}})
      if (const Result<void> r = keepSources(session.get(), o.view.inputs, file, option); !r) return r;
    return {};
  };
  if (const Result<void> r = keepAllSources(); !r) return report(r.error());
  Result<RenderRequest> request = makeRequest(*session, o.view, *settings, terminalProgress(global), stop);
  if (!request) return report(request.error());
  if (const Result<void> r = keepAllSources(); !r) return report(r.error());  // the scene's surfaces too
  request->options.explain = o.explain;
  ReportInput in;
  in.timing.load_ms = msSince(begin);

  const auto frameBegin = Clock::now();
  Result<Rendered> rendered =
      session->render(request->scene, request->view, request->quality, request->options, stop);
  if (!rendered) return report(rendered.error());
  in.timing.first_frame_ms = msSince(frameBegin);
  in.timing.frame_ms = {rendered->frame.render_ms};
  if (o.explain) std::cout << dumpPlan(rendered->plan) << std::flush;

  if (!o.out.empty()) {
    Result<Picture> picture = o.noLetters ? Result<Picture>(quantise(rendered->frame.images))
                                          : finishedPicture(*session, request->scene, request->view,
                                                            *rendered, o.view.maxError, o.scale);
    if (!picture) return report(picture.error());
    if (const Result<void> r = writePng(o.out, *picture, pngTexts(request->scene, *rendered)); !r)
      return report(r.error());
  }
  if (!o.report.empty()) {
    in.session = session.get();
    in.request = &*request;
    in.rendered = &*rendered;
    in.imageSha256 = sha256(quantise(rendered->frame.images).pixels);
    const std::string json = reportJson(in);
    if (const Result<void> r = writeFileWhole(o.report, json); !r) return report(r.error());
  }
  if (showsNothing(rendered->frame.images)) std::cerr << "vernier: note: " << kNoDataHere << "\n";
  for (const std::string& note : rendered->plan.notes) std::cerr << "vernier: note: " << note << "\n";
  if (o.view.maxError && !rendered->goalReached)
    return report(makeError(ErrorCode::OutOfTolerance,
                            "The error asked for was not met (" + rendered->goalNote + " of 255).",
                            "--max-error"));
  return 0;
}
}  // namespace

Command addRender(CLI::App& app, GlobalOptions& global) {
  const auto o = std::make_shared<Options>();
  CLI::App* sub = app.add_subcommand("render", "Draw one picture, with its measured error");
  addViewOptions(*sub, o->view);
  sub->add_option("--out", o->out, "Picture, PNG");
  sub->add_option("--report", o->report, "What was drawn, how, how long it took and how exact it is, JSON");
  sub->add_flag("--explain", o->explain, "Print the plan: passes, resources, and what was rejected and why");
  sub->add_flag("--no-letters", o->noLetters, "Only the image, without letters, scale and text");
  sub->add_option("--scale", o->scale, "Size of the letters, 1 to 3")->check(finiteFrom(1, 3));
  sub->footer(
      "Examples:\n"
      "  vernier render STUDY --view stack --slice 12 --out slice.png\n"
      "  vernier render STUDY --view axial --preset brain --out axial.png --report axial.json\n"
      "  vernier render STUDY --view stack --presentation 1 --out as-intended.png\n"
      "  vernier render STUDY --view slab --slab 10 --slab-mode max --quality reference --out mip.png\n"
      "  vernier render STUDY --view oblique --plane point=0,0,0,normal=1,0,1,up=0,0,1 --explain\n"
      "  vernier render STUDY --view oblique --plane from=-40,10,0,to=40,-5,20,up=0,0,1 --out plane.png\n"
      "  vernier render STUDY --view curved --path \"-38,-30,-85;0,-81,-85;38,-30,-85\" --width 60 --out "
      "arch.png\n"
      "  vernier render head.mhd --view coronal --engine gl --out coronal.png\n"
      "  vernier render study.zip --series T1.nii.gz --view axial --out t1.png\n"
      "  vernier render head.vrp --z-span 128 --view oblique --out head.png\n"
      "  vernier render screw.stl --camera azimuth=30,elevation=20 --out screw.png\n"
      "  vernier render STUDY --view axial --surface screw.stl --out outline.png\n"
      "  vernier render STUDY --view mip --lens sphere:10,-40,-85,30 --lens-inner ct-bone --out lens.png\n"
      "  vernier render STUDY --view axial --lens box:0,-60,-85,40,40,40 --lens-inner bone --out bone.png");
  return {sub, [&global, o] { return run(global, *o); }};
}

}  // namespace vernier::app
