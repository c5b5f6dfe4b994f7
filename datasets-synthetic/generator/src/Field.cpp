// SPDX-License-Identifier: GPL-3.0-or-later
#include "Field.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "PortableMath.h"
#include "vernier/base/Random.h"

namespace vernier::phantoms {
namespace {

// Marschner and Lobb, Visualization '94: rho(x, y, z) in [0, 1] on [-1, 1]^3, scaled to [low, high].
class MarschnerLobb : public Field {
 public:
  explicit MarschnerLobb(const Json& source)
      : f_(source.at("f_m")),
        alpha_(source.at("alpha")),
        half_mm_(source.at("half_edge_mm")),
        low_(source.at("low")),
        high_(source.at("high")) {}
  void row(const RowLine& line, std::span<double> value, std::span<double> noise) const override {
    std::fill(noise.begin(), noise.end(), 0.0);
    for (std::size_t i = 0; i < value.size(); ++i) {
      const glm::dvec3 p = (line.start_mm + static_cast<double>(i) * line.step_mm) / half_mm_;
      const double r = std::sqrt(p.x * p.x + p.y * p.y);
      const double wave = 1.0 + portableCos(2.0 * kPi * f_ * portableCos(kPi * r / 2.0));
      const double rho = (1.0 - portableSin(kPi * p.z / 2.0) + alpha_ * wave) / (2.0 * (1.0 + alpha_));
      value[i] = low_ + (high_ - low_) * rho;
    }
  }

 private:
  double f_, alpha_, half_mm_, low_, high_;
};

// background + peak * exp(-d^2 / (2 sigma^2)), d = distance to a straight axis: the vessel of the MIP loss
// figures.
class GaussianVessel : public Field {
 public:
  explicit GaussianVessel(const Json& source)
      : through_(vecOf(source.at("through_mm"))),
        along_(glm::normalize(vecOf(source.at("direction")))),
        sigma_mm_(source.at("sigma_mm")),
        background_(source.at("background")),
        peak_(source.at("peak")) {}
  void row(const RowLine& line, std::span<double> value, std::span<double> noise) const override {
    std::fill(noise.begin(), noise.end(), 0.0);
    for (std::size_t i = 0; i < value.size(); ++i) {
      const glm::dvec3 q = line.start_mm + static_cast<double>(i) * line.step_mm - through_;
      const glm::dvec3 across = q - glm::dot(q, along_) * along_;
      value[i] = background_ + peak_ * portableExp(-glm::dot(across, across) / (2.0 * sigma_mm_ * sigma_mm_));
    }
  }

 private:
  glm::dvec3 through_, along_;
  double sigma_mm_, background_, peak_;
};

// Density of the hydrogen-like orbital n = 3, l = 2, m = 0 about z, scaled to its peak: psi is
// (3 z^2 - r^2) exp(-r / (3 a)), greatest at z = 6 a.
class Orbital : public Field {
 public:
  explicit Orbital(const Json& source) : radius_mm_(source.at("radius_mm")), peak_(source.at("peak")) {}
  void row(const RowLine& line, std::span<double> value, std::span<double> noise) const override {
    std::fill(noise.begin(), noise.end(), 0.0);
    for (std::size_t i = 0; i < value.size(); ++i) {
      const glm::dvec3 p = (line.start_mm + static_cast<double>(i) * line.step_mm) / radius_mm_;
      const double square = glm::dot(p, p), angular = (3.0 * p.z * p.z - square) / 72.0;
      value[i] = peak_ * angular * angular * portableExp(4.0 - 2.0 * std::sqrt(square) / 3.0);
    }
  }

