// SPDX-License-Identifier: GPL-3.0-or-later
#include "Surface.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <fstream>

#include "PortableMath.h"

namespace vernier::phantoms {
namespace {

using Corner = glm::vec3;  // as STL holds it
using Facet = std::array<Corner, 3>;

// Rings of equally many points, one above the other, joined by quads; a ring may shrink to a point.
class Rings {
 public:
  explicit Rings(int around) : around_(around) {}
  void add(std::vector<Corner> ring) { rings_.push_back(std::move(ring)); }
  void addPoint(glm::dvec3 p) { rings_.push_back({Corner(p)}); }

  // Facing outwards when each ring runs counter-clockwise seen from where the rings go to.
  std::vector<Facet> facets(bool closeRings) const {
    std::vector<Facet> out;
    const std::size_t n = rings_.size();
    for (std::size_t i = 0; i + 1 < n + (closeRings ? 1 : 0); ++i)
      for (int k = 0; k < around_; ++k) {
        const std::vector<Corner>&low = rings_[i], &high = rings_[(i + 1) % n];
        const auto at = [&](const std::vector<Corner>& ring, int j) {
          return ring[ring.size() == 1 ? 0 : static_cast<std::size_t>(j % around_)];
        };
        if (low.size() > 1) out.push_back({at(low, k), at(low, k + 1), at(high, k + 1)});
        if (high.size() > 1) out.push_back({at(low, k), at(high, k + 1), at(high, k)});
      }
    return out;
  }

