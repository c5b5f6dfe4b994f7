// SPDX-License-Identifier: GPL-3.0-or-later
// The rays of one layer that looks through a volume: which part of each takes part, what tools stand on it,
// and the pieces of the field along it. Reference.h says what is meant.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "BrickRanges.h"
#include "Brightness.h"
#include "SurfaceReference.h"

namespace vernier::quality {

struct RayTool {
  double t_mm = 0;
  glm::dvec3 colour{0};  // lit
  double opacity = 1;
};

// What begins or ends the part of a ray that takes part.
enum class Border { Box, Cut, Near, Tool, Lens };

struct VolumeRay {
  PixelRay line;
  double begin_mm = 0, end_mm = -1;  // the part before the first opaque tool; empty: begin >= end
  Border begunBy = Border::Box, endedBy = Border::Box;
  glm::dvec3 beginNormal{0, 0, 1};  // of what it begins at, patient, unit
  // The ray goes on there with the same level sets, so that none is cut open.
  bool beginsOpen = false, endsOpen = false;
  std::vector<RayTool> tools;   // translucent, before the first opaque one, nearest first
  std::vector<double> through;  // what is left of light behind none, one, ... all of them
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
  glm::dvec3 from_vox, across_vox;  // where it lies: from_vox + u across_vox, u in [0, 1]
  double length_mm() const { return end_mm - begin_mm; }
  double at(double u) const { return begin_mm + u * (end_mm - begin_mm); }
};

// What a ray shows of a layer that looks through a volume and of the tools in it.
struct VolumeSeen {
  glm::dvec3 colour{0};
  bool shown = false;    // the layer shows something
  bool covered = false;  // it does, or a tool does
  std::optional<double> value;
};

// What a part of a ray without tools in it shows of a layer that is gathered front to back, and what it lets
// through.
struct PartSeen {
  glm::dvec3 colour{0};
  double left = 1;
};

// What tells whether an edge runs between a part of a ray and that of a neighbour.
struct PartMark {
  bool shown = false;                                       // the layer shows something there
  bool bordered = true;                                     // its ends may be seen
  double left = 1;                                          // of light, as far as is known
  double end_mm = std::numeric_limits<double>::infinity();  // nothing behind is seen
};

// The box of voxel centres, in the Voxel frame. Slices that wander widen it by as much.
struct CentreBox {
  glm::dvec3 least{0}, greatest{0};
  glm::dvec3 hold(glm::dvec3 p) const { return glm::clamp(p, least, greatest); }
};
CentreBox centreBox(const GridGeometry&);

class VolumeRays {
 public:
  enum class Colours { Refused, Taken };
  // SceneInvalid: the volume is missing or in colour where that is refused, an empty or infinite crop box, a
  // clip plane without direction, a window without width. GeometryRefused: a single slice, row or column.
  static Result<VolumeRays> make(const Scene&, const std::string& source, Interpolation,
                                 const std::optional<VoiWindow>&, const View&, const Sources&,
                                 Colours = Colours::Refused);
  // Let z' fall evenly with depth in perspective too.
  void cueByDistance() { fall_.projected = false; }

  const Volume& volume() const { return *volume_; }
  Interpolation interpolation() const { return interpolation_; }
  // The one whose field says where there is data: of a colour volume the alpha, else the first channel.
  const Volume& fieldVolume() const { return *field_; }
  const VoiWindow& window() const { return window_; }
  const RayCamera& camera() const { return camera_; }
  const SurfaceReference& surfaces() const { return surfaces_; }
  double diagonal_mm() const { return diagonal_mm_; }
  double largestSpacing_mm() const {
    const glm::dvec3 s = volume_->grid().spacing_mm();
    return std::max({s.x, s.y, s.z});
  }

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
    alongStops(ray, [&](const Stretch& s) { return alongStretch(s, 0, 1, fn); });
  }
  // The same without the pieces in bricks of which needed(brick) is false when the ray gets to them. All
  // pieces where the grid has no bricks (findBricks).
  template <class Needed, class Fn>
  void alongBricks(const VolumeRay& ray, Needed&& needed, Fn&& fn) const {
    if (!bricks_ || !bricks_->inPlace()) return alongData(ray, fn);
    alongStops(ray, [&](const Stretch& s) {
      for (const BrickRanges::Passage& p : bricks_->passages(s.from_vox, s.across_vox))
        if (needed(p.brick) && !alongStretch(s, p.begin, p.end, fn)) return false;
      return true;
    });
  }
  // Reads all voxels, for alongBricks and for the population.
  void findBricks() { bricks_ = std::make_shared<const BrickRanges>(*field_); }
  const std::shared_ptr<const BrickRanges>& bricks() const { return bricks_; }
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
  // Of a ray, between two stops.
  struct Stretch {
    double from_mm = 0, length_mm = 0;
    std::size_t passed = 0;
    glm::dvec3 from_vox{0}, across_vox{0};
  };
  template <class Fn>
  void alongStops(const VolumeRay& ray, Fn&& fn) const {
    if (!(ray.begin_mm < ray.end_mm)) return;
    const glm::dvec3 origin = voxelAt(ray, 0),
                     perMm = volume_->voxelFromPatient().linear * ray.line.direction;
    const std::vector<double> stops = stopsOf(ray);
    for (std::size_t n = 0; n + 1 < stops.size(); ++n) {
      const double from = stops[n], length = stops[n + 1] - from;
      const auto passed = static_cast<std::size_t>(std::count_if(
          ray.tools.begin(), ray.tools.end(), [&](const RayTool& t) { return t.t_mm <= from; }));
      if (!fn(Stretch{from, length, passed, origin + from * perMm, length * perMm})) return;
    }
  }
  // From `begin` to `end` of it, in [0, 1].
  template <class Fn>
  bool alongStretch(const Stretch& s, double begin, double end, Fn&& fn) const {
    const Field field(*field_, interpolation_);
    const double from_mm = s.from_mm + begin * s.length_mm, length_mm = (end - begin) * s.length_mm;
    const glm::dvec3 from = s.from_vox + begin * s.across_vox, across = (end - begin) * s.across_vox;
    bool going = true;
    field.alongLine(from, across, nullptr, [&](const Piece& p) {
      going = fn(RayPart{p, from_mm + p.begin * length_mm, from_mm + p.end * length_mm, s.passed,
                         from + p.begin * across, (p.end - p.begin) * across});
      return going;
    });
    return going;
  }
  std::vector<double> stopsOf(const VolumeRay&) const;

  std::shared_ptr<const Volume> volume_;
  const Volume* field_ = nullptr;  // the volume, or a channel of it
  std::shared_ptr<const BrickRanges> bricks_;
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
