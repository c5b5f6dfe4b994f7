// SPDX-License-Identifier: GPL-3.0-or-later
// mpr.strips: arbitrary slices from 2-D textures alone, Rezk-Salama et al. 2000, section 9, figures 11
// and 12. The slices that the plane crosses are textures, kept on the device by volume revision; nothing else
// is uploaded. A slab is drawn as so many planes, which float blending combines (maximum, minimum, or sums of
// values and counts).
#include <algorithm>
#include <array>
#include <set>

#include "GlSlice.h"

namespace vernier::mpr {
namespace {

// Built-in costs on llvmpipe with two cores, measured on 512 x 512 x 256, oblique; the table of this machine
// wins.
constexpr double kFloatSample_ns = 300.0, kFixedSample_ns = 70.0, kStrip_ms = 0.03, kSetUp_ms = 12.0;
constexpr std::size_t kMostStrips = 65536;
// Between two looks at the stop token: so many picture areas, so many bytes of textures.
constexpr double kBatchPictures = 2.0;
constexpr std::uint64_t kBatchTexture_bytes = 256ull << 20;
constexpr std::array<int, 4> kVertexLayout{2, 1, 2, 2};
// Wide enough for the rasteriser's 1/256 pixel and for float positions.
constexpr Margin kMargin{1.0 / 16.0, 1e-5};

using SliceTextures = std::map<std::int64_t, std::shared_ptr<const gpu::Texture>>;

// Strips of all samples, those between the same slices next to each other, so that each texture is needed
// once.
std::vector<Strip> allStrips(const SliceParams& p, Margin margin) {
  std::vector<Strip> strips;
  for (int n = 0; n < p.slabSamples && strips.size() <= kMostStrips; ++n) {
    std::vector<Strip> some =
        cutIntoStrips(voxelPlane(p, n), p.volume->grid(), p.view.width_px, p.view.height_px, margin);
    strips.insert(strips.end(), std::make_move_iterator(some.begin()), std::make_move_iterator(some.end()));
  }
  std::stable_sort(strips.begin(), strips.end(),
                   [](const Strip& a, const Strip& b) { return a.part.lower < b.part.lower; });
  return strips;
}

std::set<std::int64_t> slicesOf(const std::vector<Strip>& strips) {
  std::set<std::int64_t> slices;
  for (const Strip& s : strips) slices.insert({s.part.first, s.part.second});
  return slices;
}

glm::dvec2 shiftOf(const GridGeometry& g, std::int64_t slice) {
  return g.even() ? glm::dvec2(0) : glm::dvec2(g.sliceOrigin_vox[static_cast<std::size_t>(slice)]);
}

// Vertices of all strips: picture position, the paper's alpha, texture coordinates in both slices.
std::vector<float> vertexFloats(const std::vector<Strip>& strips, const GridGeometry& g) {
  std::vector<float> out;
  const glm::dvec2 size(static_cast<double>(g.columns), static_cast<double>(g.rows));
  for (const Strip& s : strips)
    for (const glm::dvec2& p : s.outline) {
      const glm::dvec3 voxel = s.plane.at(p);
      const double height = s.part.upper - s.part.lower;
      const double alpha =
          s.part.first == s.part.second ? 0.0 : std::clamp((voxel.z - s.part.lower) / height, 0.0, 1.0);
      const glm::dvec2 uv0 = (glm::dvec2(voxel) - shiftOf(g, s.part.first) + 0.5) / size;
      const glm::dvec2 uv1 = (glm::dvec2(voxel) - shiftOf(g, s.part.second) + 0.5) / size;
      for (const double v : {p.x, p.y, alpha, uv0.x, uv0.y, uv1.x, uv1.y})
        out.push_back(static_cast<float>(v));
    }
  return out;
}

Result<std::shared_ptr<const gpu::Texture>> sliceTexture(gpu::Device& device, const Volume& volume,
                                                         const TexelCode& code, std::int64_t slice,
                                                         std::vector<std::byte>& scratch) {
  const char* kind = code.format == gpu::Format::R16 ? "slice r16" : "slice r32f";
  return device.cache().get({kind, volume.revision(), slice}, [&] {
    return device.texture2d(code.format, static_cast<int>(volume.grid().columns),
                            static_cast<int>(volume.grid().rows),
                            gpu::slicedTexels(volume, code, slice, scratch));
  });
}

void addStripUniforms(std::vector<gpu::Uniform>& u, const SliceParams& p, const Strip& s) {
  const GridGeometry& g = p.volume->grid();
  const glm::dvec2 shift0 = shiftOf(g, s.part.first), shift1 = shiftOf(g, s.part.second);
  u.push_back({"shift0Whole", glm::vec2(glm::floor(shift0))});
  u.push_back({"shift0Part", glm::vec2(shift0 - glm::floor(shift0))});
  u.push_back({"shift1Whole", glm::vec2(glm::floor(shift1))});
  u.push_back({"shift1Part", glm::vec2(shift1 - glm::floor(shift1))});
  u.push_back({"lower", wholeAndPart(s.part.lower)});
  u.push_back({"upper", wholeAndPart(s.part.upper)});
  const bool held = s.part.first == s.part.second;
  u.push_back({"perStep", held ? 0.0f : static_cast<float>(1.0 / (s.part.upper - s.part.lower))});
  u.push_back({"nearest", p.interpolation == Interpolation::Nearest ? 1 : 0});
}

gpu::Blend blendOf(SlabMode mode) {
  return mode == SlabMode::Max ? gpu::Blend::Max : mode == SlabMode::Min ? gpu::Blend::Min : gpu::Blend::Add;
}

// Draws the strips in batches into the accumulator.
class StripPainter {
 public:
  StripPainter(gpu::Device& device, const SliceParams& p, const TexelCode& code, bool fixedFunction)
      : device_(device), p_(p), code_(code), fixed_(fixedFunction) {}

