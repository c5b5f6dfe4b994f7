// SPDX-License-Identifier: GPL-3.0-or-later
// All layers of a scene, made ready once and asked pixel by pixel.
#pragma once
#include <variant>

#include "CurvedReference.h"
#include "ImageReference.h"
#include "IsosurfaceReference.h"
#include "LensReference.h"
#include "ProjectionReference.h"
#include "ShellsReference.h"
#include "SliceReference.h"
#include "SurfaceReference.h"
#include "VolumeReference.h"

namespace vernier::quality {

class Layers {
 public:
  static Result<Layers> make(const Scene&, const View&, const Sources&, const ReferenceOptions&);
  // `value`, when given, takes what the layer that shows there says of its value, when it reads a volume.
  ReferencePixel at(glm::dvec2 pixel, std::optional<SliceValue>* value = nullptr) const;
  bool covers(glm::dvec2 pixel) const;
  // Whether an edge runs between the pixel and one of its eight neighbours.
  bool atEdge(glm::dvec2 pixel) const;

  struct Prepared {
    // All surfaces are one; those among a layer that looks through a volume are its tools.
    std::variant<SliceReference, CurvedReference, ImageReference, SurfaceReference, ProjectionReference,
                 ShellsReference, VolumeReference, IsosurfaceReference, LensReference, PixelTruth>
        layer;
    int samples = 0;
    const VolumeReading* reading() const;  // nullptr: a stored frame, or a plugin's layer
    // A plugin's layer has no value and covers nothing.
    std::optional<SliceValue> value(glm::dvec2 pixel) const;
    bool covers(glm::dvec2 pixel) const;
    EdgeMark edgeMark(glm::dvec2 pixel) const;
    // What a layer that looks through a volume shows, with its tools and background; nullopt: no such layer.
    std::optional<VolumeSeen> seen(glm::dvec2 pixel) const;
    const VolumeRays* rays() const;  // of such a layer; and whether voxels of a range can show something:
    bool contributes(const LocalRange&) const;
    // What is shown over `background`; nullopt: nothing. The value, where there is one, to `valueOut`.
    std::optional<glm::dvec3> shown(glm::dvec2 pixel, glm::dvec3 background,
                                    std::optional<SliceValue>* valueOut) const;
  };
  static Result<Prepared> prepare(const Scene&, const Layer&, const View&, const Sources&,
                                  const ReferenceOptions&);
  const std::vector<Prepared>& prepared() const { return layers_; }

 private:
  // The layer behind the lenses, with them.
  static Result<Prepared> prepareLensed(const Scene&, std::size_t base, const View&, const Sources&,
                                        const ReferenceOptions&);
  EdgeMark edgeMark(glm::dvec2 pixel) const;
  // The slice or image that shows, under any layers of plugins; how many layers from the bottom were left
  // out.
  ReferencePixel ground(glm::dvec2 pixel, std::optional<SliceValue>*, std::size_t& above) const;
  std::vector<Prepared> layers_;
  glm::dvec3 background_{0};
};

inline glm::dvec2 centreOf(std::size_t pixel, const View& view) {
  const auto w = static_cast<std::size_t>(view.width_px);
  return {static_cast<double>(pixel % w) + 0.5, static_cast<double>(pixel / w) + 0.5};
}

}  // namespace vernier::quality