 private:
  int around_;
  std::vector<std::vector<Corner>> rings_;
};

struct Faceted {
  std::vector<Facet> facets;
  Json solid = Json::object();
};

// A rod along z whose radius is radius + thread cos(2 pi z / pitch - angle), its tip at z = 0, and a round
// head on it. At every height the section has the area pi (radius^2 + thread^2 / 2).
Faceted screw(const Json& s) {
  const double radius = s.at("radius_mm"), thread = s.at("thread_mm"), pitch = s.at("pitch_mm"),
               length = s.at("length_mm"), headRadius = s.at("head_radius_mm"), head = s.at("head_mm");
  const int around = s.at("around"), steps = s.at("along");
  Rings rings(around);
  const auto ring = [&](double z, auto&& radiusAt) {
    std::vector<Corner> points;
    for (int k = 0; k < around; ++k) {
      const double angle = 2 * kPi * k / around, r = radiusAt(angle);
      points.emplace_back(r * portableCos(angle), r * portableSin(angle), z);
    }
    rings.add(std::move(points));
  };
  rings.addPoint({0, 0, 0});
  for (int i = 0; i <= steps; ++i) {
    const double z = length * i / steps;
    ring(z, [&](double angle) { return radius + thread * portableCos(2 * kPi * z / pitch - angle); });
  }
  ring(length, [&](double) { return headRadius; });
  ring(length + head, [&](double) { return headRadius; });
  rings.addPoint({0, 0, length + head});
  Faceted shape{rings.facets(false), {}};
  shape.solid["volume_mm3"] =
      kPi * (length * (radius * radius + 0.5 * thread * thread) + head * headRadius * headRadius);
  return shape;
}

// Around z: large radius to the middle of the tube.
Faceted torus(const Json& s) {
  const double large = s.at("large_mm"), small = s.at("small_mm");
  const int around = s.at("around"), across = s.at("across");
  Rings rings(across);
  for (int i = 0; i < around; ++i) {
    const double u = 2 * kPi * i / around;
    std::vector<Corner> points;
    for (int j = 0; j < across; ++j) {
      const double v = -2 * kPi * j / across, r = large + small * portableCos(v);
      points.emplace_back(r * portableCos(u), r * portableSin(u), small * portableSin(v));
    }
    rings.add(std::move(points));
  }
  Faceted shape{rings.facets(true), {}};
  shape.solid["volume_mm3"] = 2 * kPi * kPi * large * small * small;
  shape.solid["area_mm2"] = 4 * kPi * kPi * large * small;
  return shape;
}

// A rectangle in z = 0 around the origin, facing +z.
Faceted plane(const Json& s) {
  const double x = 0.5 * s.at("width_mm").get<double>(), y = 0.5 * s.at("height_mm").get<double>();
  const Corner a(-x, -y, 0), b(x, -y, 0), c(x, y, 0), d(-x, y, 0);
  Faceted shape{{{a, b, c}, {a, c, d}}, {}};
  shape.solid["area_mm2"] = 4 * x * y;
  return shape;
}

Json answersOf(const Json& recipe, const Faceted& shape, const std::string& file) {
  glm::dvec3 low(shape.facets[0][0]), high = low;
  double area = 0, volume = 0;
  for (const Facet& f : shape.facets) {
    const glm::dvec3 a(f[0]), b(f[1]), c(f[2]), n = glm::cross(b - a, c - a);
    area += 0.5 * std::sqrt(glm::dot(n, n));
    volume += glm::dot(a, glm::cross(b, c)) / 6;
    for (const glm::dvec3& p : {a, b, c}) low = glm::min(low, p), high = glm::max(high, p);
  }
  Json j{{"schema", "vernier-phantom/1"},
         {"name", recipe.at("name")},
         {"title", recipe.at("title")},
         {"file", file}};
  j["unit"] = "mm";
  j["triangles"] = shape.facets.size();
  j["lowest_mm"] = {low.x, low.y, low.z};
  j["highest_mm"] = {high.x, high.y, high.z};
  j["area_mm2"] = area;
  j["closed"] = recipe.at("surface").at("closed");
  if (j["closed"]) j["volume_mm3"] = volume;
  j["solid"] = shape.solid;
  return j;
}

// 80 bytes, the count, and 50 bytes a facet.
std::string stlOf(const std::string& title, const std::vector<Facet>& facets) {
  static_assert(std::endian::native == std::endian::little, "STL is little endian");
  std::string bytes = ("Vernier phantom: " + title).substr(0, 80);
  bytes.resize(80, ' ');
  const auto put = [&](const auto& x) { bytes.append(reinterpret_cast<const char*>(&x), sizeof x); };
  put(static_cast<std::uint32_t>(facets.size()));
  for (const Facet& f : facets) {
    const glm::dvec3 n = glm::cross(glm::dvec3(f[1]) - glm::dvec3(f[0]), glm::dvec3(f[2]) - glm::dvec3(f[0]));
    const double size = std::sqrt(glm::dot(n, n));
    const Corner normal(size > 0 ? n / size : n);
    for (const Corner& c : {normal, f[0], f[1], f[2]}) put(c.x), put(c.y), put(c.z);
    put(std::uint16_t{0});
  }
  return bytes;
}

Result<void> write(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream out(file, std::ios::binary);
  out << bytes;
  out.close();
  if (!out)
    return makeError(ErrorCode::WriteFailed, "The surface cannot be written; check the folder and the disk.",
                     file.filename().string());
  return {};
}

}  // namespace

Result<PhantomInfo> writeSurface(const Json& recipe, const std::filesystem::path& outDir) {
  const Json& surface = recipe.at("surface");
  const std::string kind = surface.at("kind"), name = recipe.at("name");
  const Faceted shape = kind == "screw" ? screw(surface) : kind == "torus" ? torus(surface) : plane(surface);
  PhantomInfo info;
  info.data = outDir / (name + ".stl");
  info.answers = outDir / (name + ".answers.json");
  const std::string bytes = stlOf(recipe.at("title"), shape.facets);
  if (Result<void> w = write(info.data, bytes); !w) return w.error();
  const Json answers = answersOf(recipe, shape, info.data.filename().string());
  if (Result<void> w = write(info.answers, answers.dump(1) + "\n"); !w) return w.error();
  info.files = 1;
  info.bytes = bytes.size();
  return info;
}

}  // namespace vernier::phantoms
