// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/picture/Describe.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "Millimetres.h"
#include "vernier/plan/Presets.h"

namespace vernier {
namespace {

TextLine plain(std::string text, std::string shortText = {}) {
  return {std::move(text), std::move(shortText), Tone::Normal};
}

bool says(const std::vector<Finding>& findings, const char* code) {
  return std::any_of(findings.begin(), findings.end(), [&](const Finding& f) { return f.code == code; });
}

// "axial" for the patient's own planes, "" for others. Of axes that nobody knows only their names are said.
std::string planeName(PatientVec normal, bool axesKnown) {
  const char* names[] = {"sagittal", "coronal", "axial"};
  const char* unknown[] = {"yz", "xz", "xy"};
  for (int k = 0; k < 3; ++k)
    if (std::abs(normal.v[k]) >= 1 - 1e-9) return axesKnown ? names[k] : unknown[k];
  return "";
}

// "12/28" when the plane goes through the centres of a voxel slice's place on the view's line, else "".
std::string sliceNumber(const GridGeometry& grid, const SlicePicture& picture, PatientPoint point) {
  const SliceAxis axis = sliceAxis(grid, picture.normal);
  std::int64_t nearest = 0;
  double closest_mm = -1;
  for (std::int64_t k = 0; k < axis.count; ++k) {
    const double d = std::abs(dot(slicePoint(grid, picture.normal, k) - point, picture.normal));
    if (closest_mm < 0 || d < closest_mm) closest_mm = d, nearest = k;
  }
  if (closest_mm < 0 || closest_mm > 1e-3) return "";
  return std::to_string(nearest + 1) + "/" + std::to_string(axis.count);
}

std::string slabName(const Slab& slab) {
  const char* names[] = {"MIP", "minIP", "mean"};
  return std::string(names[static_cast<int>(slab.mode)]) + " " + millimetres(slab.thickness_mm);
}

glm::dvec3 stackNormal(const GridGeometry& grid) {
  const glm::dmat3& m = grid.patientFromVoxel.linear;
  return glm::normalize(glm::cross(m[0], m[1]));
}

// How far slices of an uneven stack lie off the straight even line, 0 for stacks that are on it (or only have
// gaps).
double offLine_mm(const GridGeometry& grid) {
  double e_mm = 0;
  double missing = 0;  // steps that gaps have added so far
  for (std::size_t s = 0; s < grid.sliceOrigin_vox.size(); ++s) {
    const auto slice = static_cast<std::int64_t>(s);
    if (s > 0 && std::binary_search(grid.gapAfter.begin(), grid.gapAfter.end(), slice - 1))
      missing += grid.sliceOrigin_vox[s].z - grid.sliceOrigin_vox[s - 1].z - 1;
    const glm::dvec3 off = grid.sliceOrigin_vox[s] - glm::dvec3(0, 0, static_cast<double>(s) + missing);
    e_mm = std::max(e_mm, glm::length(grid.patientFromVoxel.linear * off));
  }
  const glm::dvec3 spacing_mm =
      grid.spacing_mm();  // the limits of docs/studies.md: below them it is harmless
  const double harmless_mm = std::min(0.02 * spacing_mm.z, 0.25 * std::min(spacing_mm.x, spacing_mm.y));
  return e_mm > harmless_mm ? e_mm : 0;
}

// What of the acquisition changes what is seen.
// `across`: it is interpolated from slice to slice.
void describeStack(const VolumeInfo& info, bool across, Annotations& out) {
  const GridGeometry& grid = info.grid;
  const glm::dvec3 normal = stackNormal(grid);
  const glm::dvec3 along = glm::normalize(grid.patientFromVoxel.linear[2]);
  const auto position_mm = [&](std::int64_t slice) {
    return glm::dot(
        normal,
        (grid.patientFromVoxel * VoxelPoint(grid.sliceOrigin_vox[static_cast<std::size_t>(slice)])).p);
  };
  if (!info.bridged)
    for (std::int64_t s : grid.gapAfter) {
      const double a = position_mm(s), b = position_mm(s + 1);
      out.what.push_back(plain("slice missing at " + fixedDigits(std::min(a, b), 1) + ".." +
                                   fixedDigits(std::max(a, b), 1) + " mm",
                               "slice missing"));
    }
  if (info.bridged) out.what.push_back(plain("bridged"));
  const double tilt_deg =
      std::acos(std::min(1.0, std::abs(glm::dot(normal, along)))) * 180 / std::numbers::pi;
  if (tilt_deg >= 0.1) {  // only CT has a gantry; MR slabs are sheared by their prescription
    const std::string tilt = " " + fixedDigits(tilt_deg, 1) + " deg";
    out.what.push_back(plain((info.modality == "CT" ? "gantry tilt" : "slices sheared") + tilt,
                             (info.modality == "CT" ? "tilt" : "shear") + tilt));
  }
  if (across && grid.slices > 1 && grid.spacing_mm().z >= kCoarseStep_mm)
    out.what.push_back(plain("coarse in z"));
  if (const double e_mm = offLine_mm(grid); e_mm > 0)
    out.what.push_back(plain("uneven slices, up to " + fixedDigits(e_mm, 2) + " mm", "uneven slices"));
}

// Where the letters L R A P H F do not apply, the picture says why it has none.
struct NoLetters {
  const char *line, *brief;
};
std::optional<NoLetters> whyNoLetters(const std::vector<Finding>& findings) {
  if (says(findings, "quadruped")) return NoLetters{"quadruped: no letters", "quadruped"};
  if (says(findings, "not-patient-frame"))
    return NoLetters{"transducer's frame: no letters", "transducer's frame"};
  if (says(findings, "axes-unknown")) return NoLetters{"axes not known: no letters", "axes not known"};
  return std::nullopt;
}

void describeVolume(const VolumeInfo& info, Interpolation interpolation, bool across, Annotations& out) {
  if (interpolation == Interpolation::Cubic) out.what.push_back(plain("cubic interpolation", "cubic"));
  describeStack(info, across, out);
  if (info.unscaled) out.what.push_back(plain("unscaled: stored values", "unscaled"));
  if (const auto why = whyNoLetters(info.findings)) out.what.push_back(plain(why->line, why->brief));
}

TextLine windowLine(const VoiWindow& w, const std::string& unit, bool inverted) {
  const std::string both = "C " + plainNumber(w.center, 5) + " W " + plainNumber(w.width, 5);
  const std::string suffix = inverted ? ", inverted" : "";
  // Some files spell their unit out in a sentence: that has no room on a picture.
  const bool named = !unit.empty() && unit != "stored value" && unit.size() <= 10;
  return plain(both + (named ? " " + unit : "") + suffix, both + (inverted ? " inv" : ""));
}

TextLine colourLine(bool inverted) {
  return plain(inverted ? "colour, inverted" : "colour", inverted ? "inv" : "");
}

// The window, or that there is none.
TextLine valueLine(const VoiWindow& w, const VolumeInfo& info, bool inverted) {
  return info.channels > 1 ? colourLine(inverted) : windowLine(w, info.unit, inverted);
}

// To two digits, never below: what is printed must hold.
double roundedUp(double x) {
  if (!(x > 0) || !std::isfinite(x)) return x;
  const double unit = std::pow(10.0, std::floor(std::log10(x)) - 1);
  return std::ceil(x / unit - 1e-9) * unit;
}

}  // namespace

Annotations describeSlice(const SliceLayer& layer, const SlicePicture& picture, const VolumeInfo& info,
                          const VoiWindow& window) {
  Annotations out;
  if (!whyNoLetters(info.findings)) out.letters = edgeLetters(picture);
  out.mmPerPixel = picture.mmPerPixel;
  std::string what = layer.slab.thickness_mm > 0 ? slabName(layer.slab) : "MPR";
  const std::string method = what;
  if (const std::string name = planeName(picture.normal, !says(info.findings, "axes-unknown"));
      !name.empty()) {
    const std::string number = sliceNumber(info.grid, picture, layer.plane.point);
    what += " " + name + (number.empty() ? "" : " " + number);
  }
  out.what.push_back(plain(what, method));
  const bool across =
      std::abs(glm::dot(picture.normal.v, stackNormal(info.grid))) < 0.9999 || layer.slab.thickness_mm > 0;
  describeVolume(info, layer.interpolation, across, out);
  out.status.push_back(valueLine(window, info, layer.invert));
  return out;
}

Annotations describeCurved(const CurvedLayer& layer, const CurvedPicture& picture, const VolumeInfo& info,
                           const VoiWindow& window) {
  Annotations out;
  if (!whyNoLetters(info.findings)) out.letters = edgeLetters(picture);
  out.mmPerPixel = picture.mmPerPixel;
  const std::string method =
      layer.slab.thickness_mm > 0 ? "curved " + slabName(layer.slab) : std::string("curved MPR");
  out.what.push_back(
      plain(method + (layer.form == CurvedForm::Straightened ? ", straightened" : ", stretched"), method));
  describeVolume(info, layer.interpolation, true, out);
  out.status.push_back(valueLine(window, info, layer.invert));
  return out;
}

namespace {

// Which grey transformation is in use: a LUT's name or the window.
TextLine voiLine(const ImageLayer& layer, const ImageFrameInfo& info, const VoiWindow& window,
                 const FramePresentation* state) {
  const auto lutLine = [](const LutTable& lut, const std::string& otherwise) {
    return plain("LUT " + (lut.explanation.empty() ? otherwise : lut.explanation), "LUT");
  };
  if (isColour(info.colour)) return colourLine(layer.invert);
  const auto chosen = layer.voiLut ? static_cast<std::size_t>(*layer.voiLut) : info.voiLuts.size();
  if (chosen < info.voiLuts.size()) return lutLine(info.voiLuts[chosen], std::to_string(chosen + 1));
  if (layer.window || !state || !state->greyscale) return windowLine(window, info.unit, layer.invert);
  if (state->voiLut) return lutLine(*state->voiLut, "of the presentation state");
  // Modality values of a presentation state have no unit that the image could know.
  const bool same = !state->modalityLut && state->rescale == info.rescale && !info.modalityLut;
  if (state->window) return windowLine(*state->window, same ? info.unit : "", layer.invert);
  return plain("whole range of values", "whole range");
}

}  // namespace

Annotations describeImage(const ImageLayer& layer, const ImagePicture& picture, const ImageFrameInfo& info,
                          const VoiWindow& window, const FramePresentation* state) {
  Annotations out;
  if (!whyNoLetters(info.findings)) out.letters = edgeLetters(picture, info);
  // Turning is no mirror image; the letters follow in any case.
  out.flipped = isMirrored(picture);
  out.mmPerPixel = picture.mmPerPixel;
  out.what.push_back(plain(std::to_string(info.index + 1) + "/" + std::to_string(info.count)));
  if (state) {
    out.what.push_back(plain("presentation" + (state->label.empty() ? "" : " " + state->label) + " applied",
                             "presentation"));
    out.graphics = graphicsOf(*state, picture, info);
  }
  if (info.unscaled) out.what.push_back(plain("unscaled: stored values", "unscaled"));
  if (const auto why = whyNoLetters(info.findings)) out.what.push_back(plain(why->line, why->brief));
  if (says(info.findings, "photometric-contradicted"))
    out.what.push_back(plain("colours as the pixels are coded", "colours as coded"));
  out.status.push_back(voiLine(layer, info, window, state));
  return out;
}

Annotations describeSurfaces(const CameraPicture& camera, std::span<const SurfaceFile* const> files,
                             bool withPatient) {
  Annotations out;
  if (withPatient) out.letters = edgeLetters(camera);
  const bool perspective = camera.projection == Projection::Perspective;
  out.mmPerPixel = camera.mmPerPixel();
  out.scaleBar = !perspective;
  std::uint64_t triangles = 0;
  for (const SurfaceFile* f : files) triangles += f->mesh->triangles().size();
  const std::string name = files.size() == 1 ? "surface" : std::to_string(files.size()) + " surfaces";
  out.what.push_back(plain(name + (perspective ? ", perspective" : ""), name));
  out.what.push_back(plain("mm assumed"));
  out.status.push_back(plain(std::to_string(triangles) + " triangles"));
  return out;
}

namespace {

// What all looks through a volume say.
Annotations lookThrough(const CameraPicture& camera, const VolumeInfo& info, bool cut) {
  Annotations out;
  if (!whyNoLetters(info.findings)) out.letters = edgeLetters(camera);
  const bool perspective = camera.projection == Projection::Perspective;
  out.mmPerPixel = camera.mmPerPixel();
  out.scaleBar = !perspective;
  if (perspective) out.what.push_back(plain("perspective"));
  if (cut) out.what.push_back(plain("cut open", "cut"));
  describeVolume(info, Interpolation::Linear, true, out);
  return out;
}

const char* nameOf(ProjectionMode mode) {
  switch (mode) {
    case ProjectionMode::Max:
      return "MIP";
    case ProjectionMode::Min:
      return "MinIP";
    case ProjectionMode::Sum:
      return "sum along rays";
    case ProjectionMode::Mean:
      return "mean along rays";
    case ProjectionMode::Attenuation:
      break;
  }
  return "attenuation";
}

}  // namespace

Annotations describeProjection(const ProjectionLayer& layer, const CameraPicture& camera,
                               const VolumeInfo& info, const VoiWindow& window, bool cut) {
  Annotations out = lookThrough(camera, info, cut);
  std::string name = nameOf(layer.mode);
  if (layer.cue > 0) name += ", depth cue " + plainNumber(layer.cue, 2);
  if (layer.interpolation == Interpolation::Nearest) name += ", nearest";
  out.what.insert(out.what.begin(), plain(name, nameOf(layer.mode)));
  out.status.push_back(windowLine(window, info.unit, layer.invert != info.inverted));
  return out;
}

Annotations describeShells(const ShellsLayer& layer, const CameraPicture& camera, const VolumeInfo& info,
                           const VoiWindow& window, bool cut) {
  Annotations out = lookThrough(camera, info, cut);
  const std::size_t levels =
      layer.levels.empty() ? static_cast<std::size_t>(layer.count) : layer.levels.size();
  const char* const mode = layer.mode == ShellsMode::Max   ? "max"
                           : layer.mode == ShellsMode::Sum ? "sum"
                                                           : "lit";
  std::string name = std::to_string(levels) + " emission shell" + (levels == 1 ? "" : "s") + ", " + mode;
  if (!layer.disabled.empty()) name += ", " + std::to_string(layer.disabled.size()) + " off";
  if (layer.a > 0 && layer.mode != ShellsMode::Lit) name += ", depth cue " + plainNumber(layer.a, 2);
  if (layer.mode == ShellsMode::Max)
    out.what.insert(out.what.begin(), plain("no bound of the maximum", "no bound"));
  out.what.insert(out.what.begin(), plain(name, std::to_string(levels) + " shells"));
  out.status.push_back(windowLine(window, info.unit, false));
  return out;
}

Annotations describeRendering(const VolumeLayer& layer, const CameraPicture& camera, const VolumeInfo& info,
                              bool cut) {
  Annotations out = lookThrough(camera, info, cut);
  std::string name = layer.mode == VolumeMode::Blend ? "DVR"
                     : layer.mode == VolumeMode::Max ? "volume maximum"
                                                     : "volume minimum";
  if (layer.shading != ShadingModel::None) name += ", shaded";
  if (!layer.combiner.empty()) name += ", " + layer.combiner;
  if (layer.interpolation == Interpolation::Nearest) name += ", nearest";
  if (layer.opacity == OpacityRule::Linear) name += ", linear opacity";
  out.what.insert(out.what.begin(), plain(name, "DVR"));
  if (info.channels == 1)
    out.status.push_back(plain(layer.preset.empty() ? "transfer function of its own"
                               : layer.transfer     ? "transfer " + layer.preset + ", changed"
                                                    : "transfer " + layer.preset));
  return out;
}

Annotations describeIsosurface(const IsosurfaceLayer& layer, const CameraPicture& camera,
                               const VolumeInfo& info, bool cut) {
  Annotations out = lookThrough(camera, info, cut);
  out.what.insert(
      out.what.begin(),
      plain("iso-surface" + (layer.level ? " " + plainNumber(*layer.level, 2) + " " + info.unit : ""),
            "iso"));
  return out;
}

TextLine errorLine(double bound, int confidence_percent, std::optional<double> limit) {
  // Below a hundredth of a level the exact figure (it is in the report) says nothing more to a reader.
  const std::string number = bound > 0 && bound < 0.01 ? "< 0.01" : "<= " + plainNumber(roundedUp(bound), 2);
  return {"error " + number + " of 255 (" + std::to_string(confidence_percent) + " %)", number + "/255",
          limit && bound > *limit ? Tone::Amber : Tone::Normal};
}

}  // namespace vernier
