// SPDX-License-Identifier: GPL-3.0-or-later
#include "GlLensImages.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>

#include "vernier/base/Threads.h"

namespace vernier::lens {

std::string_view shaderText(std::string_view fileName);  // the files of shaders/

namespace {

constexpr double kBatch = 4e6;  // faces looked at between two looks at the stop token
constexpr double kInfinite = std::numeric_limits<double>::infinity();

std::string shaderOf(std::initializer_list<std::string_view> files) {
  std::string out = "#version 330 core\n";
  for (const std::string_view f : files) out += shaderText(f);
  return out;
}

double plane_mm(const CameraPicture& c) { return std::max(c.targetDistance_mm, 0.0); }
PatientPoint middleOf(const CameraPicture& c) { return c.eye + c.forward * plane_mm(c); }
bool isPerspective(const CameraPicture& c) { return c.projection == Projection::Perspective; }
double step_mm(const CameraPicture& c) {
  return c.pixelStep * (isPerspective(c) ? std::max(plane_mm(c), 1e-6) : 1.0);
}

// Pixels that the lens may cover; all where a corner is not before the eye, or where there are none.
std::optional<gpu::Rect> boxOf(const ConvexRegion& lens, const CameraPicture& camera) {
  if (lens.corners.empty()) return std::nullopt;
  const glm::dmat4 toPixel = camera.pixelFromPatient();
  glm::dvec2 least(kInfinite), most(-kInfinite);
  for (const PatientPoint& p : lens.corners) {
    const glm::dvec4 q = toPixel * glm::dvec4(p.p, 1);
    if (!(q.w > 1e-9)) return std::nullopt;
    least = glm::min(least, glm::dvec2(q) / q.w), most = glm::max(most, glm::dvec2(q) / q.w);
  }
  const auto within = [](double v, int size) {
    return static_cast<int>(std::clamp(v, 0.0, static_cast<double>(size)));
  };
  const int x0 = within(std::floor(least.x - 0.5), camera.width_px),
            y0 = within(std::floor(least.y - 0.5), camera.height_px);
  return gpu::Rect{x0, y0, within(std::ceil(most.x + 0.5), camera.width_px) - x0,
                   within(std::ceil(most.y + 0.5), camera.height_px) - y0};
}

}  // namespace

std::vector<gpu::Uniform> GlLensImages::uniforms(std::size_t faces) const {
  const double step = step_mm(camera_), plane = plane_mm(camera_);
  return {{"right", glm::vec3((camera_.right * step).v)},
          {"down", glm::vec3((camera_.up * -step).v)},
          {"forward", glm::vec3(camera_.forward.v)},
          {"centre_px", 0.5f * glm::vec2(camera_.width_px, camera_.height_px)},
          {"perDepth", isPerspective(camera_) ? static_cast<float>(1 / std::max(plane, 1e-6)) : 0.0f},
          {"nearDepth", static_cast<float>(std::max(camera_.near_mm, 0.0) - plane)},
          {"faceCount", static_cast<int>(faces)}};
}

Result<gpu::Texture> GlLensImages::facesOf(const std::vector<HalfSpace>& planes) {
  std::vector<float> texels;
  const PatientPoint middle = middleOf(camera_);
  for (const HalfSpace& h : planes)
    for (const double v : {h.normal.v.x, h.normal.v.y, h.normal.v.z, -h.distance_mm(middle)})
      texels.push_back(static_cast<float>(v));
  return device_->texture2d(gpu::Format::Rgba32F, static_cast<int>(planes.size()), 1,
                            std::as_bytes(std::span(texels)));
}

// `only`: the pixels that matter.
Result<void> GlLensImages::drawBands(gpu::Draw& draw, const gpu::Target& target, std::size_t faces,
                                     const std::optional<gpu::Rect>& only) {
  const gpu::Rect all = only.value_or(gpu::Rect{0, 0, camera_.width_px, camera_.height_px});
  const double perRow = static_cast<double>(faces + 1) * std::max(all.width, 1);
  const int rows = std::max(1, static_cast<int>(kBatch / perRow));
  for (int y = all.y; y < all.y + all.height && all.width > 0; y += rows) {
    if (stop_.stop_requested())
      return makeError(ErrorCode::Cancelled, "Cutting rays at lenses was cancelled.");
    draw.state.scissor = gpu::Rect{all.x, y, all.width, std::min(rows, all.y + all.height - y)};
    if (Result<void> r = device_->draw(target, {&draw, 1}); !r) return r;
    if (Result<void> r = device_->limits().software ? device_->finish() : Result<void>(); !r) return r;
  }
  return {};
}

Result<GlLensImages> GlLensImages::make(gpu::Device& device, const CameraPicture& camera,
                                        const std::vector<HalfSpace>& region, std::stop_token stop) {
  GlLensImages out(device, camera, std::move(stop));
  const std::array corners{-1.0f, -1.0f, 3.0f, -1.0f, -1.0f, 3.0f};
  const std::array components{2};
  Result<gpu::VertexData> whole = device.vertices(corners, components);
  if (!whole) return whole.error();
  out.whole_ = *std::move(whole);
  Result<gpu::Texture> faces = out.facesOf(region);
  if (!faces) return faces.error();
  auto program =
      device.program("lens box", shaderOf({"whole.vert.glsl"}), shaderOf({"line.glsl", "box.frag.glsl"}));
  if (!program) return program.error();
  const std::array formats{gpu::Format::Rgba32F, gpu::Format::Rgba32F};
  Result<gpu::Target> target = device.target(camera.width_px, camera.height_px, formats);
  if (!target) return target.error();
  gpu::Draw draw;
  draw.program = program->get(), draw.vertices = &*out.whole_, draw.count = 3;
  draw.textures = {{"faces", &*faces}};
  draw.uniforms = out.uniforms(region.size());
  if (Result<void> r = out.drawBands(draw, *target, region.size(), std::nullopt); !r) return r.error();
  const std::size_t size =
      4 * static_cast<std::size_t>(camera.width_px) * static_cast<std::size_t>(camera.height_px);
  for (int n = 0; n < 2; ++n) {
    std::vector<float>& image = n == 0 ? out.front_ : out.back_;
    image.resize(size);
    if (Result<void> r = device.read(*target, n, image); !r) return r.error();
    Result<gpu::Texture> texture = device.texture2d(gpu::Format::Rgba32F, camera.width_px, camera.height_px,
                                                    std::as_bytes(std::span(image)));
    if (!texture) return texture.error();
    (n == 0 ? out.boxFront_ : out.boxBack_) = *std::move(texture);
  }
  return out;
}

Result<LensImages> GlLensImages::draw(const ConvexRegion& lens, bool withBox) {
  Result<gpu::Texture> faces = facesOf(lens.planes);
  if (!faces) return faces.error();
  auto program = device_->program("lens images", shaderOf({"whole.vert.glsl"}),
                                  shaderOf({"line.glsl", "lens.frag.glsl"}));
  if (!program) return program.error();
  const std::array formats{gpu::Format::Rgba32F, gpu::Format::Rgba32F, gpu::Format::Rgba32F,
                           gpu::Format::Rgba32F};
  Result<gpu::Target> target = device_->target(camera_.width_px, camera_.height_px, formats);
  if (!target) return target.error();
  for (int n = 0; n < 4; ++n)
    if (Result<void> r = device_->clear(*target, n, glm::vec4(0)); !r) return r.error();
  gpu::Draw draw;
  draw.program = program->get(), draw.vertices = &*whole_, draw.count = 3;
  draw.textures = {{"faces", &*faces}, {"boxFront", &*boxFront_}, {"boxBack", &*boxBack_}};
  draw.uniforms = uniforms(lens.planes.size());
  const std::optional<gpu::Rect> covered = withBox ? std::nullopt : boxOf(lens, camera_);
  if (Result<void> r = drawBands(draw, *target, lens.planes.size(), covered); !r) return r.error();
  LensImages out;
  std::vector<float>* const images[] = {&out.transition0, &out.transition1, &out.lensFront, &out.lensBack};
  for (int n = 0; n < 4; ++n) {
    images[n]->resize(front_.size());
    if (Result<void> r = device_->read(*target, n, *images[n]); !r) return r.error();
  }
  if (withBox) out.boxFront = front_, out.boxBack = back_;
  return out;
}

double GlLensImages::along_mm(int x, int y, const float* position) const {
  const PatientPoint p(middleOf(camera_).p + glm::dvec3(position[0], position[1], position[2]));
  const PatientRay ray = camera_.ray(x + 0.5, y + 0.5);
  return dot(p - ray.origin, ray.direction);
}

native::LensSpans GlLensImages::spans(const LensImages& images) const {
  native::LensSpans out{0, 0, camera_.width_px, camera_.height_px, {}};
  out.spans.assign(front_.size() / 4, RaySpan{kInfinite, -kInfinite});
  const auto width = static_cast<std::size_t>(camera_.width_px);
  parallelFor(out.spans.size() / std::max<std::size_t>(width, 1), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y)
      for (std::size_t x = 0; x < width; ++x) {
        const std::size_t p = x + width * y, texel = 4 * p;
        if (images.lensFront[texel + 3] == 0) continue;
        const auto at = [&](const std::vector<float>& image) {
          return along_mm(static_cast<int>(x), static_cast<int>(y), image.data() + texel);
        };
        out.spans[p] = {images.transition1[texel + 3] != 0 ? at(images.lensFront) : -kInfinite,
                        images.transition0[texel + 3] != 0 ? at(images.lensBack) : kInfinite};
      }
  });
  return out;
}

}  // namespace vernier::lens
