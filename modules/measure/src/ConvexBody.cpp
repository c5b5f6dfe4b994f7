// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/measure/ConvexBody.h"

#include <cmath>

#include "vernier/measure/Measurement.h"

namespace vernier::measure {
namespace {

constexpr double kFar_mm =
    1e6;  // half the side of the square that a plane begins as; nothing of a patient reaches it
constexpr int kNoPlane = -1;

// A corner of a face, and the plane that its edge to the next corner lies in.
struct Corner {
  glm::dvec2 p;
  int plane;
};

struct Frame {
  glm::dvec3 origin, x, y;
  glm::dvec3 at(glm::dvec2 q) const { return origin + q.x * x + q.y * y; }
};
Frame frameOf(glm::dvec3 normal, double offset) {
  const glm::dvec3 other = std::abs(normal.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 x = glm::normalize(glm::cross(normal, other));
  return {offset * normal, x, glm::cross(normal, x)};
}

// Keeps the part of the face with dot(n, p) <= d.
std::vector<Corner> clip(const std::vector<Corner>& face, glm::dvec2 n, double d, int plane) {
  std::vector<Corner> out;
  for (std::size_t i = 0; i < face.size(); ++i) {
    const Corner &a = face[i], &b = face[(i + 1) % face.size()];
    const double da = glm::dot(n, a.p) - d, db = glm::dot(n, b.p) - d;
    if (da <= 0) out.push_back(a);
    if ((da <= 0) != (db <= 0)) {
      const glm::dvec2 p = a.p + da / (da - db) * (b.p - a.p);
      out.push_back({p, da <= 0 ? plane : a.plane});
    }
  }
  return out.size() < 3 ? std::vector<Corner>{} : out;
}

// Where three planes meet; nullopt where they hardly do.
std::optional<glm::dvec3> meet(const HalfSpace& a, const HalfSpace& b, const HalfSpace& c) {
  const glm::dvec3 bc = glm::cross(b.normal.v, c.normal.v);
  const double d = glm::dot(a.normal.v, bc);
  if (std::abs(d) < 1e-6) return std::nullopt;
  return (a.offset_mm * bc + b.offset_mm * glm::cross(c.normal.v, a.normal.v) +
          c.offset_mm * glm::cross(a.normal.v, b.normal.v)) /
         d;
}

struct Face {
  std::vector<glm::dvec3> corners;
  bool open = false;
};

Face faceOf(const std::vector<HalfSpace>& planes, std::size_t n) {
  const HalfSpace& mine = planes[n];
  const Frame f = frameOf(mine.normal.v, mine.offset_mm);
  std::vector<Corner> face{{{-kFar_mm, -kFar_mm}, kNoPlane},
                           {{kFar_mm, -kFar_mm}, kNoPlane},
                           {{kFar_mm, kFar_mm}, kNoPlane},
                           {{-kFar_mm, kFar_mm}, kNoPlane}};
  for (std::size_t m = 0; m < planes.size() && !face.empty(); ++m) {
    if (m == n) continue;
    const glm::dvec2 across{glm::dot(planes[m].normal.v, f.x), glm::dot(planes[m].normal.v, f.y)};
    const double room = planes[m].offset_mm - glm::dot(planes[m].normal.v, f.origin);
    if (glm::length(across) < 1e-12) {
      // Parallel: outside of it nothing is left; the same plane given twice counts once, as the first.
      const bool same = glm::dot(planes[m].normal.v, mine.normal.v) > 0;
      const double equal = 1e-12 * (1 + std::abs(mine.offset_mm));  // mm; the offset times a rounded normal
      if (room < -equal || (room <= equal && same && m < n)) face.clear();
      continue;
    }
    face = clip(face, across, room, static_cast<int>(m));
  }
  Face out;
  for (std::size_t i = 0; i < face.size(); ++i) {
    const int before = face[(i + face.size() - 1) % face.size()].plane, after = face[i].plane;
    out.open |= after == kNoPlane;
    // The corner anew from its three planes: what the far square cost in digits is gone.
    std::optional<glm::dvec3> p;
    if (before != kNoPlane && after != kNoPlane && before != after)
      p = meet(mine, planes[static_cast<std::size_t>(before)], planes[static_cast<std::size_t>(after)]);
    out.corners.push_back(p ? *p : f.at(face[i].p));
  }
  return out;
}

// The vector of twice the area, about the first corner.
double areaOf(const Face& f) {
  glm::dvec3 twice(0);
  for (std::size_t i = 1; i + 1 < f.corners.size(); ++i)
    twice += glm::cross(f.corners[i] - f.corners[0], f.corners[i + 1] - f.corners[0]);
  return glm::length(twice) / 2;
}

Error invalid(const char* sentence) { return makeError(ErrorCode::OptionInvalid, sentence); }

}  // namespace

Result<ConvexBody> convexBody(std::span<const HalfSpace> given) {
  if (given.size() > kMostPlanes)
    return invalid("The region has over 256 planes; leave out those that do not cut.");
  std::vector<HalfSpace> planes(given.begin(), given.end());
  for (HalfSpace& h : planes) {
    const double size = glm::length(h.normal.v);
    if (!(std::abs(size - 1) < 1e-6) || !std::isfinite(h.offset_mm))
      return invalid(
          "A plane of the region has a normal that is no unit vector, or an offset that is not finite.");
    h.normal = PatientVec(h.normal.v / size);
    h.offset_mm /= size;
  }
  std::vector<Face> faces;
  ConvexBody body;
  glm::dvec3 middle(0);
  for (std::size_t n = 0; n < planes.size(); ++n) {
    faces.push_back(faceOf(planes, n));
    body.normals.push_back(planes[n].normal.v);
    body.faces.push_back(faces.back().corners.empty() ? 0 : areaOf(faces.back()));
    for (const glm::dvec3& p : faces.back().corners) body.corners.push_back(p), middle += p;
  }
  for (const Face& f : faces)
    if (f.open) return invalid("The planes leave the region open on one side; add a plane there.");
  if (body.corners.empty()) return invalid("The planes enclose nothing.");
  middle /= static_cast<double>(body.corners.size());
  for (std::size_t n = 0; n < planes.size(); ++n)
    body.volume_mm3 += body.faces[n] * (planes[n].offset_mm - glm::dot(planes[n].normal.v, middle)) / 3;
  if (!(body.volume_mm3 > 0)) return invalid("The planes enclose nothing.");
  return body;
}

}  // namespace vernier::measure
