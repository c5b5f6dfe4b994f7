// SPDX-License-Identifier: GPL-3.0-or-later
#include "CurvedPath.h"

#include "Vectors.h"

namespace vernier {
namespace {

constexpr double kTurn_rad = 0.04;  // of the tangent between two nodes
constexpr int kDeepest = 14;
constexpr double kSharpest_rad = 1.0;  // turns more than this at the deepest level: a cusp

double angleBetween(glm::dvec3 a, glm::dvec3 b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

glm::dvec3 across(glm::dvec3 v, glm::dvec3 unitTangent) { return v - glm::dot(v, unitTangent) * unitTangent; }

// Double reflection: the up vector at (point, tangent) carried on without turning about the path.
glm::dvec3 carried(glm::dvec3 up, glm::dvec3 tangent, glm::dvec3 step, glm::dvec3 nextTangent) {
  const auto reflected = [](glm::dvec3 v, glm::dvec3 mirror) {
    const double square = glm::dot(mirror, mirror);
    return square > 0 ? v - (2 * glm::dot(mirror, v) / square) * mirror : v;
  };
  // A step of nothing has no direction to mirror in.
  if (glm::length(step) < 1e-9) return glm::normalize(across(up, nextTangent));
  const glm::dvec3 half = reflected(up, step);
  const glm::dvec3 next = reflected(half, nextTangent - reflected(tangent, step));
  return glm::normalize(across(next, nextTangent));
}

Error degenerate(const std::string& sentence) { return makeError(ErrorCode::PathDegenerate, sentence); }

}  // namespace

double CurvedPath::Piece::length(double a, double b) const {
  static constexpr double x[2] = {0.5384693101056831, 0.9061798459386640};
  static constexpr double w[3] = {0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
  const double middle = 0.5 * (a + b), half = 0.5 * (b - a);
  double sum = w[0] * glm::length(slope(middle));
  for (int n = 0; n < 2; ++n)
    sum += w[n + 1] * (glm::length(slope(middle - half * x[n])) + glm::length(slope(middle + half * x[n])));
  return sum * half;
}

std::vector<CurvedPath::Piece> CurvedPath::piecesThrough(std::span<const glm::dvec3> points) {
  const std::size_t n = points.size() - 1;
  std::vector<double> h(n);
  std::vector<glm::dvec3> chord(n), slope(n + 1);  // per unit of the parameter
  for (std::size_t i = 0; i < n; ++i) {
    h[i] = std::sqrt(glm::length(points[i + 1] - points[i]));
    chord[i] = (points[i + 1] - points[i]) / h[i];
  }
  slope.front() = slope.back() = chord.front();
  for (std::size_t i = 1; i < n; ++i)
    slope[i] = (h[i] * chord[i - 1] + h[i - 1] * chord[i]) / (h[i - 1] + h[i]);
  if (n > 1) {
    slope.front() = 2.0 * chord.front() - slope[1];
    slope.back() = 2.0 * chord.back() - slope[n - 1];
  }
  std::vector<Piece> pieces(n);
  for (std::size_t i = 0; i < n; ++i) {
    const glm::dvec3 d = points[i + 1] - points[i], a = h[i] * slope[i], b = h[i] * slope[i + 1];
    pieces[i] = {points[i], a, 3.0 * d - 2.0 * a - b, a + b - 2.0 * d};
  }
  return pieces;
}

Result<CurvedPath> CurvedPath::make(std::span<const PatientPoint> given, glm::dvec3 up, bool seenAlongUp) {
  CurvedPath path;
  path.seenAlongUp_ = seenAlongUp;
  std::vector<glm::dvec3> points;
  for (const PatientPoint& p : given) {
    if (!points.empty() && glm::length(p.p - points.back()) < kCoincident_mm)
      ++path.coincident_;
    else
      points.push_back(p.p);
  }
  if (points.size() < 2)
    return degenerate("All points of the path are the same; give at least two that are apart.");
  path.pieces_ = path.piecesThrough(points);
  if (seenAlongUp) path.flatten(up);
  path.nodes_.push_back({0, 0, 0, path.pieces_[0].c0, path.tangentAt(0, 0), up});
  for (std::size_t i = 0; i < path.pieces_.size(); ++i)
    if (!path.addNodes(i, 0, 1, 0))
      return degenerate(
          std::string(seenAlongUp ? "Seen along its up vector the path stands still or turns back"
                                  : "The path turns back on itself") +
          " near point " + std::to_string(i + 1) + " of " + std::to_string(given.size()) +
          (seenAlongUp ? "; take another up vector, or the straightened form." : "; leave that point out."));
  path.measure();
  if (!path.carryUp(up))
    return degenerate("The up vector runs along the path's beginning; give a direction across it.");
  return path;
}

// Takes the component along `up` away, but for the middle of its range.
void CurvedPath::flatten(glm::dvec3 up) {
  lowest_ = highest_ = glm::dot(up, pieces_[0].c0);
  const auto take = [&](double height) {
    lowest_ = std::min(lowest_, height);
    highest_ = std::max(highest_, height);
  };
  for (const Piece& p : pieces_) {
    take(glm::dot(up, p.at(1)));
    const double a = 3 * glm::dot(up, p.c3), b = 2 * glm::dot(up, p.c2), c = glm::dot(up, p.c1);
    const double root = std::sqrt(std::max(0.0, b * b - 4 * a * c));
    const double q = -0.5 * (b + std::copysign(root, b));
    for (const double v : {q / a, c / q})
      if (v > 0 && v < 1) take(glm::dot(up, p.at(v)));
  }
  for (Piece& p : pieces_) {
    p.c0 = across(p.c0, up) + 0.5 * (lowest_ + highest_) * up;
    for (glm::dvec3* c : {&p.c1, &p.c2, &p.c3}) *c = across(*c, up);
  }
}

// Zero where the curve stands still.
glm::dvec3 CurvedPath::tangentAt(std::size_t piece, double v) const {
  const Piece& p = pieces_[piece];
  const glm::dvec3 slope = p.slope(v);
  const double largest = glm::length(p.c1) + glm::length(p.c2) + glm::length(p.c3);
  const double speed = glm::length(slope);
  return speed > 1e-9 * largest ? slope / speed : glm::dvec3(0);
}

// Nodes of (a, b], closer where the path turns; false at a cusp.
bool CurvedPath::addNodes(std::size_t piece, double a, double b, int depth) {
  const double middle = 0.5 * (a + b);
  const glm::dvec3 before = tangentAt(piece, a), at = tangentAt(piece, middle), after = tangentAt(piece, b);
  const bool moves = before != glm::dvec3(0) && at != glm::dvec3(0) && after != glm::dvec3(0);
  const double turn_rad = moves ? angleBetween(before, at) + angleBetween(at, after) : 2 * kSharpest_rad;
  if (turn_rad > kTurn_rad && depth < kDeepest)
    return addNodes(piece, a, middle, depth + 1) && addNodes(piece, middle, b, depth + 1);
  if (turn_rad > kSharpest_rad) return false;
  nodes_.push_back({piece, b, 0, pieces_[piece].at(b), after, {}});
  return true;
}

void CurvedPath::measure() {
  for (std::size_t n = 1; n < nodes_.size(); ++n) {
    const Node& a = nodes_[n - 1];
    Node& b = nodes_[n];
    b.s = a.s + pieces_[b.piece].length(a.piece == b.piece ? a.v : 0, b.v);
  }
}

bool CurvedPath::carryUp(glm::dvec3 up) {
  if (seenAlongUp_) {
    for (Node& n : nodes_) n.up = up;
    return true;
  }
  const glm::dvec3 first = across(up, nodes_[0].tangent);
  if (!(glm::length(first) >= kLeastAngle_rad * glm::length(up))) return false;
  nodes_[0].up = glm::normalize(first);
  for (std::size_t n = 1; n < nodes_.size(); ++n) {
    const Node& a = nodes_[n - 1];
    Node& b = nodes_[n];
    b.up = carried(a.up, a.tangent, b.point - a.point, b.tangent);
  }
  return true;
}

CurvedPath::At CurvedPath::at(double s_mm) const {
  const double s = std::clamp(s_mm, 0.0, length_mm());
  const auto found = std::upper_bound(nodes_.begin() + 1, nodes_.end() - 1, s,
                                      [](double value, const Node& n) { return value < n.s; });
  const Node &b = *found, &a = *(found - 1);
  const Piece& piece = pieces_[b.piece];
  const double from = a.piece == b.piece ? a.v : 0;
  double v = b.s > a.s ? from + (b.v - from) * (s - a.s) / (b.s - a.s) : b.v;
  for (int n = 0; n < 6; ++n) {  // Newton: the speed hardly changes from node to node
    const double off_mm = a.s + piece.length(from, v) - s;
    const double speed = glm::length(piece.slope(v));
    if (std::abs(off_mm) <= 1e-12 * (1 + s) || !(speed > 0)) break;
    v = std::clamp(v - off_mm / speed, from, b.v);
  }
  At out;
  out.point = piece.at(v);
  out.tangent = tangentAt(b.piece, v);
  if (out.tangent == glm::dvec3(0)) out.tangent = b.tangent;
  out.up = seenAlongUp_ ? b.up : carried(a.up, a.tangent, out.point - a.point, out.tangent);
  return out;
}

CurvedPath::Overlap CurvedPath::overlap(double half_mm, double halfSlab_mm) const {
  Overlap worst;
  double most = 1;
  const auto look = [&](const Node& n, std::size_t piece, double v) {
    const double speed = glm::length(pieces_[piece].slope(v));
    if (!(speed > 0)) return;
    const glm::dvec3 curvature = across(pieces_[piece].bend(v), n.tangent) / (speed * speed);
    const double reach = std::abs(glm::dot(curvature, n.up)) * half_mm +
                         std::abs(glm::dot(curvature, glm::cross(n.tangent, n.up))) * halfSlab_mm;
    if (reach >= most) {
      most = reach;
      worst = {1 / glm::length(curvature), n.s};
    }
  };
  for (const Node& n : nodes_) {
    look(n, n.piece, n.v);
    // Curvature may jump from one piece to the next.
    if (n.v == 1 && n.piece + 1 < pieces_.size()) look(n, n.piece + 1, 0);
  }
  return worst;
}

double CurvedPath::crossing() const {
  constexpr std::size_t kSamples = 2048;
  constexpr double kNear = 0.75, kApart = 8;  // in steps: two lines that cross have samples this near
  const double step_mm = length_mm() / (kSamples - 1);
  struct Sample {
    glm::dvec3 point;
    double s;
  };
  std::vector<Sample> samples(kSamples);
  glm::dvec3 least(samples[0].point), greatest(least);
  for (std::size_t n = 0; n < kSamples; ++n) {
    const double s = step_mm * static_cast<double>(n);
    samples[n] = {at(s).point, s};
    least = n == 0 ? samples[0].point : glm::min(least, samples[n].point);
    greatest = n == 0 ? samples[0].point : glm::max(greatest, samples[n].point);
  }
  const glm::dvec3 extent = greatest - least;
  const int axis = extent.x >= extent.y ? (extent.x >= extent.z ? 0 : 2) : (extent.y >= extent.z ? 1 : 2);
  std::stable_sort(samples.begin(), samples.end(),
                   [&](const Sample& a, const Sample& b) { return a.point[axis] < b.point[axis]; });
  double first = -1;
  for (std::size_t i = 0; i < kSamples; ++i)
    for (std::size_t j = i + 1; j < kSamples; ++j) {
      const Sample &a = samples[i], &b = samples[j];
      if (b.point[axis] - a.point[axis] > kNear * step_mm) break;
      const double along = std::abs(a.s - b.s);
      // The ends of a closed path meet, which is no crossing.
      if (along < kApart * step_mm || along > length_mm() - kApart * step_mm) continue;
      const double s = std::min(a.s, b.s);
      if (glm::length(a.point - b.point) < kNear * step_mm && (first < 0 || s < first)) first = s;
    }
  return first;
}

}  // namespace vernier
