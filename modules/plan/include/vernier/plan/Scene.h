// SPDX-License-Identifier: GPL-3.0-or-later
// Scene: what is to be seen. Plain data, JSON on disk (SceneJson.h). The same Scene drives window, command
// line, goldens and benchmarks. Positions in patient mm (LPS).
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "vernier/base/Frames.h"
#include "vernier/base/HalfSpace.h"
#include "vernier/volume/Mesh.h"
#include "vernier/volume/Sampling.h"
#include "vernier/volume/SharedPoints.h"
#include "vernier/volume/TransferFunction.h"
#include "vernier/volume/Voi.h"

namespace vernier {

inline constexpr int kSceneSchema = 1;

enum class Projection { Orthographic, Perspective };

// For slices the layer's plane is the picture plane and only zoom, height_mm and pan count. For 3-D pictures
// CameraPicture.h says what each number means.
struct Camera {
  double azimuth_deg = 0, elevation_deg = 0, roll_deg = 0;
  Projection projection = Projection::Orthographic;
  double fov_deg = 30;
  double zoom = 1;
  std::optional<double> height_mm;     // height of the picture at zoom 1; absent: fitted to the volume
  glm::dvec2 pan_mm{0, 0};             // shifts the picture's centre right and up, in its own plane
  std::optional<PatientPoint> target;  // 3-D: what the eye looks at; absent: the middle of what is shown
  std::optional<double> distance_mm;   // 3-D: from the target to the eye; absent: the whole box is seen
  double near_mm = 0;                  // 3-D: what is nearer to the eye, along its axis, is not seen
  friend bool operator==(const Camera&, const Camera&) = default;
};

// The plane through `point`; `normal` points towards the viewer, `up` (not parallel to it) is up in the
// picture after projection onto the plane; right = up x normal. Neither needs unit length; degenerate planes
// are refused.
struct Plane {
  PatientPoint point;
  PatientVec normal{0, 0, -1};
  PatientVec up{0, -1, 0};
  friend bool operator==(const Plane&, const Plane&) = default;
};

enum class SlabMode { Max, Min, Mean };
struct Slab {
  double thickness_mm = 0;  // 0: a single slice. The slab is centred on the plane.
  SlabMode mode = SlabMode::Max;
  friend bool operator==(const Slab&, const Slab&) = default;
};

struct Rgb {
  double r = 0, g = 0, b = 0;
  friend bool operator==(const Rgb&, const Rgb&) = default;
};

// One stored frame, unresampled. `source` names an entry of Sources.
struct ImageLayer {
  std::string source;
  std::int64_t index = 0;
  std::optional<VoiWindow> window;                      // absent: the file's first, else automatic
  std::optional<int> voiLut;                            // index of the file's VOI LUT; wins over window
  Interpolation interpolation = Interpolation::Linear;  // of the display zoom: nearest or linear
  bool invert = false;
  bool flipHorizontal = false, flipVertical = false;  // said as FLIPPED on the picture
  std::string presentation;  // SOP Instance UID of a presentation state to be applied; "": none
  friend bool operator==(const ImageLayer&, const ImageLayer&) = default;
};

struct SliceLayer {
  std::string source;
  Plane plane;
  Slab slab;
  Interpolation interpolation = Interpolation::Linear;
  std::optional<VoiWindow> window;
  bool invert = false;
  friend bool operator==(const SliceLayer&, const SliceLayer&) = default;
};

// A curved planar reformat: the sheet that a path sweeps through a volume, laid flat (CurvedGeometry.h): x
// runs along the path, y across it.
enum class CurvedForm { Straightened, Stretched };
struct CurvedLayer {
  std::string source;
  std::vector<PatientPoint> path;  // at least two; the sheet's curve goes through all of them, in order
  CurvedForm form = CurvedForm::Straightened;
  // Up in the picture: at the path's beginning (straightened), everywhere (stretched). Absent: of head,
  // anterior and left the one that is most across the path.
  std::optional<PatientVec> up;
  double width_mm = 50;  // of the sheet, half of it to each side of the path
  Slab slab;             // across the sheet
  Interpolation interpolation = Interpolation::Linear;
  std::optional<VoiWindow> window;
  bool invert = false;
  friend bool operator==(const CurvedLayer&, const CurvedLayer&) = default;
};

// A triangle surface (volume/SurfaceFile.h) in its pose. Alone or with other surfaces: a 3-D picture; over a
// slice: its outline. Opacity 1 ends what a ray sees, below 1 it covers what is behind by that share.
struct SurfaceLayer {
  std::string source;    // names an entry of Sources::meshes
  PatientFromMesh pose;  // affine
  Rgb colour{0.85, 0.85, 0.8};
  double opacity = 1;
  friend bool operator==(const SurfaceLayer&, const SurfaceLayer&) = default;
};

// What a ray through a volume amounts to. Values are trilinear between voxel centres; no-data takes no part.
//   Max, Min, Mean: the value, then the window. Mean: over the length with data.
//   Sum: gain times the integral of the emission, which is the window's grey (0..1), over the ray in mm.
//   Attenuation: what is left of a background of 1 behind a purely absorbing volume, exp(-Sum).
enum class ProjectionMode { Max, Min, Sum, Mean, Attenuation };
struct ProjectionLayer {
  std::string source;
  ProjectionMode mode = ProjectionMode::Max;
  Interpolation interpolation = Interpolation::Linear;  // nearest or linear
  std::optional<VoiWindow> window;                      // absent: all values of the volume
  bool invert = false;
  double cue = 0;  // of Max: grey is multiplied by 1 - cue + cue z', z' of DepthRamp (Volumetric.h); 0..1
  std::optional<double> gain_perMm;  // of Sum and Attenuation; absent: 4 / diagonal of the volume's box
  friend bool operator==(const ProjectionLayer&, const ProjectionLayer&) = default;
};

// Emission shells (Heidrich, Hardware Accelerated Rendering of Emissive Volumes): iso-surfaces of a volume at
// n levels. phi of a level is its grey in the window. Brightness of a point of shell i, sections 2 and 3:
// phi_i (beta0 + beta_m (a z' + b)), z' 1 near and 0 far (DepthRamp).
//   Max: the brightest shell point on the ray, at least beta0 phi0. Sum: all of them added.
//   Lit: the nearest shell, lit from the eye; brightness takes no part.
enum class ShellsMode { Max, Sum, Lit };
// Even: equal steps of value within the window, neither end included. Histogram: between two levels lie
// equally many voxels of those inside the window.
enum class LevelSpread { Even, Histogram };
// Max before an opaque surface. Replace: a shell point shows instead of it, however dark (the paper). Max:
// the brighter of both, in each channel, as projections have it.
enum class SurfaceBlend { Replace, Max };
inline constexpr int kMostLevels = 1024;
struct ShellsLayer {
  std::string source;
  ShellsMode mode = ShellsMode::Max;
  std::vector<double> levels;  // modality values, ascending; empty: `count` of them by `spread`
  int count = 12;
  LevelSpread spread = LevelSpread::Even;
  std::vector<int> disabled;        // places in the list of levels
  std::optional<VoiWindow> window;  // absent: all values of the volume
  double beta0 = 0, betaM = 1, a = 0, b = 1, phi0 = 0;
  bool cueByDistance = false;  // z' falls evenly with the distance instead of the post-projection depth
  Rgb colour{1, 1, 1};         // multiplies the brightness
  SurfaceBlend surfaceBlend = SurfaceBlend::Replace;
  friend bool operator==(const ShellsLayer&, const ShellsLayer&) = default;
};

// How a lit point looks: n the field's gradient turned to the viewer (of length 0: no diffuse, no specular
// part), l to a light, v to the eye, h halfway between the two, all unit, in the patient:
//   I = ambient * own + sum over lights of light * (diffuse * own * max(0, n.l) + specular * max(0,
//   n.h)^power),
// clamped to 0..1; `own` is the point's colour. ambientColour and diffuseColour stand in its place where the
// point has none. Rezk-Salama 2000, equation 6, with its coloured lights; the specular part is ours.
struct Material {
  double ambient = 0.2, diffuse = 0.7, specular = 0.3, power = 20;
  Rgb ambientColour{1, 1, 1}, diffuseColour{1, 1, 1};
  friend bool operator==(const Material&, const Material&) = default;
};

// The gradient that all shading means: along each voxel axis half the difference of the field at one voxel
// further and one voxel back (positions clamped to the box of voxel centres; where there is no data the
// field's value at the point itself), per mm in the patient. It is the trilinear interpolation of central
// differences.

// A look through a volume by a transfer function (Blend), or at one extreme of it.
//   Blend: emission and absorption, front to back: C = integral of tau c exp(-integral of tau), tau of the
//     transfer function's opacity; the scene's background behind it.
//   Max, Min: the greatest or least value on the ray, with its colour at its opacity over the background.
//     Of colour volumes: the greatest or least of each channel times its gain, without the background.
// Colour volumes (red, green, blue, alpha) have no transfer function: gains multiply the channels, the
// results are clamped to 0..1, and alpha is an opacity per smallest voxel spacing.
enum class VolumeMode { Blend, Max, Min };
// Post: the value is interpolated, then looked up. Pre: voxels are looked up, then colour times opacity and
// opacity are interpolated. PreIntegrated: the transfer function is integrated between the values at both
// ends of a step. Absent: the planner takes PreIntegrated where the function is steeper than the step.
enum class Classification { Post, Pre, PreIntegrated };
enum class OpacityRule { Exact, Linear };  // Linear: opacity times length, the papers' approximation
// GlobalAmbient: the paper's variant A, one ambient and one diffuse colour for all values. ColourPerVoxel:
// variant B, the colour of the transfer function.
enum class ShadingModel { None, GlobalAmbient, ColourPerVoxel };

struct VolumeLayer {
  std::string source;
  VolumeMode mode = VolumeMode::Blend;
  std::string preset;                        // name of a transfer function; "": defaultTransferPreset
  std::optional<TransferFunction> transfer;  // wins over the name
  std::array<double, 4> gains{1, 1, 1, 1};   // red, green, blue, alpha of colour volumes
  std::optional<Classification> classification;
  OpacityRule opacity = OpacityRule::Exact;
  Interpolation interpolation = Interpolation::Linear;  // nearest or linear
  ShadingModel shading = ShadingModel::None;
  Material material;
  std::string combiner;   // a shading mode by its file's name; "": what `shading` says
  bool outlines = false;  // slabs and slices that a technique draws are outlined too
  friend bool operator==(const VolumeLayer&, const VolumeLayer&) = default;
};

// The first point of each ray where the trilinear field reaches the level, lit, with the material's own
// colours. A ray that begins inside (at the box, a cut, or the near distance) shows it there, as a face
// turned to the eye.
struct IsosurfaceLayer {
  std::string source;
  std::optional<double> level;  // modality value; absent: defaultIsoLevel
  Material material{0.2, 0.7, 0.3, 20, {1, 0.85, 0.7}, {1, 0.85, 0.7}};
  std::string combiner;
  friend bool operator==(const IsosurfaceLayer&, const IsosurfaceLayer&) = default;
};

// A convex lens (Ropinski, Steinicke, Hinrichs 2005): inside it the layer that looks through the volume, or
// the slice, has another appearance. Where lenses overlap the later layer wins. Shapes are mm in the lens's
// own frame; the pose, affine, brings them into the patient.
struct BoxShape {
  MeshPoint centre;
  glm::dvec3 size_mm{1, 1, 1};
  friend bool operator==(const BoxShape&, const BoxShape&) = default;
};
// A polyhedron with its corners on the sphere: 20 * 4^divisions facets, an icosahedron's divided.
struct SphereShape {
  MeshPoint centre;
  double radius_mm = 1;
  int divisions = 3;  // 0..5
  friend bool operator==(const SphereShape&, const SphereShape&) = default;
};
// Along a trajectory; a cylinder has two equal radii, one radius may be 0. Prism of `sides` around the
// circle.
struct ConeShape {
  MeshPoint from, to;
  double fromRadius_mm = 0, toRadius_mm = 1;
  int sides = 48;  // 3..1000
  friend bool operator==(const ConeShape&, const ConeShape&) = default;
};
struct HullShape {
  SharedPoints points;  // the convex hull of them
  friend bool operator==(const HullShape&, const HullShape&) = default;
};
struct MeshShape {
  std::string source;  // names an entry of Sources::meshes
  bool hull = false;   // a mesh that is not convex: its hull is taken, or it is refused
  friend bool operator==(const MeshShape&, const MeshShape&) = default;
};
using LensShape = std::variant<BoxShape, SphereShape, ConeShape, HullShape, MeshShape>;

// What is inside. CutOut: nothing. SliceLook: of slices; all others: of layers that look through a volume,
// which must be the same volume.
struct CutOut {
  friend bool operator==(const CutOut&, const CutOut&) = default;
};
struct SliceLook {
  Interpolation interpolation = Interpolation::Linear;
  std::optional<VoiWindow> window;
  bool invert = false;
  friend bool operator==(const SliceLook&, const SliceLook&) = default;
};
using LensInner = std::variant<CutOut, SliceLook, ProjectionLayer, ShellsLayer, VolumeLayer, IsosurfaceLayer>;
struct LensLayer {
  LensShape shape = SphereShape{};
  PatientFromMesh pose;
  LensInner inner = CutOut{};
  friend bool operator==(const LensLayer&, const LensLayer&) = default;
};

// A layer of a kind that this build does not know itself, or of a plugin: kept verbatim.
struct CustomLayer {
  std::string kind;
  int version = 1;
  std::string json;  // the whole layer object, canonical text
  friend bool operator==(const CustomLayer&, const CustomLayer&) = default;
};

using Layer = std::variant<ImageLayer, SliceLayer, CurvedLayer, SurfaceLayer, ProjectionLayer, ShellsLayer,
                           VolumeLayer, IsosurfaceLayer, LensLayer, CustomLayer>;
// "image", "slice", "curved", "surface", "projection", "shells", "volume", "isosurface", "lens", or the
// custom kind
VERNIER_API std::string kindOf(const Layer&);
// Projection, shells, volume and isosurface: rays through the whole of a volume, with surfaces as tools in
// it.
VERNIER_API bool looksThroughVolume(const Layer&);
// The volume that a layer of this build's own kinds reads; null: none (stored frames, surfaces, custom).
VERNIER_API const std::string* volumeOf(const Layer&);

// SceneInvalid when a pose is not finite or flattens the surface (determinant 0).
VERNIER_API Result<void> checkPose(const PatientFromMesh&);

// A part of the volume in continuous voxel coordinates (centres at integers); what lies outside is cut away.
struct CropBox {
  VoxelPoint least, greatest;
  friend bool operator==(const CropBox&, const CropBox&) = default;
};

// A light far away. `towards` it, in the patient, of any length but 0; absent: it stands where the eye is.
struct Light {
  std::optional<PatientVec> towards;
  Rgb colour{1, 1, 1};
  friend bool operator==(const Light&, const Light&) = default;
};
inline constexpr std::size_t kMostLights = 4;

struct Scene {
  Camera camera;
  Rgb background;             // display-referred 0..1
  std::vector<Light> lights;  // of shaded volumes and iso-surfaces; none: a white one at the eye
  // Of the layers that look through a volume; surfaces and slices are not cut.
  std::optional<CropBox> crop;
  std::vector<HalfSpace> clip;  // what is kept lies inside all of them
  std::vector<Layer> layers;
  friend bool operator==(const Scene&, const Scene&) = default;
};

}  // namespace vernier
