// SPDX-License-Identifier: GPL-3.0-or-later
#include "GlDrawing.h"

#include <array>
#include <cmath>

namespace vernier::dvr {
namespace {

// Differences of neighbouring voxels below this part of the volume's range come from rounding.
constexpr double kFlat = 1e-5;

glm::vec4 column(glm::dvec3 v, double w = 0) { return glm::vec4(glm::dvec4(v, w)); }

void addCamera(std::vector<gpu::Uniform>& u, const GlVolumeJob& job) {
  const CameraPicture& c = job.camera;
  const VoxelFromPatient& toVoxel = job.volume->voxelFromPatient();
  const GridGeometry& g = job.volume->grid();
  const PatientVec right = c.right * c.pixelStep, down = -(c.up * c.pixelStep);
  u.push_back({"size_px", glm::vec2(c.width_px, c.height_px)});
  u.push_back({"pixelStep", job.perspective() ? static_cast<float>(c.pixelStep) : 0.0f});
  u.push_back({"forward_vox", glm::vec3((toVoxel * c.forward).v)});
  u.push_back({"right_vox", glm::vec3((toVoxel * right).v)});
  u.push_back({"down_vox", glm::vec3((toVoxel * down).v)});
  u.push_back({"forward_mm", column(c.forward.v)});
  u.push_back({"right_mm", column(right.v)});
  u.push_back({"down_mm", column(down.v)});
  u.push_back({"last_vox", glm::vec3(static_cast<float>(g.columns - 1), static_cast<float>(g.rows - 1),
                                     static_cast<float>(g.slices - 1))});
  u.push_back({"step_mm", static_cast<float>(job.step_mm)});
}

void addValues(std::vector<gpu::Uniform>& u, const GlVolumeJob& job) {
  const gpu::TexelCode& code = job.code;
  gpu::addTexelUniforms(u, code);
  u.push_back({"gains", glm::vec4(glm::dvec4(job.gains[0], job.gains[1], job.gains[2], job.gains[3]))});
  u.push_back({"sign_", signOfExtreme(job)});
  u.push_back({"level", static_cast<float>((job.level - code.modalityAtBias) / code.slope)});
}

void addLight(std::vector<gpu::Uniform>& u, const GlVolumeJob& job) {
  const Material& m = job.material;
  u.push_back({"material", glm::vec4(glm::dvec4(m.ambient, m.diffuse, m.specular, m.power))});
  u.push_back(
      {"ambientColour", glm::vec3(glm::dvec3(m.ambientColour.r, m.ambientColour.g, m.ambientColour.b))});
  u.push_back(
      {"diffuseColour", glm::vec3(glm::dvec3(m.diffuseColour.r, m.diffuseColour.g, m.diffuseColour.b))});
  glm::mat4 towards(0), colours(0);
  for (int n = 0; n < 4; ++n) {
    towards[n] = {0, 0, 0, -1};
    if (static_cast<std::size_t>(n) >= job.lights.size()) continue;
    const Light& l = job.lights[static_cast<std::size_t>(n)];
    towards[n] = l.towards ? column(normalize(*l.towards).v, 1) : glm::vec4(0);
    colours[n] = column({l.colour.r, l.colour.g, l.colour.b});
  }
  u.push_back({"lightsTowards", towards});
  u.push_back({"lightColours", colours});
  // Gradients transform by the inverse map's transpose. Values of texels, so without the slope's size; its
  // sign does not matter, since normals are turned to the eye.
  const glm::dmat3 map = glm::transpose(job.volume->voxelFromPatient().linear);
  u.push_back({"gradientToPatient", glm::mat4(glm::dmat4(map))});
  const double range = job.code.modalityRange / std::abs(job.code.slope);
  u.push_back({"flat_perMm", static_cast<float>(kFlat * range / job.smallestSpacing_mm())});
}

std::string definesOf(const GlVolumeJob& job) {
  std::string d = job.extreme() || job.iso || job.combination ? "" : "#define CLASSIFY\n";
  if (job.volume->isColour()) {
    d += "#define RGBA\nuniform float rgbaLengths;\n";
  } else if (!job.iso && !job.extreme()) {
    if (job.classification == Classification::Pre) d += "#define PRE\n";
    if (job.classification == Classification::PreIntegrated) d += "#define PREINTEGRATED\n";
    if (job.shading == ShadingModel::GlobalAmbient) d += "#define SHADED 1\n";
    if (job.shading == ShadingModel::ColourPerVoxel) d += "#define SHADED 2\n";
  }
  if (job.interpolation == Interpolation::Nearest) d += "#define NEAREST\n";
  if (job.fixedFunction) d += "#define FIXED\n";
  if (job.opacity == OpacityRule::Linear) d += "#define LINEAR_OPACITY\n";
  return d;
}

// Texel value to table entry, in double until the end.
glm::vec2 entryOf(const gpu::TexelCode& code, double least, double greatest, int size) {
  const double perValue = (size - 1) / (greatest - least);
  return {static_cast<float>(code.slope * perValue),
          static_cast<float>((code.modalityAtBias - least) * perValue)};
}

}  // namespace

std::string shaderOf(const std::string& defines, std::initializer_list<std::string_view> files) {
  std::string text = "#version 330 core\n" + defines;
  for (const std::string_view file : files) {
    // What turns texels into values is module gpu's.
    if (file == "value.glsl") text += gpu::texelShader();
    text += shaderText(file);
  }
  return text;
}

std::string programName(std::string kind, const std::string& defines) {
  constexpr std::string_view kDefine = "#define ";
  for (std::size_t at = 0; (at = defines.find(kDefine, at)) != std::string::npos;) {
    at += kDefine.size();
    const std::string line = defines.substr(at, defines.find('\n', at) - at);
    // Of a macro with a body of its own the name says enough.
    kind += " " + (line.size() < 24 ? line : line.substr(0, line.find(' ')));
  }
  return kind;
}

Error drawingCancelled() { return makeError(ErrorCode::Cancelled, "Drawing the volume was cancelled."); }

float signOfExtreme(const GlVolumeJob& job) {
  const bool falls = !job.volume->isColour() && job.code.slope < 0;
  return falls != (!job.iso && job.mode == VolumeMode::Min) ? -1.0f : 1.0f;
}

Result<GlInputs> GlInputs::make(gpu::Device& device, const GlVolumeJob& job, double table_mm) {
  GlInputs in;
  in.defines_ = definesOf(job), in.table_mm_ = table_mm;
  addCamera(in.uniforms_, job);
  addValues(in.uniforms_, job);
  addLight(in.uniforms_, job);
  in.uniforms_.push_back({"rgbaLengths", static_cast<float>(table_mm / job.smallestSpacing_mm())});
  if (job.iso || job.volume->isColour()) return in;
  // Voxels that are classified first are interpolated with the opacities that the function gives.
  const bool pre = job.classification == Classification::Pre;
  const double given_mm = job.transfer.opacityLength_mm;
  in.uniforms_.push_back({"preLengths", static_cast<float>(table_mm / given_mm)});
  Result<TransferTable> table = tableOf(job, pre ? given_mm : table_mm);
  if (!table) return table.error();
  Result<gpu::Texture> made =
      device.texture2d(gpu::Format::Rgba32F, table->size, 1, std::as_bytes(std::span(table->rgba)));
  if (!made) return made.error();
  in.table_ = std::make_shared<gpu::Texture>(*std::move(made));
  in.uniforms_.push_back({"entryOfValue", entryOf(job.code, table->least, table->greatest, table->size)});
  if (job.classification != Classification::PreIntegrated) return in;
  const Volume::Range values = job.volume->modalityRange().value_or(Volume::Range{0, 1});
  Result<PreIntegratedTable> pairs =
      makePreIntegratedTable(job.transfer, preIntegratedRange(job.transfer, values), table_mm);
  if (!pairs) return pairs.error();
  made =
      device.texture2d(gpu::Format::Rgba32F, pairs->size, pairs->size, std::as_bytes(std::span(pairs->rgba)));
  if (!made) return made.error();
  in.preIntegrated_ = std::make_shared<gpu::Texture>(*std::move(made));
  in.uniforms_.push_back({"endOfValue", entryOf(job.code, pairs->least, pairs->greatest, pairs->size)});
  return in;
}

void GlInputs::addTo(gpu::Draw& d) const {
  d.uniforms.insert(d.uniforms.end(), uniforms_.begin(), uniforms_.end());
  if (table_) d.textures.push_back({"table", table_.get()});
  if (preIntegrated_) d.textures.push_back({"preIntegrated", preIntegrated_.get()});
}

Result<RayTextures> RayTextures::make(gpu::Device& device, const GlVolumeJob& job, const RayImages& rays) {
  const int w = job.camera.width_px, h = job.camera.height_px;
  Result<gpu::Texture> start =
      device.texture2d(gpu::Format::Rgba32F, w, h, std::as_bytes(std::span(rays.start)));
  if (!start) return start.error();
  Result<gpu::Texture> lattice =
      device.texture2d(gpu::Format::Rgba32F, w, h, std::as_bytes(std::span(rays.lattice)));
  if (!lattice) return lattice.error();
  return RayTextures{*std::move(start), *std::move(lattice)};
}

void RayTextures::addTo(gpu::Draw& d) const {
  d.textures.push_back({"rayStart", &start});
  d.textures.push_back({"rayLattice", &lattice});
}

Result<gpu::VertexData> wholePicture(gpu::Device& device, const GlVolumeJob& job) {
  const auto w = static_cast<float>(job.camera.width_px), h = static_cast<float>(job.camera.height_px);
  const std::array<float, 8> corners{0, 0, w, 0, 0, h, w, h};
  const std::array layout{2};
  return device.vertices(corners, layout);
}

Result<DrawnPart> readBack(gpu::Device& device, const gpu::Target& target) {
  const std::size_t n =
      4 * static_cast<std::size_t>(target.width()) * static_cast<std::size_t>(target.height());
  DrawnPart out{std::vector<float>(n), std::vector<float>(n)};
  if (Result<void> r = device.read(target, 0, out.seen); !r) return r.error();
  if (Result<void> r = device.read(target, 1, out.found); !r) return r.error();
  return out;
}

void addCounters(Counters& counters, const Counters& before, const Counters& after) {
  counters.triangles += after.triangles - before.triangles;
  counters.bytesUploaded += after.bytesUploaded - before.bytesUploaded;
  counters.texturesCreated += after.texturesCreated - before.texturesCreated;
  counters.textures3dCreated += after.textures3dCreated - before.textures3dCreated;
}

}  // namespace vernier::dvr
