// SPDX-License-Identifier: GPL-3.0-or-later
// Lights and the gradient that they shine on. Scene.h says what is meant (Material, Light, "The gradient that
// all shading means").
#pragma once
#include <vector>

#include "VolumeRays.h"

namespace vernier::quality {

class Shading {
 public:
  // SceneInvalid: a light without a direction, numbers that are not finite.
  static Result<Shading> make(const Scene&, const Material&);

  // Clamped to 0..1. `gradient` (patient) of any length; `ray` the unit direction of what is seen along.
  glm::dvec3 lit(glm::dvec3 own, glm::dvec3 gradient, glm::dvec3 ray) const {
    return lit(own, own, gradient, ray);
  }
  // With the material's colours in place of its own.
  glm::dvec3 lit(glm::dvec3 gradient, glm::dvec3 ray) const {
    return lit(ambientColour_, diffuseColour_, gradient, ray);
  }

 private:
  glm::dvec3 lit(glm::dvec3 ambient, glm::dvec3 diffuse, glm::dvec3 gradient, glm::dvec3 ray) const;
  struct Lamp {
    std::optional<glm::dvec3> towards;  // unit; absent: the eye
    glm::dvec3 colour{1};
  };
  std::vector<Lamp> lamps_;
  Material material_;
  glm::dvec3 ambientColour_{1}, diffuseColour_{1};
};

// Central differences of the field, in the patient, per mm.
class Gradient {
 public:
  Gradient(const Volume&, Interpolation);
  glm::dvec3 at(glm::dvec3 voxel) const;

  // Along a piece: three cubics where the piece lies in one cell of an even grid and all voxels that count
  // are data; else point by point.
  class Along {
   public:
    Along(const Gradient&, const RayPart&);
    glm::dvec3 operator()(double u) const;
    // Where the gradient passes at right angles to `direction`, ascending, as far as that is known.
    std::vector<double> turns(glm::dvec3 direction) const;

   private:
    const Gradient& gradient_;
    glm::dvec3 from_vox_, across_vox_;
    bool cubic_ = false;
    std::array<glm::dvec3, 4> c_{};  // of 1, u, u^2, u^3
  };

 private:
  glm::dvec3 patient(glm::dvec3 perVoxel) const { return toPatient_ * perVoxel; }
  // At the corner of a cell; nullopt where a voxel that it needs is not data.
  std::optional<glm::dvec3> atVoxel(glm::i64vec3) const;

  const Volume& volume_;
  Field field_;
  bool even_ = false;
  glm::dmat3 toPatient_{1};
  CentreBox box_;
};

}  // namespace vernier::quality
