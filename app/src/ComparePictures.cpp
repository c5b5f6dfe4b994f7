// SPDX-License-Identifier: GPL-3.0-or-later
// How far two picture files are apart, and the two of them as one picture.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <iostream>

#include "Compare.h"
#include "OptionText.h"
#include "vernier/measure/Align.h"
#include "vernier/picture/Blend.h"
#include "vernier/picture/Compare.h"
#include "vernier/picture/Png.h"
#include "vernier/volume/PictureFile.h"

namespace vernier::app {
namespace {
using Json = nlohmann::ordered_json;

// A PNG that Png.h alone reads (a palette, or one that declares another gamma, which it refuses) goes its
// way.
Result<PictureFile> load(const std::string& path) {
  Result<PictureFile> p = readPictureFile(path);
  const bool deep = p && (!p->isPng || p->type != VoxelType::U8);
  if (deep || (!p && p.error().code != ErrorCode::NotBuiltYet)) return p;
  const Result<Picture> png = readPng(path);
  if (!png) return p ? png.error() : p.error();
  if (p) return p;
  PictureFile out;
  out.width = png->width, out.height = png->height, out.channels = png->channels, out.isPng = true;
  const auto bytes = std::as_bytes(std::span(png->pixels));
  out.samples.assign(bytes.begin(), bytes.end());
  return out;
}

Result<measure::ImageView> viewOf(const PictureFile& p) {
  const bool known = p.type == VoxelType::U8 || p.type == VoxelType::U16 || p.type == VoxelType::F32;
  if (!known)
    return makeError(ErrorCode::OptionInvalid,
                     std::string("Pictures of ") + nameOf(p.type) +
                         " samples are not compared; 8 or 16 bits without sign, or floating point, are.");
  return measure::ImageView{p.width, p.height, p.channels,
                            p.type == VoxelType::U8    ? measure::SampleType::U8
                            : p.type == VoxelType::U16 ? measure::SampleType::U16
                                                       : measure::SampleType::F32,
                            p.samples};
}

// 8 bits in colour, for pictures to look at.
Result<Picture> forTheEye(const PictureFile& p) {
  if (p.type != VoxelType::U8)
    return makeError(ErrorCode::OptionInvalid,
                     "Heat maps and modes show pictures of 8 bits; these have more, and are not rounded.");
  Picture out(p.width, p.height);
  const std::size_t pixels = out.pixels.size() / 3;
  for (std::size_t i = 0; i < pixels; ++i)
    for (std::size_t c = 0; c < 3; ++c)
      out.pixels[3 * i + c] = std::to_integer<std::uint8_t>(
          p.samples[i * static_cast<std::size_t>(p.channels) + (p.channels >= 3 ? c : 0)]);
  return out;
}

Result<void> writePictures(const CompareOptions& o, const PictureFile& fa, const PictureFile& fb,
                           const std::optional<measure::Alignment>& alignment) {
  if (o.heatmap.empty() && o.mode.empty()) return {};
  const Result<Picture> a = forTheEye(fa);
  if (!a) return a.error();
  Result<Picture> b = forTheEye(fb);
  if (!b) return b.error();
  if (!o.heatmap.empty()) {
    const Result<Picture> map = heatmap(*a, *b);
    if (!map) return map.error();
    if (const Result<void> r = writePng(o.heatmap, *map); !r) return r;
  }
  if (o.mode.empty()) return {};
  if (alignment) {
    const measure::ImageView view{b->width, b->height, b->channels, measure::SampleType::U8,
                                  std::as_bytes(std::span(b->pixels))};
    Result<std::vector<std::uint8_t>> laid = measure::warpedForDisplay(view, *alignment);
    if (!laid) return laid.error();
    b->pixels = std::move(*laid);
  }
  const Result<Picture> both = o.mode == "wipe"           ? wipe(*a, *b, o.wipe)
                               : o.mode == "checkerboard" ? checkerboard(*a, *b, o.tile_px)
                                                          : signedDifference(*a, *b);
  if (!both) return both.error();
  return writePng(o.out, *both);
}

Json figures(const measure::ImageMetrics& m, const std::string& unit,
             const std::optional<measure::Alignment>& alignment) {
  Json j = {
      {"schema", "vernier-compare/1"},
      {"what", "pictures"},
      {"unit", unit},
      {"max", m.max},
      {"mean", m.mean},
      {"rmse", m.rmse},
      {"bias", m.bias},
      {"differing", m.differing},
      {"worst", {m.worstX, m.worstY}},
      {"psnr_dB", jsonNumber(m.psnr_dB)},
      {"ssim", m.ssim ? Json(*m.ssim) : Json()},
      {"ciede2000", m.ciede2000_mean ? Json{{"mean", *m.ciede2000_mean}, {"max", *m.ciede2000_max}} : Json()},
      {"unmatched", m.unmatched}};
  if (alignment)
    j["alignment"] = {{"dx_px", alignment->dx_px},
                      {"dy_px", alignment->dy_px},
                      {"rotation_deg", alignment->rotation_deg},
                      {"residual_rms", alignment->residualRms},
                      {"correlation", alignment->correlation},
                      {"overlap", alignment->overlap}};
  return j;
}

void print(const measure::ImageMetrics& m, const std::string& unit,
           const std::optional<measure::Alignment>& alignment) {
  std::printf("max %.6g, mean %.4g, RMSE %.4g %s; %.3g %% of the pixels differ; worst at %d,%d\n", m.max,
              m.mean, m.rmse, unit.c_str(), 100 * m.differing, m.worstX, m.worstY);
  std::printf("PSNR %s dB", std::isinf(m.psnr_dB)
                                ? "infinite"
                                : jsonNumber(std::round(m.psnr_dB * 100) / 100).dump().c_str());
  if (m.ssim) std::printf(", SSIM %.6g", *m.ssim);
  if (m.ciede2000_mean) std::printf(", CIEDE2000 mean %.4g, max %.4g", *m.ciede2000_mean, *m.ciede2000_max);
  std::printf("\n");
  if (alignment)
    std::printf(
        "B lies on A when moved by %.3f,%.3f px and turned by %.3f degrees; left over: RMS %.4g %s "
        "(correlation %.4f, %.0f %% overlap)\n",
        -alignment->dx_px, -alignment->dy_px, -alignment->rotation_deg, alignment->residualRms, unit.c_str(),
        alignment->correlation, 100 * alignment->overlap);
}

}  // namespace

int comparePictureFiles(const CompareOptions& o) {
  const Result<PictureFile> a = load(o.a);
  if (!a) return report(a.error());
  const Result<PictureFile> b = load(o.b);
  if (!b) return report(b.error());
  if (a->whiteIsZero != b->whiteIsZero)
    return report(makeError(ErrorCode::OptionInvalid,
                            "In one picture 0 is white, in the other black; only like can be compared."));
  const Result<measure::ImageView> va = viewOf(*a), vb = viewOf(*b);
  if (!va || !vb) return report(va ? vb.error() : va.error());
  const Result<measure::ImageMetrics> m = measure::compareImages(*va, *vb);
  if (!m) return report(m.error());
  std::optional<measure::Alignment> alignment;
  if (o.align) {
    const Result<measure::Alignment> found = measure::alignRigid(*va, *vb);
    if (!found) return report(found.error());
    alignment = *found;
  }
  if (const Result<void> r = writePictures(o, *a, *b, alignment); !r) return report(r.error());
  const std::string unit = a->type == VoxelType::U8    ? "levels of 255"
                           : a->type == VoxelType::U16 ? "levels of 65535"
                                                       : "(values)";
  if (o.json)
    std::cout << figures(*m,
                         a->type == VoxelType::U8    ? "level/255"
                         : a->type == VoxelType::U16 ? "level/65535"
                                                     : "value",
                         alignment)
                     .dump(2)
              << "\n";
  else
    print(*m, unit, alignment);
  return judgeMaxError(o, m->max, unit);
}

}  // namespace vernier::app
