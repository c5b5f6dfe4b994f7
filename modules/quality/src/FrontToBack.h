// SPDX-License-Identifier: GPL-3.0-or-later
// Emission and absorption along a ray, front to back: what has been gathered and what is left of light from
// behind. Smooth stretches by Gauss-Legendre with the optical depth up to each place integrated from the same
// places, 4 against 8 of them, halved until both agree.
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
const GaussRule<4>& gaussRule4();
const GaussRule<8>& gaussRule8();

struct Emission {
  double depth = 0;      // optical, per unit of the parameter
  glm::dvec3 colour{0};  // of what is emitted, not multiplied
};

class FrontToBack {
 public:
  static constexpr double kAgree = 1e-7;   // what 4 and 8 places may differ by, of what is displayed
  static constexpr double kEnough = 1e-7;  // of light that is left: nothing behind is seen
  static constexpr int kDeepest = 30;      // halves

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
    const Stretch coarse = over(gaussRule4(), f, from, to), fine = over(gaussRule8(), f, from, to);
    const glm::dvec3 off = glm::abs(fine.colour - coarse.colour);
    const double worst = std::max(
        {off.x, off.y, off.z, std::abs(fine.left - coarse.left), std::abs(fine.emitted - (1 - fine.left))});
    if (left * worst <= kAgree || halves >= kDeepest) {
      // A colour that does not change then comes out exactly.
      if (fine.emitted > 0)
        colour += left * ((1 - fine.left) / fine.emitted) * fine.colour;
      else if (fine.left < 1)
        colour += left * (1 - fine.left) * f(from + 0.5 * (to - from)).colour;
      left *= fine.left;
      return;
    }
    const double mid = 0.5 * (from + to);
    absorb(f, from, mid, halves + 1);
    if (!ended()) absorb(f, mid, to, halves + 1);
  }

 private:
  struct Stretch {
    glm::dvec3 colour{0};
    double emitted = 0, left = 1;
  };
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
