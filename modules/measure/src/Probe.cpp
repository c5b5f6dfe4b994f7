// SPDX-License-Identifier: GPL-3.0-or-later
// The value at a point: the stored pixel on a frame, and on an acquired slice at a pixel's centre; else
// interpolated. Its +/- is the value's own change over the uncertainty of the place (first order) and half a
// stored step's rounding; noise is not in it.
#include "Region.h"
#include "vernier/volume/Sampling.h"

namespace vernier::measure {
namespace {

// Change per unit of the answer along each direction, from values on both sides, or of one where there is no
// other.
double slope(std::optional<double> below, std::optional<double> here, std::optional<double> above,
             double step) {
  if (below && above) return (*above - *below) / (2 * step);
  if (here && above) return (*above - *here) / step;
  if (here && below) return (*here - *below) / step;
  return 0;
}

void addValue(Work& w, double value, double stored, const std::string& unit, glm::dvec3 gradient,
              double step) {
  w.add("value", value, unit, w.expanded(w.quadratic(gradient) + step * step / 12));
  if (std::isfinite(stored)) w.add("stored value", stored, "1", std::nullopt);
}

void onImage(Work& w, const Spot& at) {
  const ImageFrame& image = *w.image;
  const ImageFrameInfo& f = image.info();
  const auto i = static_cast<std::int64_t>(std::floor(at.x)), j = static_cast<std::int64_t>(std::floor(at.y));
  const auto value = [&](std::int64_t x, std::int64_t y) -> std::optional<double> {
    if (x < 0 || y < 0 || x >= f.columns || y >= f.rows || image.isNoData(image.stored(x, y)))
      return std::nullopt;
    return image.modality(x, y);
  };
  if (!(at.x >= 0 && at.y >= 0 && at.x <= static_cast<double>(f.columns) &&
        at.y <= static_cast<double>(f.rows)))
    refuse("The probe lies outside of the image.");
  if (image.isColour()) refuse("Colours have no values to be measured.");
  const std::int64_t x = std::min(i, f.columns - 1), y = std::min(j, f.rows - 1);
  const auto here = value(x, y);
  if (!here) refuse("There is only padding at this place.");
  const glm::dvec3 gradient{slope(value(x - 1, y), here, value(x + 1, y), w.scale.x),
                            slope(value(x, y - 1), here, value(x, y + 1), w.scale.y), 0};
  const double step = f.type == VoxelType::F32 || f.modalityLut ? 0 : std::abs(f.rescale.slope);
  addValue(w, *here, image.stored(x, y), f.unit, gradient, step);
}

void inVolume(Work& w, const Spot& at) {
  const Volume& v = *w.volume;
  if (v.isColour()) refuse("Colours have no values to be measured.");
  const auto stored = probeStored(v, PatientPoint(at));
  const auto here = sampleModality(v, PatientPoint(at));
  if (!stored || stored->noData || !here)
    refuse("There are no values at this place: outside, padding or missing slices.");
  const glm::dmat3& m = v.grid().patientFromVoxel.linear;
  // Half a voxel to both sides along each axis gives the change per index; the inverse turns it into mm.
  glm::dvec3 perIndex;
  for (int a = 0; a < 3; ++a)
    perIndex[a] = slope(sampleModality(v, PatientPoint(at - 0.5 * m[a])), here,
                        sampleModality(v, PatientPoint(at + 0.5 * m[a])), 0.5);
  const glm::dvec3 gradient = glm::transpose(v.voxelFromPatient().linear) * perIndex;
  const glm::dvec3 p = (v.voxelFromPatient() * PatientPoint(at)).p;
  const glm::dvec3 first = v.grid().even() ? glm::dvec3(0, 0, static_cast<double>(stored->k))
                                           : v.grid().sliceOrigin_vox[static_cast<std::size_t>(stored->k)];
  const glm::dvec3 off =
      glm::abs(p - first - glm::dvec3(static_cast<double>(stored->i), static_cast<double>(stored->j), 0));
  const bool centre = std::max({off.x, off.y, off.z}) <= 1e-9;
  // On an acquired slice a probe reads a pixel, as the readout under the mouse does.
  const bool acquired = off.z <= 1e-3;
  const double step = v.type() == VoxelType::F32 ? 0 : std::abs(v.rescaleOf(stored->k).slope);
  if (!acquired && !centre) {
    w.note("interpolated");
    addValue(w, *here, std::nan(""), v.info().unit, gradient, step);
  } else {
    const bool original = v.original() == nullptr || !v.original()->throughLut;
    addValue(w, stored->modality, original ? stored->stored : std::nan(""), v.info().unit, gradient, step);
  }
}

}  // namespace

void measureProbe(Work& w) {
  if (w.projected()) refuse("A projection has no value at a point; probe a slice.");
  const Spot at = std::get<Probe>(w.what.shape).at;
  if (w.image)
    onImage(w, at);
  else
    inVolume(w, at);
}

}  // namespace vernier::measure
