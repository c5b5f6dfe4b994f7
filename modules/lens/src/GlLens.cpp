// SPDX-License-Identifier: GPL-3.0-or-later
// lens.gl: rays cut by the images of lenses (GlLensImages.h), up to kMostLenses of them; their parts joined
// by module native.
#include <algorithm>

#include "GlLensImages.h"
#include "LensParams.h"
#include "LensTechniques.h"
#include "vernier/lens/Shapes.h"

namespace vernier::lens {
namespace {

constexpr std::size_t kMostLenses = 4;
// Built-in costs: of a face that a pixel looks at, and of a pixel's images to and from the device.
constexpr double kSoftwareFace_ns = 4.0, kCardFace_ns = 0.02, kPixel_ns = 60.0, kSetUp_ms = 3.0;
constexpr std::uint64_t kBytesPerPixel = 128;  // the box's images, drawn and read, and those of a lens

Error refused(std::string why) { return makeError(ErrorCode::NoTechnique, std::move(why)); }

Result<void> checkDrawable(const CutParams& cut, const Capabilities& machine) {
  const std::size_t lenses = cut.job.lenses.size();
  if (lenses > kMostLenses)
    return refused("GL draws pictures with up to " + std::to_string(kMostLenses) + " lenses, and there are " +
                   std::to_string(lenses) + " here; ask for native.");
  const std::size_t most =
      std::max(cut.job.region.size(), *std::max_element(cut.facets.begin(), cut.facets.end()));
  const std::size_t limit = machine.maxTexture > 0
                                ? std::min(kMostGlFacets, static_cast<std::size_t>(machine.maxTexture))
                                : kMostGlFacets;
  if (most > limit)
    return refused("GL draws lenses of up to " + std::to_string(limit) + " faces, and one here has " +
                   std::to_string(most) + "; ask for native.");
  const int largest = std::max(cut.job.camera.width_px, cut.job.camera.height_px);
  if (machine.maxTexture > 0 && largest > machine.maxTexture)
    return refused("The picture has " + std::to_string(largest) + " pixels on a side; GL here draws up to " +
                   std::to_string(machine.maxTexture) + ".");
  return {};
}

Result<std::vector<Pass>> passesFor(const PlanContext& context) {
  Result<std::vector<Pass>> passes = lensPasses(context);
  if (!passes) return passes.error();
  Pass& pass = passes->front();
  const auto* native = dynamic_cast<const CutParams*>(pass.params.get());
  if (!native) return makeError(ErrorCode::Internal, "The pass has no lens parameters.", "lens.gl");
  if (const Result<void> ok = checkDrawable(*native, context.capabilities); !ok) return ok.error();
  auto cut = std::make_shared<CutParams>(*native);
  cut->onGl = true;
  const auto pixels =
      static_cast<std::uint64_t>(context.view.width_px) * static_cast<std::uint64_t>(context.view.height_px);
  double faces = static_cast<double>(cut->job.region.size());
  for (const std::size_t n : cut->facets)
    faces += 0.25 * static_cast<double>(n);  // a lens covers a part of the picture
  pass.outputs = {"bbox front", "bbox back", "transition 0", "transition 1",
                  "lens front", "lens back", "parts of rays"};
  pass.resources.push_back({"lens images", kBytesPerPixel * pixels});
  pass.predicted_ms +=
      kSetUp_ms + 1e-6 * static_cast<double>(pixels) *
                      (kPixel_ns * static_cast<double>(1 + cut->facets.size()) +
                       faces * (context.capabilities.glIsSoftware ? kSoftwareFace_ns : kCardFace_ns));
  pass.params = std::move(cut);
  return passes;
}

Result<void> drawCut(Host& host, const CutParams& cut, Images& images, std::stop_token stop) {
  Result<gpu::Device*> device = host.glDevice();
  if (!device) return device.error();
  const Counters before = (*device)->counters();
  Result<GlLensImages> drawing = GlLensImages::make(**device, cut.job.camera, cut.job.region, stop);
  if (!drawing) return drawing.error();
  std::vector<native::LensSpans> spans;
  for (const auto& lens : cut.job.lenses) {
    const Result<LensImages> drawn = drawing->draw(*lens);
    if (!drawn) return drawn.error();
    spans.push_back(drawing->spans(*drawn));
  }
  const Counters& after = (*device)->counters();
  images.counters.bytesUploaded += after.bytesUploaded - before.bytesUploaded;
  images.counters.texturesCreated += after.texturesCreated - before.texturesCreated;
  return cutLensRays(cut, spans, images, stop);
}

}  // namespace

Technique glLensTechnique(Host& host) {
  Technique t;
  t.name = "lens.gl";
  t.kinds = {"lens"};
  t.engine = Engine::Gl;
  t.region = [&host](const LensLayer& l, const Sources& s) { return convexRegion(l, s, host.derivedData()); };
  t.passesFor = [](const Layer&, std::size_t, const PlanContext& c) { return passesFor(c); };
  t.execute = [&host](const Pass& pass, Images& images, std::stop_token stop) -> Result<void> {
    if (const auto* join = dynamic_cast<const JoinParams*>(pass.params.get()))
      return native::joinParts(join->job, images, stop);
    const auto* cut = dynamic_cast<const CutParams*>(pass.params.get());
    if (!cut) return makeError(ErrorCode::Internal, "The pass has no lens parameters.", pass.technique);
    return drawCut(host, *cut, images, stop);
  };
  return t;
}

}  // namespace vernier::lens
