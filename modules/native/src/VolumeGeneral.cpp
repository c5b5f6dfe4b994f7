// SPDX-License-Identifier: GPL-3.0-or-later
// Volume rendering in double, sample by sample, with every rule of the grid.
#include <array>

#include "GeneralSampler.h"
#include "VolumeRay.h"

namespace vernier::native {
namespace {

// What a step shows: colour not multiplied, opacity of a whole step.
struct Shown {
  glm::dvec3 colour{0};
  double opacity = 0;
};

double overStep(const VolumeRenderJob& job, double opacity, double length_mm) {
  const double lengths = job.step_mm / length_mm;
  return job.opacity == OpacityRule::Linear ? opacityOverLinear(opacity, lengths)
                                            : opacityOver(opacity, lengths);
}

Shown post(const VolumeRenderJob& job, double value) {
  const double opacity = overStep(job, opacityAt(*job.function, value), job.function->opacityLength_mm);
  return {colourAt(*job.function, value), opacity};
}

template <class T>
Shown pre(const GeneralSampler<T>& sampler, const VolumeRenderJob& job, const glm::dvec3& p,
          std::uint64_t& samples) {
  std::uint64_t again = 0;
  const TransferFunction& f = *job.function;
  const double a =
      sampler.mapped(job.interpolation, p, samples, [&](double value) { return opacityAt(f, value); });
  if (!(a > 0)) return {};
  Shown out;
  for (int c = 0; c < 3; ++c)
    out.colour[c] = sampler.mapped(job.interpolation, p, again, [&](double value) {
      return opacityAt(f, value) * colourAt(f, value)[c];
    }) / a;
  out.opacity = overStep(job, a, f.opacityLength_mm);
  return out;
}

// Bilinear between the entries of the table.
Shown preIntegrated(const PreIntegratedTable& t, double front, double back) {
  if (std::isnan(front)) front = back;
  if (std::isnan(back)) back = front;
  if (std::isnan(front)) return {};
  const double scale = (t.size - 1) / (t.greatest - t.least);
  const auto place = [&](double v, std::size_t& low) {
    const double x = std::clamp((v - t.least) * scale, 0.0, static_cast<double>(t.size - 1));
    low = std::min(static_cast<std::size_t>(x), static_cast<std::size_t>(t.size) - 2);
    return x - static_cast<double>(low);
  };
  std::size_t i = 0, j = 0;
  const double x = place(front, i), y = place(back, j);
  const auto n = static_cast<std::size_t>(t.size);
  std::array<double, 4> out{};
  for (std::size_t c = 0; c < 4; ++c) {
    const auto at = [&](std::size_t a, std::size_t b) {
      return static_cast<double>(t.rgba[4 * (a + n * b) + c]);
    };
    out[c] = std::lerp(std::lerp(at(i, j), at(i + 1, j), x), std::lerp(at(i, j + 1), at(i + 1, j + 1), x), y);
  }
  if (!(out[3] > 0)) return {};
  return {glm::dvec3(out[0], out[1], out[2]) / out[3], out[3]};
}

}  // namespace

GeneralBlend::GeneralBlend(const VolumeRenderJob& job)
    : job_(job), lighting_(job.material, job.lights), patientGradient_(patientGradients(*job.volume)) {
  const GridGeometry& g = job.volume->grid();
  first_ = {0, 0, g.firstPosition_vox()};
  last_ = {static_cast<double>(g.columns - 1), static_cast<double>(g.rows - 1), g.lastPosition_vox()};
}

template <class T>
void GeneralBlend::stepsOf(const VoxelRay& ray, const glm::dvec3& direction, double from, double to,
                           std::int64_t begin, std::int64_t end, RayLight& light,
                           ProjectionWork& work) const {
  const GeneralSampler<T> sampler(*job_.volume);
  const auto at = [&](double k) { return glm::clamp(ray.at(k * job_.step_mm), first_, last_); };
  const auto value = [&](const glm::dvec3& p) { return sampler.value(job_.interpolation, p, work.samples); };
  const bool byTable = job_.classification == Classification::PreIntegrated;
  double front = byTable ? value(at(static_cast<double>(begin))) : 0;
  for (std::int64_t k = begin; k < end && light.through >= job_.leastLight; ++k) {
    const glm::dvec3 p = at(static_cast<double>(k) + 0.5);
    Shown shown;
    double centre = std::numeric_limits<double>::quiet_NaN();
    if (byTable) {
      const double back = value(at(static_cast<double>(k + 1)));
      shown = preIntegrated(*job_.preIntegrated, front, back);
      front = back;
    } else if (job_.classification == Classification::Pre) {
      shown = pre(sampler, job_, p, work.samples);
    } else {
      centre = value(p);
      if (!std::isnan(centre)) shown = post(job_, centre);
    }
    const StepShare share = shareOf(k, job_.step_mm, from, to);
    if (!(shown.opacity > 0) || !(share.weight > 0)) continue;
    if (job_.shading != ShadingModel::None) {
      std::uint64_t unused = 0;
      const auto field = [&](const glm::dvec3& q) { return sampler.linear(q, unused); };
      const double middle = field(p);
      const glm::dvec3 g =
          std::isnan(middle) ? glm::dvec3(0) : patientGradient_ * gradientAt(field, p, middle, last_);
      const bool own = job_.shading == ShadingModel::ColourPerVoxel;
      shown.colour = lighting_.lit(own ? shown.colour : colourOf(job_.material.ambientColour),
                                   own ? shown.colour : colourOf(job_.material.diffuseColour), g, -direction);
    }
    const double opacity = share.weight < 1 ? opacityOver(shown.opacity, share.weight) : shown.opacity;
    light.add(opacity * shown.colour, opacity, share.from_mm, share.to_mm);
  }
}

void GeneralBlend::steps(const VoxelRay& ray, const glm::dvec3& direction, double from, double to,
                         std::int64_t begin, std::int64_t end, RayLight& light, ProjectionWork& work) const {
  switch (job_.volume->type()) {
    case VoxelType::U8:
      return stepsOf<std::uint8_t>(ray, direction, from, to, begin, end, light, work);
    case VoxelType::I8:
      return stepsOf<std::int8_t>(ray, direction, from, to, begin, end, light, work);
    case VoxelType::U16:
      return stepsOf<std::uint16_t>(ray, direction, from, to, begin, end, light, work);
    case VoxelType::I16:
      return stepsOf<std::int16_t>(ray, direction, from, to, begin, end, light, work);
    case VoxelType::U32:
      return stepsOf<std::uint32_t>(ray, direction, from, to, begin, end, light, work);
    case VoxelType::I32:
      return stepsOf<std::int32_t>(ray, direction, from, to, begin, end, light, work);
    case VoxelType::F32:
      break;
  }
  return stepsOf<float>(ray, direction, from, to, begin, end, light, work);
}

void GeneralBlend::along(const VoxelRay& ray, const glm::dvec3& direction, double from, double to,
                         const RayMarks& marks, RayLight& light, ProjectionWork& work) const {
  if (!(to > from)) return;
  const Steps met = native::stepsOf(from, to, job_.step_mm, false);
  marks.eachRun(met.first, met.first + met.count - 1, [&](std::int64_t begin, std::int64_t end) {
    steps(ray, direction, from, to, begin, end, light, work);
    return light.through >= job_.leastLight;
  });
}

}  // namespace vernier::native
