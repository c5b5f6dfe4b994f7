// SPDX-License-Identifier: GPL-3.0-or-later
// The truth that pictures are measured against: pixels of a scene in double precision, each on its own, at
// the pixel's centre. Slices and images; surfaces by themselves (beside a slice they are outlines, which no
// error is taken of); one layer that looks through a volume, with the surfaces as its tools; layers of
// plugins that bring their own truth. A scene with any other layer or mixture is refused (NotBuiltYet).
//
// Shares with the engines only the scene, voxel access, and what stands where nobody chose: the default
// window, a set of shells' levels, transfer functions by name, the level of an iso-surface. Camera and plane
// geometry, transfer functions, gradients and lights, interpolation (GridGeometry.h: true slice positions,
// gaps, border held for half a voxel, no-data renormalised over the valid corners), windows (PS3.3
// C.11.2.1.2) and compositing are its own.
//
// A slab is the line through [-T/2, T/2] along the normal, cut at every cell face, gap and border. Along each
// piece a trilinear field is a cubic (next to no-data a ratio of two cubics): its maximum and minimum come
// from the roots of the derivative, its mean from exact integration over the valid length. So nothing can be
// stepped over.
//
// Surfaces: every triangle that the pixel's ray meets, in double, in order along the ray.
//
// Layers that look through a volume. On a pixel's ray, distances in mm from the lattice's origin:
//   Span   what lies in the closed box of voxel centres, the crop box and the clip planes, not before
//          the near distance or the eye, and before the first opaque tool. Tools are not cut. Within
//          it the field is that of slices: nearest or trilinear, no-data renormalised over the valid
//          corners, gaps empty.
//   Tools  have the colours of surfaces by themselves. T(t): product of 1 - alpha of the translucent
//          ones before t. K: sum of T alpha colour of those before the first opaque one. E: T behind
//          all of these times the opaque one's colour; 0 where there is none.
// Projections and shells:
//   Shows  Max, Min and Mean show something on a ray whose span has data of some length, Sum and
//          Attenuation on every ray; shells where a shell or a cap is in the span (truth of Max: data).
// Where nothing shows the pixel is K + E, or K + T times the scene's background where no tool is opaque.
// Where something shows the scene's background takes no part (but in Sum), and the pixel is, in each
// channel, g being the window's grey, 0..1:
//   Max          K + max(greatest of T g (1 - cue + cue z'), E)
//   Min          K + max(least of T g, E)
//   Mean         K + max(g of the mean value * mean of T, E); means over the length with data
//   Sum          K + gain * integral of T g dt + E, where E without an opaque tool is T times the
//                scene's background
//   Attenuation  with A(t) = exp(-gain * integral of g up to t): sum of A T alpha colour of the
//                translucent tools + A(end) E, where E without an opaque tool is T times 1
//   invert       (and a volume that is itself inverted; both: neither) in complements: tools' colours
//                c become 1 - c, the pixel is made as above (Sum: without the scene's background),
//                clamped to 0..1, and becomes 1 - pixel. So tools keep their colours, a maximum gets
//                dark over them, and a sum is taken from white.
//   shells Max   b = T phi (beta0 + betaM (a z' + b)). Without an opaque tool K + max(greatest b,
//                T beta0 phi0). With one K + greatest b where a value before it reaches the lowest
//                level (the volume replaces the tool, brighter or not), else K + E. Where nothing
//                shows the scene's background is max(background, beta0 phi0). Truth: b of every
//                point, phi being the grey of its value; not of levels only.
//   shells Sum   K + sum of b over all crossings of levels, in and out + E
//   shells Lit   the first crossing is an opaque tool, lit as tools are, by the field's gradient
//   colour       of shells multiplies all their b, and phi0
//   Caps         where the span or its data begin and end all levels <= the value there are crossed
//                (Lit: with the normal of the face); not where an opaque tool ends it
// Volumes and iso-surfaces, front to back; each thing on the ray covers what is behind it, at last the opaque
// tool or, where there is none, the scene's background:
//   blend        tools by their opacity, the field between them by C = integral of tau c exp(-integral of
//                tau), tau = -ln(1 - a) / opacityLength. Where a stretch of the ray has opacity 1 it is
//                opaque at once, with the colour of where it begins; a value that only touches 1 is not.
//   colour       c of the transfer function; shaded: Material's I with the gradient at the place. The
//                gradient is that of the layer's own field: with nearest, of the nearest voxel
//   max, min     the greatest or least value of the span, not weighed with what tools leave, lies with its
//                colour and its opacity (as it is, of no length) at the first place that has it; not shaded
//   isosurface   the first place whose value is at least the level is an opaque tool. Where the span, or its
//                data, begin there or above it is a face turned to the eye
// Colour volumes. Blend: channels times gains, held in 0..1, alpha of a smallest spacing, opaque at once as
// above; without alpha it is 1 times its gain. Max, min: of each channel by itself, opaque where it is first
// reached; alpha takes no part. They are not shaded.
// Lenses. The ray's span is cut where it enters and leaves each lens, in double from its half-spaces, however
// many; where lenses overlap the later layer rules, and what is shorter than 1e-9 mm belongs to its
// neighbour. Between two cuts one appearance rules: the layer's own or a lens's inside. On rays:
//   Ordered       volumes (blend), iso-surfaces, Lit shells: each stretch between two cuts or tools by
//                 itself, C and t, an iso-surface with its faces, Lit shells with their caps; joined with
//                 the translucent tools front to back
//   Gathered      projections, shells Max and Sum: over all stretches of an appearance on the ray as above,
//                 weighed with T; what that and the opaque tool come to is behind all that is ordered: the
//                 pixel is C of ordered and tools + (product of all t) * (what is gathered, with E)
//   Several       gathered ones join where all that show something are Max (projections and shells), all
//                 Min, all Sum or all Attenuation: the greatest, the least, the sum, the product, with one E.
//                 Means of the same window are one over the stretches of both. Else the last in the
//                 scene's order shows as if it were alone
//   Attenuation   weakens the colours of tools behind it too, not what is ordered
//   Sum           E without an opaque tool is T times the background where a projection is among them,
//                 0 where all are shells
//   shells Max    with an opaque tool and surfaceBlend Replace: takes part where it reaches its lowest
//                 level, and then the tool does not
//   Nothing shows (of all that is gathered) the pixel is C + T E, as the outside has it: Attenuation 1,
//                 shells Max max(background, beta0 phi0), else the background
//   Caps          of shells: at a lens face too, but not where shells of the same levels go on beyond it
//   Cut-out       is a stretch that nothing draws
// Inverted projections and volumes of mode Max or Min are refused. On slices the pixel's point, on a face
// too, is in the lens: another look, or (cut-out) nothing; slabs are refused.
// The truth is always exact post-classification: pre-classification, tables and OpacityRule::Linear are
// engines' approximations of it, and their distance is in the model error.
//
// Disabled levels are none. z' is clamped to 0..1: what lies between eye and the ramp's near depth has 1.
// Sums and shells may exceed 1; displays clamp.
//
// Max, Min: roots of each cell's cubic. Cue: the product with the ramp is a rational function whose
// derivative's numerator is solved (exact but for rounding); with a sigmoid window bracketed to 1e-9. Sum:
// cut at the window's knots. Blend: rays cut at cell faces, where the field turns, passes a point of the
// transfer function or (shaded) turns its gradient from the eye; each stretch by Gauss-Legendre, 4 against 8
// places, halved until they differ by less than 1e-7 of the display; until less than 1e-7 of light is left.
//
// Implementation is known of blended volumes with post-classification asked for: samples at (k + 1/2) step *
// smallest spacing from the lattice's origin, of as much of their step as span and tools leave, their place
// held in the box of voxel centres, opacity by the layer's rule, of part of a step by exponent. Of all else
// that looks through a volume it is refused.
//
// Thread-safe; spreads the pixels with parallelFor. Errors: SceneInvalid (a source is missing, a pixel lies
// outside the picture), GeometryRefused (a look through a single slice), PlaneDegenerate, NotBuiltYet,
// Cancelled.
#pragma once
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "vernier/plan/Scene.h"
#include "vernier/plan/Technique.h"
#include "vernier/plan/View.h"

