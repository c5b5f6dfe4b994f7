// SPDX-License-Identifier: GPL-3.0-or-later
// Points, vectors and affine maps that carry their coordinate frame in the type. All double.
//   Voxel    index along columns (i), rows (j), slices (k); voxel centres at integers
//   Texture  0..1 per axis, voxel i at (i + 0.5) / N
//   Patient  DICOM LPS, mm: +x to the patient's left, +y to posterior, +z to superior
//   View     mm, x to the right of the picture, y up, z towards the viewer
//   Clip     OpenGL's
//   Pixel    centres at half-integers, row 0 on top
// Transforms are named target first, so that products read right: patientFromVoxel = patientFromX *
// xFromVoxel.
#pragma once
#include <glm/glm.hpp>

namespace vernier {

struct VoxelFrame {};
struct TextureFrame {};
struct PatientFrame {};
struct ViewFrame {};
struct ClipFrame {};
struct PixelFrame {};

template <class Frame>
struct Vec {
  glm::dvec3 v{0.0};
  Vec() = default;
  explicit Vec(glm::dvec3 x) : v(x) {}
  Vec(double x, double y, double z) : v(x, y, z) {}
  friend Vec operator+(Vec a, Vec b) { return Vec(a.v + b.v); }
  friend Vec operator-(Vec a, Vec b) { return Vec(a.v - b.v); }
  friend Vec operator-(Vec a) { return Vec(-a.v); }
  friend Vec operator*(double s, Vec a) { return Vec(s * a.v); }
  friend Vec operator*(Vec a, double s) { return Vec(s * a.v); }
  friend bool operator==(const Vec&, const Vec&) = default;
};
template <class F>
double dot(Vec<F> a, Vec<F> b) {
  return glm::dot(a.v, b.v);
}
template <class F>
Vec<F> cross(Vec<F> a, Vec<F> b) {
  return Vec<F>(glm::cross(a.v, b.v));
}
template <class F>
double length(Vec<F> a) {
  return glm::length(a.v);
}
template <class F>
Vec<F> normalize(Vec<F> a) {
  return Vec<F>(glm::normalize(a.v));
}

template <class Frame>
struct Point {
  glm::dvec3 p{0.0};
  Point() = default;
  explicit Point(glm::dvec3 x) : p(x) {}
  Point(double x, double y, double z) : p(x, y, z) {}
  friend Point operator+(Point a, Vec<Frame> b) { return Point(a.p + b.v); }
  friend Point operator-(Point a, Vec<Frame> b) { return Point(a.p - b.v); }
  friend Vec<Frame> operator-(Point a, Point b) { return Vec<Frame>(a.p - b.p); }
  friend bool operator==(const Point&, const Point&) = default;
};

// An affine map from frame From to frame To: p -> linear * p + translation.
template <class To, class From>
struct Transform {
  glm::dmat3 linear{1.0};
  glm::dvec3 translation{0.0};
  Point<To> operator*(Point<From> p) const { return Point<To>(linear * p.p + translation); }
  Vec<To> operator*(Vec<From> v) const { return Vec<To>(linear * v.v); }
  template <class Other>
  Transform<To, Other> operator*(const Transform<From, Other>& o) const {
    return {linear * o.linear, linear * o.translation + translation};
  }
  // The caller has checked that the determinant is not zero.
  Transform<From, To> inverse() const {
    const glm::dmat3 inv = glm::inverse(linear);
    return {inv, -(inv * translation)};
  }
  glm::dmat4 matrix() const {
    glm::dmat4 m(linear);
    m[3] = glm::dvec4(translation, 1.0);
    return m;
  }
  friend bool operator==(const Transform&, const Transform&) = default;
};

using VoxelPoint = Point<VoxelFrame>;
using VoxelVec = Vec<VoxelFrame>;
using PatientPoint = Point<PatientFrame>;
using PatientVec = Vec<PatientFrame>;
using PatientFromVoxel = Transform<PatientFrame, VoxelFrame>;
using VoxelFromPatient = Transform<VoxelFrame, PatientFrame>;

}  // namespace vernier
