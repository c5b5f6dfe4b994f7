// SPDX-License-Identifier: GPL-3.0-or-later
// shells.gl: the depth buffer as maximum. shells.glmax: blending as maximum, for what depth does not resolve.
#include <algorithm>

#include "AngiographyTechniques.h"
#include "GlShells.h"
#include "ShellParams.h"

namespace vernier::angiography {
namespace {

// Built-in costs, measured on llvmpipe with two cores; a card draws triangles a hundred times as fast.
constexpr double kSoftwareTriangle_ns = 75.0, kCardTriangle_ns = 0.7, kPixel_ns = 90.0, kCapPixel_ns = 900.0;
constexpr double kSetUp_ms = 2.0;
// In a vertex and index buffer: half a vertex of 12 bytes, three indices of 4.
constexpr std::uint64_t kBytesPerTriangle = 18;

Error cannot(const std::string& why) { return makeError(ErrorCode::NoTechnique, why); }

Result<void> checkDrawable(const ShellParams& p, const PlanContext& context, Maximum maximum) {
  const Capabilities& c = context.capabilities;
  const int largest = std::max(context.view.width_px, context.view.height_px);
  if (c.maxTexture > 0 && largest > c.maxTexture)
    return cannot("The picture has " + std::to_string(largest) + " pixels on a side; GL here draws up to " +
                  std::to_string(c.maxTexture) + ".");
  if (cuttingPlanes(p.job).size() > kMostCuts)
    return cannot("The volume is cut by " + std::to_string(cuttingPlanes(p.job).size()) +
                  " planes; GL cuts shells by up to " + std::to_string(kMostCuts) + ".");
  if (kBytesPerTriangle * p.triangles > c.glTextureBudget_bytes)
    return cannot("The shells need about " + std::to_string((kBytesPerTriangle * p.triangles) >> 20) +
                  " MB in GL's buffers, which may hold " + std::to_string(c.glTextureBudget_bytes >> 20) +
                  " MB.");
  if (maximum == Maximum::Blending) return {};
  if (std::any_of(p.job.tools.begin(), p.job.tools.end(),
                  [](const PlacedSurface& t) { return t.opacity > 0 && t.opacity < 1; }))
    return cannot("A depth buffer knows no translucent tools.");
  if (!depthResolves(p.job))
    return cannot(
        "24 bits of depth do not resolve levels whose brightness is less than 1/1024 of the brightest.");
  return {};
}

GlState stateOf(const native::ShellsJob& job, Maximum maximum) {
  const bool byDepth = maximum == Maximum::DepthBuffer, max = job.mode == ShellsMode::Max;
  GlState s;
  s.blend = job.mode == ShellsMode::Sum ? "add" : max && !byDepth ? "max" : "off";
  s.depth = job.mode == ShellsMode::Lit     ? "nearest"
            : max && byDepth                ? job.a == 0 ? "rank" : "z*"
            : byDepth && !job.tools.empty() ? "test"
                                            : "off";
  s.cull = job.mode != ShellsMode::Sum && !native::isCut(job) ? "back" : "off";
  return s;
}

Result<std::vector<Pass>> passesFor(const Layer& layer, std::size_t index, const PlanContext& context,
                                    ShellStore& store, Maximum maximum) {
  const Result<std::shared_ptr<const ShellParams>> params = shellParams(layer, index, context, store);
  if (!params) return params.error();
  const ShellParams& p = **params;
  if (const Result<void> ok = checkDrawable(p, context, maximum); !ok) return ok.error();
  std::uint64_t tools = 0;
  for (const PlacedSurface& t : p.job.tools)
    if (t.opacity > 0) tools += t.mesh->triangles().size();
  const bool byDepth = maximum == Maximum::DepthBuffer, max = p.job.mode == ShellsMode::Max;
  const std::uint64_t toolPasses = byDepth ? 1 + (max ? p.job.shells.size() : 1) : 1;
  const double pixels = static_cast<double>(context.view.width_px) * context.view.height_px;
  const double triangles = static_cast<double>((max && !byDepth ? 2 : 1) * p.triangles + toolPasses * tools);
  Pass pass = shellPass(*params, index);
  pass.gl = stateOf(p.job, maximum);
  pass.resources.push_back({"shell buffers", kBytesPerTriangle * p.triangles});
  pass.predicted_ms =
      kSetUp_ms +
      1e-6 * (triangles * (context.capabilities.glIsSoftware ? kSoftwareTriangle_ns : kCardTriangle_ns) +
              pixels * (kPixel_ns + (native::isCut(p.job) ? kCapPixel_ns : 0)));
  return std::vector<Pass>{std::move(pass)};
}

Technique glTechnique(Host& host, std::shared_ptr<ShellStore> store, const char* name, Maximum maximum) {
  Technique t;
  t.name = name;
  t.kinds = {"shells"};
  t.engine = Engine::Gl;
  t.passesFor = [store, maximum](const Layer& layer, std::size_t index, const PlanContext& context) {
    return passesFor(layer, index, context, *store, maximum);
  };
  t.execute = [&host, store, maximum, where = std::string(name)](const Pass& pass, Images& images,
                                                                 std::stop_token stop) -> Result<void> {
    const auto* p = dynamic_cast<const ShellParams*>(pass.params.get());
    if (!p) return makeError(ErrorCode::Internal, "The pass has no parameters of shells.", where);
    const Result<native::ShellsJob> job = withMeshes(*p, *store, stop);
    if (!job) return job.error();
    Result<gpu::Device*> device = host.glDevice();
    if (!device) return device.error();
    return drawGlShells(**device, *job, {maximum, Route::ColourPerShell}, images, stop);
  };
  return t;
}

}  // namespace

Technique glShellsTechnique(Host& host, std::shared_ptr<ShellStore> store) {
  return glTechnique(host, std::move(store), "shells.gl", Maximum::DepthBuffer);
}
Technique glMaxShellsTechnique(Host& host, std::shared_ptr<ShellStore> store) {
  return glTechnique(host, std::move(store), "shells.glmax", Maximum::Blending);
}

}  // namespace vernier::angiography
