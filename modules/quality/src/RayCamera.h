// SPDX-License-Identifier: GPL-3.0-or-later
// The reference's own camera of 3-D pictures. CameraPicture.h of module plan says what is meant.
#pragma once
#include "vernier/plan/Scene.h"
#include "vernier/plan/View.h"

namespace vernier::quality {

struct PixelRay {
  glm::dvec3 origin{0}, direction{0, 0, 1};  // patient; unit
  double depthPerMm = 1;                     // of the ray, along the camera's axis
  glm::dvec3 at(double t_mm) const { return origin + t_mm * direction; }
};

struct RayCamera {
  bool perspective = false;
  glm::dvec3 eye{0}, right{0}, down{0}, forward{0};  // patient; unit
  double step = 1;                                   // of a pixel: mm, or per mm of depth
  double near_mm = 0;
  glm::dvec2 middle{0};

  // Of a camera that looks at a box of this centre (patient) and diagonal. SceneInvalid where its scale or
  // place is not finite.
  static Result<RayCamera> make(const Camera&, const View&, glm::dvec3 centre, double diagonal_mm);

  PixelRay ray(glm::dvec2 pixel) const;
  double depth(glm::dvec3 patient) const { return glm::dot(patient - eye, forward); }
  // False: not before the eye.
  bool pixelOf(glm::dvec3 patient, glm::dvec2& pixel) const;
};

}  // namespace vernier::quality
