// SPDX-License-Identifier: GPL-3.0-or-later
// The rays of one layer that looks through a volume: which part of each takes part, what tools stand on it,
// and the pieces of the field along it. Reference.h says what is meant.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "Brightness.h"
#include "SurfaceReference.h"

namespace vernier::quality {

struct RayTool {
  double t_mm = 0;
  glm::dvec3 colour{0};  // lit
  double opacity = 1;
};

// What begins or ends the part of a ray that takes part.
enum class Border { Box, Cut, Near, Tool };

struct VolumeRay {
  PixelRay line;
  double begin_mm = 0, end_mm = -1;  // the part before the first opaque tool; empty: begin >= end
  Border begunBy = Border::Box, endedBy = Border::Box;
  glm::dvec3 beginNormal{0, 0, 1};  // of what it begins at, patient, unit
  std::vector<RayTool> tools;       // translucent, before the first opaque one, nearest first
  std::vector<double> through;      // what is left of light behind none, one, ... all of them
  std::optional<RayTool> opaque;
  std::size_t opaqueLayer = 0;

  glm::dvec3 backdrop(glm::dvec3 otherwise) const {
    return through.back() * (opaque ? opaque->colour : otherwise);
  }
};

// A piece of a ray: the field on it, from `begin_mm` to `end_mm`, behind `passed` translucent tools.
struct RayPart {
  const Piece& piece;
  double begin_mm, end_mm;
  std::size_t passed;
  double length_mm() const { return end_mm - begin_mm; }
  double at(double u) const { return begin_mm + u * (end_mm - begin_mm); }
};

class VolumeRays {
 public:
  // SceneInvalid: the volume is missing or in colour, an empty or infinite crop box, a clip plane without
  // direction, a window without width. GeometryRefused: a single slice, row or column.
  static Result<VolumeRays> make(const Scene&, const std::string& source, Interpolation,
                                 const std::optional<VoiWindow>&, const View&, const Sources&);
  // Let z' fall evenly with depth in perspective too.
  void cueByDistance() { fall_.projected = false; }

  const Volume& volume() const { return *volume_; }
  const VoiWindow& window() const { return window_; }
  const RayCamera& camera() const { return camera_; }
  const SurfaceReference& surfaces() const { return surfaces_; }
  double diagonal_mm() const { return diagonal_mm_; }

  VolumeRay ray(glm::dvec2 pixel) const;
  // Whether a box (corners in the Voxel frame) lies outside of one of the bounds, or before the near
  // distance, as a whole. False tells nothing.
  bool keepsNoneOf(const std::array<glm::dvec3, 8>& corners_vox) const;
  // What two pixels share unless an edge runs between them: tools, how the ray's part begins and ends, and
  // `shown`.
  static std::uint64_t edgeKey(const VolumeRay&, bool shown);

  // z' at a place of the ray, and k0 + k1 z' along a part of it.
  double z(const VolumeRay&, double t_mm) const;
  Cue cue(const VolumeRay&, const RayPart&, double k0, double k1) const;

  // Calls fn(part) for every piece with data, in ascending order, until it returns false.
  template <class Fn>
  void alongData(const VolumeRay& ray, Fn&& fn) const {
    if (!(ray.begin_mm < ray.end_mm)) return;
    const Field field(*volume_, interpolation_);
    const glm::dvec3 origin = voxelAt(ray, 0),
                     perMm = volume_->voxelFromPatient().linear * ray.line.direction;
    const std::vector<double> stops = stopsOf(ray);
    bool going = true;
    for (std::size_t n = 0; going && n + 1 < stops.size(); ++n) {
      const double from = stops[n], length = stops[n + 1] - from;
      const auto passed = static_cast<std::size_t>(std::count_if(
          ray.tools.begin(), ray.tools.end(), [&](const RayTool& t) { return t.t_mm <= from; }));
      field.alongLine(origin + from * perMm, length * perMm, nullptr, [&](const Piece& p) {
        going = fn(RayPart{p, from + p.begin * length, from + p.end * length, passed});
        return going;
      });
    }
  }
  glm::dvec3 voxelAt(const VolumeRay& ray, double t_mm) const {
    return (volume_->voxelFromPatient() * PatientPoint(ray.line.at(t_mm))).p;
  }
  // Unit, patient: the gradient of the field in the cell around `cell_mm`, at t_mm; of no direction: 0.
  glm::dvec3 gradient(const VolumeRay&, double t_mm, double cell_mm) const;

 private:
  VolumeRays(SurfaceReference surfaces) : surfaces_(std::move(surfaces)) {}
  // A half-space: inside where its value is not above 0; in voxel coordinates or in the patient.
  struct Bound {
    bool inVoxels = true;
    glm::dvec3 gradient{0};  // of its value
    double offset = 0;
    glm::dvec3 normal{0};  // patient, unit
    Border border = Border::Box;
  };
  static Result<std::vector<Bound>> boundsOf(const Scene&, const GridGeometry&);
  void keep(VolumeRay&) const;
  std::vector<double> stopsOf(const VolumeRay&) const;

  std::shared_ptr<const Volume> volume_;
  Interpolation interpolation_ = Interpolation::Linear;
  VoiWindow window_;
  RayCamera camera_;
  SurfaceReference surfaces_;
  std::vector<Bound> bounds_;
  double diagonal_mm_ = 0;
  struct Fall {
    double near_mm = 0, far_mm = 1;  // depths
    bool projected = false;
  };
  static Fall fallOf(const RayCamera&, const GridGeometry&);
  Fall fall_;
};

}  // namespace vernier::quality
