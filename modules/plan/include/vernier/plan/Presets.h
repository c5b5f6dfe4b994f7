// SPDX-License-Identifier: GPL-3.0-or-later
// View names that expand to a Scene: stack axial coronal sagittal oblique slab curved, and through the volume
// mip minip sum mean attenuation shells shells-sum shells-lit dvr dvr-shaded iso lens. Conventions (DICOM
// LPS): axial is seen from the feet (patient right on screen left, anterior up), coronal from the front,
// sagittal from the patient's left (anterior on screen left), H up. They mean the patient's planes, whatever
// the acquisition's were, and show the whole box of the volume (the fit of PictureGeometry.h). oblique has
// the axes right and up of the 3-D camera at azimuth 30, elevation 20 and shows a square whose side is the
// longest edge of the box of voxel centres (as the peer programs do); slab is oblique, 10 mm thick, maximum.
// lens is dvr with a sphere about the middle of that box that shows the iso-surface.
//
// Slice numbers count from 0 along the voxel axis closest to the view's normal (slices before rows before
// columns when two are as close), in the volume's own order. The plane passes through the centre of that
// voxel slice, and through the volume's centre line along the normal; in an orthogonal volume it passes
// exactly through voxel centres. The default is the middle slice, count / 2.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "vernier/plan/Scene.h"
#include "vernier/volume/Volume.h"

namespace vernier {

inline constexpr double kPresetSlab_mm = 10;     // of the view slab
inline constexpr double kLensViewRadius = 0.25;  // of the view lens: its sphere's, of the box's diagonal

struct PresetOptions {
  std::optional<std::int64_t>
      slice;  // stack: frame index; axial, coronal, sagittal: voxel slice; absent: the middle
  std::optional<Plane> plane;         // replaces the preset's plane; cannot be given together with slice
  std::optional<Slab> slab;           // `slab` alone: 10 mm, max
  std::optional<CurvedLayer> curved;  // of the view curved: its path, form, up and width count
  std::optional<ProjectionLayer> projection;  // of mip .. attenuation: its cue and gain count
  std::optional<ShellsLayer> shells;          // of shells..: all but source, mode and window counts
  std::optional<VolumeLayer> volume;          // of dvr.., lens: all but source, and shading unless given
  std::optional<IsosurfaceLayer> iso;         // of iso: all but source
  std::vector<Light> lights;                  // of dvr-shaded and iso
  std::optional<VoiWindow> window;
  Interpolation interpolation = Interpolation::Linear;
  Camera camera;  // zoom, pan; height_mm when it is to differ from the preset's
};

// The view names of the command line, built or not, and the plugin that a name needs ("" for an unknown
// name).
VERNIER_API const std::vector<std::string>& viewNames();
VERNIER_API std::string pluginOfView(const std::string& viewName);

// What the shells of a view are without options: 12 even levels; shells-lit 3, since only the outermost is
// seen and the lowest of many levels is noise; shells-sum with b = 1 / levels, so that one crossing in and
// out of every shell is about white.
VERNIER_API ShellsLayer shellsOfView(const std::string& viewName);

// The plane of the view oblique: through the volume's centre, with the axes of the 3-D camera at azimuth 30,
// elevation 20.
VERNIER_API Plane obliquePlane(const GridGeometry&);

// Of the box of voxel centres; of a single voxel its own.
VERNIER_API double longestEdge_mm(const GridGeometry&);

// The voxel axis (0 columns, 1 rows, 2 slices) along which a view with this normal scrolls, and how many
// slices it has.
struct SliceAxis {
  int axis = 2;
  std::int64_t count = 0;
};
VERNIER_API SliceAxis sliceAxis(const GridGeometry&, PatientVec normal);
// Where the plane of voxel slice `index` of that axis meets the line along `normal` through the volume's
// centre.
VERNIER_API PatientPoint slicePoint(const GridGeometry&, PatientVec normal, std::int64_t index);

// For a volume (all but `stack`). SceneInvalid for an unknown name or for `stack`, NotBuiltYet for a name
// that a later plugin brings, OptionInvalid for a slice that the volume does not have or that the view does
// not take.
VERNIER_API Result<Scene> presetScene(const std::string& viewName, const std::string& source,
                                      const GridGeometry&, const PresetOptions&);
inline Result<Scene> presetScene(const std::string& viewName, const std::string& source, const Volume& volume,
                                 const PresetOptions& options) {
  return presetScene(viewName, source, volume.grid(), options);
}
// The `stack` view: needs no geometry. options.slice is not looked at: `index` is what it became.
VERNIER_API Scene stackScene(const std::string& source, std::int64_t index, const PresetOptions&);

}  // namespace vernier
