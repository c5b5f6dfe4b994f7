// SPDX-License-Identifier: GPL-3.0-or-later
// Emission and absorption along a ray, front to back: what has been gathered and what is left of light from
// behind. Smooth stretches by Gauss-Legendre with the optical depth up to each place integrated from the same
// places: 4 of them against 8, halved until both agree.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>

namespace vernier::quality {

// N places on [0, 1] with their weights, and the weights of the integrals from 0 to each place.
template <std::size_t N>
struct GaussRule {
  std::array<double, N> at{}, weight{};
  std::array<std::array<double, N>, N> upTo{};
};
template <std::size_t N>
const GaussRule<N>& gaussRule();  // of 2, 4 and 8

struct Emission {
  double depth = 0;      // optical, per unit of the parameter
  glm::dvec3 colour{0};  // of what is emitted, not multiplied
};

class FrontToBack {
 public:
  static constexpr double kAgree = 1e-7;        // what 4 and 8 places may differ by, of what is displayed
  static constexpr double kAgreeAtOnce = 1e-9;  // 2 and 4 places
  static constexpr double kEnough = 1e-7;       // of light that is left: nothing behind is seen
  static constexpr int kDeepest = 30;           // halves

  glm::dvec3 colour{0};
  double left = 1;

  bool ended() const { return left < kEnough; }
  void cover(glm::dvec3 own, double opacity) {
    colour += left * opacity * own;
    left *= 1 - opacity;
  }
  // f(u) is smooth from `from` to `to`. Stops early once nothing behind is seen.
  template <class Fn>
  void absorb(const Fn& f, double from, double to, int halves = 0) {
    const Stretch four = over(gaussRule<4>(), f, from, to);
    // Most stretches are so short or so clear that fewer do.
    if (left * apart(over(gaussRule<2>(), f, from, to), four) <= kAgreeAtOnce) return take(four, f, from, to);
    const Stretch eight = over(gaussRule<8>(), f, from, to);
    if (left * apart(four, eight) <= kAgree || halves >= kDeepest) return take(eight, f, from, to);
    const double mid = 0.5 * (from + to);
    absorb(f, from, mid, halves + 1);
    if (!ended()) absorb(f, mid, to, halves + 1);
  }

 private:
  struct Stretch {
    glm::dvec3 colour{0};
    double emitted = 0, left = 1;
  };
  // How far two attempts differ, and the better one from what a colour of 1 would come to.
  static double apart(const Stretch& coarse, const Stretch& fine) {
    const glm::dvec3 off = glm::abs(fine.colour - coarse.colour);
    return std::max(
        {off.x, off.y, off.z, std::abs(fine.left - coarse.left), std::abs(fine.emitted - (1 - fine.left))});
  }
  // A colour that does not change comes out exactly.
  template <class Fn>
  void take(const Stretch& s, const Fn& f, double from, double to) {
    if (s.emitted > 0)
      colour += left * ((1 - s.left) / s.emitted) * s.colour;
    else if (s.left < 1)
      colour += left * (1 - s.left) * f(0.5 * (from + to)).colour;
    left *= s.left;
  }
  template <std::size_t N, class Fn>
  static Stretch over(const GaussRule<N>& rule, const Fn& f, double from, double to) {
    const double length = to - from;
    std::array<Emission, N> e;
    double whole = 0;
    for (std::size_t n = 0; n < N; ++n) {
      e[n] = f(from + rule.at[n] * length);
      e[n].depth *= length;
      whole += rule.weight[n] * e[n].depth;
    }
    Stretch s;
    s.left = std::exp(-whole);
    for (std::size_t n = 0; n < N; ++n) {
      double before = 0;
      for (std::size_t m = 0; m < N; ++m) before += rule.upTo[n][m] * e[m].depth;
      const double share = rule.weight[n] * e[n].depth * std::exp(-before);
      s.emitted += share;
      s.colour += share * e[n].colour;
    }
    return s;
  }
};

}  // namespace vernier::quality