namespace vernier::quality {

// Model: against the continuous truth, so it holds all that the technique does. Implementation: against a
// double evaluation of the same algorithm (slabs: the same midpoint samples; blended volumes: the same
// lattice), so it holds the arithmetic only.
enum class ErrorKind { Model, Implementation };

struct ReferenceOptions {
  ErrorKind kind = ErrorKind::Model;
  double step = 1;  // of Quality, for Implementation: a slab takes ceil(T / (step * smallest spacing))
                    // samples, a blended volume one every step * smallest spacing
  // By the layer's place in the scene: what a plugin says of its own layers (Technique::truth). Such a layer
  // lies over those before it and adds no pixels to the population, unless the scene has no other layer.
  std::map<std::size_t, PixelTruth> truths = {};
  // The scene's lenses in their places, those that show (Plan::lenses), `layer` as in this scene. A scene
  // with lenses is refused (NotBuiltYet) where they are absent; those that are not in the list show nothing.
  std::optional<std::vector<PlacedLens>> lenses = std::nullopt;
};

struct ReferencePixel {
  glm::dvec4 rgba{0, 0, 0, 1};                              // display-referred 0..1, background included
  double value = std::numeric_limits<double>::quiet_NaN();  // modality value before the window; NaN: no data
  bool covered = false;                                     // some layer has data here
};

// `pixels`: index x + width * y, row 0 on top. One answer per index, in their order.
VERNIER_API Result<std::vector<ReferencePixel>> referencePixels(const Scene&, const View&, const Sources&,
                                                                std::span<const std::size_t> pixels,
                                                                const ReferenceOptions& = {},
                                                                std::stop_token = {});

// The value of one slice layer at points of the picture (pixel coordinates, centres at half-integers), with
// the least and greatest modality value of the voxels that it is made from (the corners of the cells that it
// passes).
struct SliceValue {
  double value = 0;
  double localMin = 0, localMax = 0;
  double localRange() const { return localMax - localMin; }
};
VERNIER_API Result<std::vector<std::optional<SliceValue>>> sliceValues(const Scene&, std::size_t layer,
                                                                       const View&, const Sources&,
                                                                       std::span<const glm::dvec2> points_px,
                                                                       const ReferenceOptions& = {});

// Number of midpoint samples of a slab: ceil(T / (step * smallest spacing)), at least 1.
VERNIER_API int slabSamples(const Volume&, double thickness_mm, double step);

}  // namespace vernier::quality