  Result<void> draw(const std::vector<Strip>& strips, const gpu::Target& target, std::stop_token stop) {
    if (strips.empty()) return {};
    auto program = device_.program(
        fixed_ ? "mpr strip, fixed-function" : "mpr strip", shaderOf("", {"picture.vert.glsl"}),
        fixed_ ? shaderOf("", {"texels.glsl", "strip_fixed.frag.glsl"})
               : shaderOf("", {"position.glsl", "texels.glsl", "strip.frag.glsl"}));
    if (!program) return program.error();
    program_ = *program;
    Result<gpu::VertexData> vertices =
        device_.vertices(vertexFloats(strips, p_.volume->grid()), kVertexLayout);
    if (!vertices) return vertices.error();
    int first = 0;
    for (std::size_t begin = 0; begin < strips.size();) {
      if (stop.stop_requested()) return cancelled();
      const std::size_t end = batchEnd(strips, begin);
      if (Result<void> r = batch(strips, begin, end, *vertices, first, target); !r) return r;
      begin = end;
    }
    return {};
  }

 private:
  std::size_t batchEnd(const std::vector<Strip>& strips, std::size_t begin) const {
    const double most_px = kBatchPictures * p_.view.width_px * p_.view.height_px;
    const std::uint64_t perSlice =
        code_.bytes(p_.volume->grid()) / static_cast<std::uint64_t>(p_.volume->grid().slices);
    const std::uint64_t mostStrips = std::max<std::uint64_t>(1, kBatchTexture_bytes / (2 * perSlice));
    double area_px = 0;
    std::size_t end = begin;
    while (end < strips.size() && area_px < most_px && end - begin < mostStrips)
      area_px += areaOf(strips[end++].outline);
    return end;
  }

  Result<void> batch(const std::vector<Strip>& strips, std::size_t begin, std::size_t end,
                     const gpu::VertexData& vertices, int& first, const gpu::Target& target) {
    SliceTextures textures;  // held until the batch is drawn
    std::vector<gpu::Draw> draws;
    for (std::size_t n = begin; n < end; ++n) {
      const Strip& s = strips[n];
      for (const std::int64_t slice : {s.part.first, s.part.second})
        if (!textures.contains(slice)) {
          auto t = sliceTexture(device_, *p_.volume, code_, slice, scratch_);
          if (!t) return t.error();
          textures[slice] = *t;
        }
      gpu::Draw d;
      d.program = program_.get();
      d.vertices = &vertices;
      d.first = first;
      d.count = static_cast<int>(s.outline.size());
      first += d.count;
      d.primitive = gpu::Primitive::TriangleFan;
      d.state.blend = blendOf(p_.slab.mode);
      const gpu::Filter filter = fixed_ ? gpu::Filter::Linear : gpu::Filter::Nearest;
      d.textures = {{"slice0", textures[s.part.first].get(), filter},
                    {"slice1", textures[s.part.second].get(), filter}};
      d.uniforms = {{"size_px", glm::vec2(p_.view.width_px, p_.view.height_px)},
                    {"mode", static_cast<int>(p_.slab.mode)},
                    {"quantum", meanQuantum(code_)}};
      gpu::addTexelUniforms(d.uniforms, code_);
      addPositionUniforms(d.uniforms, s.plane, p_.view.width_px, p_.view.height_px);
      addStripUniforms(d.uniforms, p_, s);
      draws.push_back(std::move(d));
    }
    Result<void> drawn = device_.draw(target, draws);
    return drawn && device_.limits().software ? device_.finish() : drawn;
  }

