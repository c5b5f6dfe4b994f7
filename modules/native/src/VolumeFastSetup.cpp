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

// The table goes behind those that are there; where it may show something: between `from` and `to`.
struct Seen {
  float from = 0, to = -1;
};

Seen addTable(FastVolume& v, const TransferTable& t) {
  const auto n = static_cast<std::size_t>(t.size);
  std::size_t first = n, last = 0;
  for (std::size_t k = 0; k <= n; ++k) {
    const std::size_t here = std::min(k, n - 1), next = std::min(k + 1, n - 1);
    const float opacity = t.rgba[4 * here + 3];
    v.opacity.push_back(opacity);
    if (opacity > 0 && k < n) first = std::min(first, k), last = k;
    for (std::size_t c = 0; c < 3; ++c)
      v.colour[c].push_back(packed(t.rgba[4 * here + c], t.rgba[4 * next + c]));
  }
  // Strictly between them; nothing at all where the first lies behind the last.
  return {static_cast<float>(first) - 1, static_cast<float>(last) + 1};
}

Seen addTable(FastVolume& v, const PreIntegratedTable& t) {
  const std::size_t n = t.rgba.size() / 4;
  for (std::size_t k = 0; k < n; ++k) {
    v.opacity.push_back(t.rgba[4 * k + 3]);
    for (std::size_t c = 0; c < 3; ++c) v.lit[c].push_back(t.rgba[4 * k + c]);
  }
  return {-1, static_cast<float>(t.size)};
}

struct TablePlace {
  float scale = 0, offset = 0;
};
TablePlace placeIn(const FastVolume& v, double least, double greatest, int entries) {
  const ModalityRescale& r = v.job->volume->rescaleOf(0);
  const double perValue = (entries - 1) / (greatest - least);
  return {static_cast<float>(r.slope * perValue),
          static_cast<float>((r.slope * v.read.bias + r.intercept - least) * perValue)};
}

void addLook(FastVolume& v, std::size_t first, int entries, TablePlace place, Seen seen) {
  FastLooks& l = v.looks;
  l.placeScale.push_back(place.scale), l.placeOffset.push_back(place.offset);
  l.lastPlace.push_back(static_cast<float>(entries - 1));
  l.seenFrom.push_back(seen.from), l.seenTo.push_back(seen.to);
  l.first.push_back(static_cast<std::int32_t>(first)), l.entries.push_back(entries);
}

void addInsides(FastVolume& v) {
  const VolumeRenderJob& job = *v.job;
  addLook(v, 0, v.entries, {v.placeScale, v.placeOffset}, {v.seenFrom, v.seenTo});
  for (const VolumeInside& inside : job.insides) {
    const std::size_t first = v.opacity.size();
    if (!inside.function) {
      v.opacity.insert(v.opacity.end(), 4, 0.0f);
      for (auto& c : v.colour) c.insert(c.end(), 4, 0);
      for (auto& c : v.lit) c.insert(c.end(), 4, 0.0f);
      addLook(v, first, 2, {}, {});
    } else if (job.classification == Classification::PreIntegrated) {
      const PreIntegratedTable& t = *inside.preIntegrated;
      const Seen seen = addTable(v, t);
      addLook(v, first, t.size, placeIn(v, t.least, t.greatest, t.size), seen);
    } else {
      const TransferTable& t = *inside.table;
      const Seen seen = addTable(v, t);
      addLook(v, first, t.size, placeIn(v, t.least, t.greatest, t.size), seen);
    }
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
  const TablePlace place = placeIn(v, least, greatest, v.entries);
  v.placeScale = place.scale, v.placeOffset = place.offset;
  v.lastPlace = static_cast<float>(v.entries - 1);
  const Seen seen = byTable ? addTable(v, *job.preIntegrated) : addTable(v, *job.table);
  v.seenFrom = seen.from, v.seenTo = seen.to;
  if (!job.insides.empty()) addInsides(v);
  setShading(v);
  return v;
}

bool rendersFast(const VolumeRenderJob& job) { return fastVolumeOf(job).has_value(); }

}  // namespace vernier::native
