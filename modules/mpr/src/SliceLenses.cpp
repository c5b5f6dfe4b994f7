// SPDX-License-Identifier: GPL-3.0-or-later
// Lenses on slices: another window, or nothing, where the plane cuts a convex region.
#include "NativeJob.h"
#include "SliceParams.h"
#include "vernier/base/Threads.h"
#include "vernier/volume/Build.h"
#include "vernier/volume/Voi.h"

namespace vernier::mpr {
namespace {

void putInside(const SliceParams& p, const SliceInside& lens, const Images& inside, Images& images) {
  const auto width = static_cast<std::size_t>(images.width);
  parallelFor(static_cast<std::size_t>(images.height), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y)
      for (std::size_t x = 0; x < width; ++x) {
        const PatientPoint point =
            patientAt(p.picture, {static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5});
        if (!lens.region->contains(point)) continue;
        const std::size_t pixel = y * width + x;
        const float background[3] = {static_cast<float>(p.background.r), static_cast<float>(p.background.g),
                                     static_cast<float>(p.background.b)};
        for (std::size_t c = 0; c < 3; ++c)
          images.colour[4 * pixel + c] = lens.cutOut ? background[c] : inside.colour[4 * pixel + c];
        if (lens.cutOut) images.depth[pixel] = kNothing_mm;
      }
  });
}

}  // namespace

Result<std::vector<SliceInside>> lensesOnSlice(const SliceParams& p, const PlanContext& context) {
  std::vector<SliceInside> out;
  if (!context.lenses.empty() && p.volume->isColour())
    return makeError(ErrorCode::NoTechnique, "it draws lenses in grey volumes only");
  for (const PlacedLens& placed : context.lenses) {
    const LensInner& inner = std::get<LensLayer>(context.scene.layers[placed.layer]).inner;
    SliceInside lens;
    lens.region = placed.region;
    if (const auto* look = std::get_if<SliceLook>(&inner)) {
      lens.cutOut = false;
      lens.interpolation = look->interpolation;
      lens.window = normalised(look->window ? *look->window : defaultWindow(*p.volume));
      lens.invert = look->invert != p.volume->info().inverted;
      if (!usableWindow(lens.window))
        return makeError(ErrorCode::SceneInvalid,
                         "The lens's window must have a width above 0 and finite numbers.");
    }
    out.push_back(std::move(lens));
  }
  return out;
}

Result<void> drawLenses(const SliceParams& p, Images& images, std::stop_token stop) {
  for (const SliceInside& lens : p.lenses) {
    Images inside;
    if (!lens.cutOut) {
      inside.allocate(images.width, images.height, false);
      native::SliceJob job = jobOf(p);
      job.interpolation = lens.interpolation, job.window = lens.window, job.invert = lens.invert;
      if (Result<void> drawn = native::drawSlice(job, inside, stop); !drawn) return drawn;
      images.counters += inside.counters;
    }
    putInside(p, lens, inside, images);
  }
  return {};
}

}  // namespace vernier::mpr