  gpu::Device& device_;
  const SliceParams& p_;
  const TexelCode& code_;
  bool fixed_;
  std::shared_ptr<const gpu::Program> program_;
  std::vector<std::byte> scratch_;
};

Result<std::vector<Pass>> passesFor(const Layer& layer, std::size_t index, const PlanContext& context) {
  Result<std::shared_ptr<const SliceParams>> params = sliceParams(layer, context);
  if (!params) return params.error();
  const SliceParams& p = **params;
  if (Result<void> r = checkDrawable(p, context.capabilities); !r) return r.error();
  const Result<TexelCode> code = texelCode(*p.volume);
  if (!code) return code.error();
  const GridGeometry& g = p.volume->grid();
  const std::int64_t limit = context.capabilities.maxTexture > 0 ? context.capabilities.maxTexture : 16384;
  if (std::max(g.columns, g.rows) > limit)
    return makeError(ErrorCode::NoTechnique, "The slices are " + std::to_string(g.columns) + " x " +
                                                 std::to_string(g.rows) + "; GL textures here take up to " +
                                                 std::to_string(limit) + " per side.");
  const bool fixed =
      context.quality.level == QualityLevel::Draft && gpu::mayUseFixedFunction(*p.volume, p.interpolation);
  const std::vector<Strip> strips = allStrips(p, fixed ? Margin{} : kMargin);
  if (strips.size() > kMostStrips)
    return makeError(ErrorCode::NoTechnique,
                     "The slab needs more than 65536 strips; take a thinner slab or a larger step.");
  const std::size_t slices = slicesOf(strips).size();

  Pass pass;
  pass.name = "slice " + std::to_string(index);
  pass.inputs = {"slice textures"};
  pass.outputs = {"colour", "depth"};
  if (context.view.wantValues) pass.outputs.push_back("values");
  pass.gl.blend = p.slab.mode == SlabMode::Max ? "max" : p.slab.mode == SlabMode::Min ? "min" : "add";
  pass.resources = {{"texture2d x " + std::to_string(slices),
                     code->bytes(g) / static_cast<std::uint64_t>(g.slices) * slices}};
  const auto known = context.costs.nsPerSample.find("mpr.strips");
  const double ns = known != context.costs.nsPerSample.end() ? known->second
                    : fixed                                  ? kFixedSample_ns
                                                             : kFloatSample_ns;
  pass.predicted_ms = kSetUp_ms + kStrip_ms * static_cast<double>(strips.size()) +
                      ns * 1e-6 * p.view.width_px * p.view.height_px * p.slabSamples;
  pass.predictedError = predictedError(p, context.quality.step, fixed);
  pass.fixedFunctionFiltering = fixed;
  pass.params = *params;
  return std::vector<Pass>{std::move(pass)};
}

Result<void> execute(Host& host, const Pass& pass, Images& images, std::stop_token stop) {
  const auto* p = dynamic_cast<const SliceParams*>(pass.params.get());
  if (!p) return makeError(ErrorCode::Internal, "The pass has no slice parameters.", "mpr.strips");
  const Result<TexelCode> code = texelCode(*p->volume);
  if (!code) return code.error();
  Result<gpu::Device*> device = host.glDevice();
  if (!device) return device.error();
  gpu::Device& d = **device;
  const Counters before = d.counters();
  Result<gpu::Target> target = accumulationTarget(d, *p);
  if (!target) return target.error();
  const bool fixed = pass.fixedFunctionFiltering;
  if (Result<void> r =
          StripPainter(d, *p, *code, fixed).draw(allStrips(*p, fixed ? Margin{} : kMargin), *target, stop);
      !r)
    return r;
  const std::uint64_t samples = d.counters().samples - before.samples;
  if (Result<void> r = resolve(d, *target, *p, *code, images); !r) return r;
  images.counters.samples += samples;
  addCounters(images.counters, before, d.counters());
  return {};
}

}  // namespace

Technique stripsTechnique(Host& host) {
  Technique t;
  t.name = "mpr.strips";
  t.kinds = {"slice"};
  t.engine = Engine::Gl;
  t.passesFor = passesFor;
  t.execute = [&host](const Pass& pass, Images& images, std::stop_token stop) {
    return execute(host, pass, images, stop);
  };
  return t;
}

}  // namespace vernier::mpr
