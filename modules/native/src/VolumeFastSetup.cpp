// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "ExactField.h"
#include "VolumeFast.h"

namespace vernier::native {
namespace {

bool typeFits(VoxelType t) {
  return t == VoxelType::U8 || t == VoxelType::U16 || t == VoxelType::I16 || t == VoxelType::F32;
}

// Sixteen steps of a packet and its cells must stay within 32 bits of an address.
bool stridesFit(const GridGeometry& g, VoxelType type) {
  const double slice =
      static_cast<double>(g.columns) * static_cast<double>(g.rows) * static_cast<double>(bytesOf(type));
  return slice * 64 < 2147483647.0;
}

std::int32_t biasOf(const Volume& v) {
  if (v.type() == VoxelType::F32) return 0;
  const auto range = v.modalityRange();
  if (!range) return 0;
  const ModalityRescale& r = v.rescaleOf(0);
  return static_cast<std::int32_t>(std::lround((0.5 * (range->min + range->max) - r.intercept) / r.slope));
}

bool mayHoldNoData(const Volume& v) {
  return v.info().noData || (v.type() == VoxelType::F32 && mayHoldNan(v));
}

std::uint32_t packed(float value, float next) {
  const auto whole = static_cast<std::int32_t>(std::lround(std::clamp(value, 0.0f, 1.0f) * 65535.0f));
  const auto there = static_cast<std::int32_t>(std::lround(std::clamp(next, 0.0f, 1.0f) * 65535.0f));
  return static_cast<std::uint32_t>(whole) << 16 | (static_cast<std::uint32_t>((there - whole) / 2) & 0xffff);
}

void setTable(FastVolume& v, const TransferTable& t) {
  const auto n = static_cast<std::size_t>(t.size);
  v.opacity.resize(n + 1);
  for (auto& c : v.colour) c.resize(n);
  std::size_t first = n, last = 0;
  for (std::size_t k = 0; k < n; ++k) {
    v.opacity[k] = t.rgba[4 * k + 3];
    if (v.opacity[k] > 0) first = std::min(first, k), last = k;
    const std::size_t next = std::min(k + 1, n - 1);
    for (std::size_t c = 0; c < 3; ++c) v.colour[c][k] = packed(t.rgba[4 * k + c], t.rgba[4 * next + c]);
  }
  v.opacity[n] = v.opacity[n - 1];
  // Strictly between them; nothing at all where the first lies behind the last.
  v.seenFrom = static_cast<float>(first) - 1, v.seenTo = static_cast<float>(last) + 1;
}

void setTable(FastVolume& v, const PreIntegratedTable& t) {
  const std::size_t n = t.rgba.size() / 4;
  v.opacity.resize(n);
  for (auto& c : v.lit) c.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    v.opacity[k] = t.rgba[4 * k + 3];
    for (std::size_t c = 0; c < 3; ++c) v.lit[c][k] = t.rgba[4 * k + c];
  }
}

void setShading(FastVolume& v) {
  const VolumeRenderJob& job = *v.job;
  v.shaded = job.shading != ShadingModel::None;
  v.ownColour = job.shading == ShadingModel::ColourPerVoxel;
  const Material& m = job.material;
  const glm::dvec3 ambient = m.ambient * (v.ownColour ? glm::dvec3(1) : colourOf(m.ambientColour));
  const glm::dvec3 diffuse = m.diffuse * (v.ownColour ? glm::dvec3(1) : colourOf(m.diffuseColour));
  for (int c = 0; c < 3; ++c)
    v.ambient[c] = static_cast<float>(ambient[c]), v.diffuse[c] = static_cast<float>(diffuse[c]);
  v.specular = static_cast<float>(m.specular), v.power = static_cast<float>(m.power);
  if (m.power >= 0 && m.power <= 256 && m.power == std::floor(m.power))
    v.wholePower = static_cast<int>(m.power);
  for (const Lighting::Lamp& lamp : Lighting(m, job.lights).lamps) {
    FastLamp out;
    out.atEye = !lamp.towards;
    for (int c = 0; c < 3; ++c) {
      if (lamp.towards) out.towards[c] = static_cast<float>((*lamp.towards)[c]);
      out.colour[c] = static_cast<float>(lamp.colour[c]);
    }
    v.lamps.push_back(out);
  }
  // Directions alone count: scaled, so that float is far from its ends.
  const glm::dmat3 g = patientGradients(*job.volume);
  double largest = 0;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) largest = std::max(largest, std::abs(g[b][a]));
  const double sign = job.volume->rescaleOf(0).slope > 0 ? 1 : -1;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) v.patientGradient[a][b] = static_cast<float>(sign * g[b][a] / largest);
}

}  // namespace

std::optional<FastVolume> fastVolumeOf(const VolumeRenderJob& job) {
  const Volume& volume = *job.volume;
  if (volume.isColour() || job.mode != VolumeMode::Blend || job.classification == Classification::Pre)
    return std::nullopt;
  const GridGeometry& g = volume.grid();
  if (!g.even() || volume.info().rescale.size() > 1 || !typeFits(volume.type()) ||
      !stridesFit(g, volume.type()) || job.interpolation != Interpolation::Linear)
    return std::nullopt;
  if (std::min({g.columns, g.rows, g.slices}) < 2) return std::nullopt;
  if (mayHoldNoData(volume) && !job.visible) return std::nullopt;  // they say where no-data lies
  FastVolume v;
  v.job = &job;
  v.read.data = reinterpret_cast<const std::uint8_t*>(volume.data());
  const auto size = static_cast<std::int64_t>(bytesOf(volume.type()));
  v.read.stride = {size, size * g.columns, size * g.columns * g.rows};
  v.read.last = {g.columns - 1, g.rows - 1, g.slices - 1};
  v.read.neighbour = v.read.stride;
  v.read.bias = biasOf(volume);
  const bool byTable = job.classification == Classification::PreIntegrated;
  const double least = byTable ? job.preIntegrated->least : job.table->least;
  const double greatest = byTable ? job.preIntegrated->greatest : job.table->greatest;
  v.entries = byTable ? job.preIntegrated->size : job.table->size;
  const ModalityRescale& r = volume.rescaleOf(0);
  const double perValue = (v.entries - 1) / (greatest - least);
  v.placeScale = static_cast<float>(r.slope * perValue);
  v.placeOffset = static_cast<float>((r.slope * v.read.bias + r.intercept - least) * perValue);
  v.lastPlace = static_cast<float>(v.entries - 1);
  byTable ? setTable(v, *job.preIntegrated) : setTable(v, *job.table);
  setShading(v);
  return v;
}

bool rendersFast(const VolumeRenderJob& job) { return fastVolumeOf(job).has_value(); }

}  // namespace vernier::native