 private:
  double radius_mm_, peak_;
};

// A plume of Gaussian profile: its width grows evenly with the height over its source, its axis drifts along
// x with the height's square, and each horizontal section holds as much as the others.
class Plume : public Field {
 public:
  explicit Plume(const Json& source)
      : from_mm_(vecOf(source.at("from_mm"))),
        width_mm_(source.at("width_mm")),
        widening_(source.at("widening")),
        drift_perMm_(source.at("drift_per_mm")),
        peak_(source.at("peak")) {}
  void row(const RowLine& line, std::span<double> value, std::span<double> noise) const override {
    std::fill(noise.begin(), noise.end(), 0.0);
    for (std::size_t i = 0; i < value.size(); ++i) {
      const glm::dvec3 q = line.start_mm + static_cast<double>(i) * line.step_mm - from_mm_;
      const double x = q.x - drift_perMm_ * q.z * q.z, width = width_mm_ + widening_ * q.z;
      const double thinned = width_mm_ / width;
      value[i] = peak_ * thinned * thinned * portableExp(-(x * x + q.y * q.y) / (2.0 * width * width));
    }
  }

 private:
  glm::dvec3 from_mm_;
  double width_mm_, widening_, drift_perMm_, peak_;
};

// Grows evenly along a direction: linear interpolation is exact everywhere, so that a picture says where each
// of its pixels lies.
class Ramp : public Field {
 public:
  explicit Ramp(const Json& source)
      : atOrigin_(source.at("at_origin")), slope_perMm_(vecOf(source.at("slope_per_mm"))) {}
  void row(const RowLine& line, std::span<double> value, std::span<double> noise) const override {
    std::fill(noise.begin(), noise.end(), 0.0);
    for (std::size_t i = 0; i < value.size(); ++i)
      value[i] = atOrigin_ + glm::dot(slope_perMm_, line.start_mm + static_cast<double>(i) * line.step_mm);
  }

 private:
  double atOrigin_;
  glm::dvec3 slope_perMm_;
};

}  // namespace

glm::dmat3 rotationOf(glm::dvec3 deg) {
  glm::dmat3 all(1.0);
  for (int axis = 0; axis < 3; ++axis) {
    const double c = portableCos(radiansOf(deg[axis])), s = portableSin(radiansOf(deg[axis]));
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    glm::dmat3 m(1.0);
    m[a][a] = c;
    m[a][b] = s;
    m[b][a] = -s;
    m[b][b] = c;
    all = m * all;  // about x first, then y, then z, all fixed axes
  }
  return all;
}

namespace {

HalfSpace clipOf(const Json& clip) {
  const glm::dvec3 n = vecOf(clip.at("normal"));
  const double length = std::sqrt(glm::dot(n, n));
  return {n / length, clip.at("offset_mm").get<double>() / length};
}

template <class Enum>
Enum named(const Json& text, std::initializer_list<std::pair<const char*, Enum>> names) {
  for (const auto& [name, value] : names)
    if (text == name) return value;
  throw std::invalid_argument("recipe: unknown word " + text.dump());
}

Solid solidOf(const Json& j) {
  Solid s;
  s.name = j.value("name", "");
  s.shape = named<Shape>(j.at("shape"), {{"ellipsoid", Shape::Ellipsoid},
                                         {"box", Shape::Box},
                                         {"cylinder", Shape::Cylinder},
                                         {"capsule", Shape::Capsule}});
  s.centre_mm = vecOf(j.at("centre_mm"));
  s.size_mm = vecOf(j.at("size_mm"));
  if (j.contains("rotate_deg")) s.patientFromLocal = rotationOf(vecOf(j["rotate_deg"]));
  for (const Json& clip : j.value("clips", Json::array())) s.clips.push_back(clipOf(clip));
  s.fill = named<Fill>(j.value("fill", Json("constant")), {{"constant", Fill::Constant},
                                                           {"speckle", Fill::Speckle},
                                                           {"folds", Fill::Folds},
                                                           {"blobs", Fill::Blobs},
                                                           {"combs", Fill::Combs}});
  s.value = j.at("value");
  s.value2 = j.value("value2", 0.0);
  s.cell_mm = j.value("cell_mm", 1.0);
  s.threshold = j.value("threshold", 0.0);
  s.noise = j.value("noise", 0.0);
  s.sheetsOnly = j.value("sheets_only", false);
  s.texture = j.value("texture", std::uint64_t{0});
  s.maximum = j.value("maximum", false);
  return s;
}

Solid mirrored(const Solid& s) {
  Solid m = s;
  m.name = s.name + "-right";
  m.centre_mm.x = -s.centre_mm.x;
  // Every shape here is symmetric in its local axes, so that the mirror image is a rotation of it again.
  const glm::dmat3 flip(-1, 0, 0, 0, 1, 0, 0, 0, 1);
  m.patientFromLocal = flip * s.patientFromLocal * flip;
  for (HalfSpace& clip : m.clips) clip.normal.x = -clip.normal.x;
  return m;
}

}  // namespace

glm::dvec3 vecOf(const Json& three) {
  return {three.at(0).get<double>(), three.at(1).get<double>(), three.at(2).get<double>()};
}

SolidsField::SolidsField(std::vector<Solid> solids, double background, double noise, double edge_mm,
                         std::uint64_t seed)
    : solids_(std::move(solids)), background_(background), noise_(noise), edge_mm_(edge_mm) {
  for (std::size_t n = 0; n < solids_.size(); ++n) {
    const std::uint64_t texture = solids_[n].texture != 0 ? solids_[n].texture : 1000 + n;
    order_.push_back({&solids_[n], boundsOf(solids_[n], edge_mm_ + 1e-6), randomBits(seed, texture)});
  }
}

std::unique_ptr<const Field> SolidsField::within(const AxisBox& region) const {
  auto part = std::unique_ptr<SolidsField>(new SolidsField());
  part->background_ = background_;
  part->noise_ = noise_;
  part->edge_mm_ = edge_mm_;
  for (const Numbered& n : order_)
    if (n.bounds.meets(region)) part->order_.push_back(n);
  return part;
}

void SolidsField::row(const RowLine& line, std::span<double> value, std::span<double> noise) const {
  std::fill(value.begin(), value.end(), background_);
  std::fill(noise.begin(), noise.end(), noise_);
  const glm::dvec3 end = line.start_mm + static_cast<double>(line.count - 1) * line.step_mm;
  const AxisBox region{glm::min(line.start_mm, end), glm::max(line.start_mm, end)};
  for (const Numbered& n : order_)
    if (n.bounds.meets(region)) paintRow(*n.solid, line, edge_mm_, n.seed, value, noise);
}

std::vector<Solid> solidsOf(const Json& recipe, std::uint64_t seed) {
  std::vector<Solid> all;
  const Json& source = recipe.at("source");
  for (const Json& j : source.value("solids", Json::array())) {
    all.push_back(solidOf(j));
    if (j.value("mirror", false)) all.push_back(mirrored(all.back()));
  }
  if (source.contains("tree")) {
    for (Solid& s : growTree(source["tree"], seed)) all.push_back(std::move(s));
  }
  return all;
}

std::unique_ptr<const Field> makeField(const Json& recipe, std::uint64_t seed,
                                       const std::vector<Solid>& solids) {
  const Json& source = recipe.at("source");
  const std::string kind = source.at("kind");
  if (kind == "solids") {
    return std::make_unique<SolidsField>(solids, source.at("background"), source.value("noise", 0.0),
                                         source.value("edge_mm", 0.0), seed);
  }
  if (kind == "marschner-lobb") return std::make_unique<MarschnerLobb>(source);
  if (kind == "gaussian-vessel") return std::make_unique<GaussianVessel>(source);
  if (kind == "orbital") return std::make_unique<Orbital>(source);
  if (kind == "plume") return std::make_unique<Plume>(source);
  if (kind == "ramp") return std::make_unique<Ramp>(source);
  throw std::invalid_argument("recipe: unknown source kind " + kind);
}

}  // namespace vernier::phantoms
