// SPDX-License-Identifier: GPL-3.0-or-later
// Material and lights of Scene.h for a vector of rays, compiled once per instruction set.
#if defined(VERNIER_VOLUME_FAST_LIGHT_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef VERNIER_VOLUME_FAST_LIGHT_INL_H
#undef VERNIER_VOLUME_FAST_LIGHT_INL_H
#else
#define VERNIER_VOLUME_FAST_LIGHT_INL_H
#endif
#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include "VolumeFastRead-inl.h"

HWY_BEFORE_NAMESPACE();
namespace vernier::native {
namespace HWY_NAMESPACE {

struct V3 {
  V x, y, z;
};
HWY_INLINE V Dot(const V3& a, const V3& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}

HWY_INLINE V PowerOf(V base, const FastVolume& v) {
  const D d;
  if (v.wholePower >= 0) {
    V out = hn::Set(d, 1.0f);
    for (int n = v.wholePower; n > 0; n >>= 1, base = hn::Mul(base, base))
      if (n & 1) out = hn::Mul(out, base);
    return out;
  }
  const V least = hn::Set(d, 1e-30f);
  return hn::IfThenElseZero(hn::Gt(base, least),
                            hn::Exp(d, hn::Mul(hn::Set(d, v.power), hn::Log(d, hn::Max(base, least)))));
}

// What the lights need of a packet's rays.
class PacketLighting {
 public:
  HWY_INLINE void set(const FastVolume& v, const RayPacket& p, int lane0) {
    const D d;
    alignas(64) float f[3][kPacketRays];
    for (std::size_t l = 0; l < hn::Lanes(d); ++l)
      for (int a = 0; a < 3; ++a)
        f[a][l] = static_cast<float>(-p.towards[a][static_cast<std::size_t>(lane0) + l]);
    toEye_ = {hn::Load(d, f[0]), hn::Load(d, f[1]), hn::Load(d, f[2])};
    for (std::size_t n = 0; n < v.lamps.size(); ++n) {
      const FastLamp& lamp = v.lamps[n];
      if (lamp.atEye) continue;
      const V3 between{hn::Add(toEye_.x, hn::Set(d, lamp.towards[0])),
                       hn::Add(toEye_.y, hn::Set(d, lamp.towards[1])),
                       hn::Add(toEye_.z, hn::Set(d, lamp.towards[2]))};
      // Of length 0 where light and eye are opposite: no specular part.
      const V size = Dot(between, between);
      const V scale =
          hn::IfThenElseZero(hn::Gt(size, hn::Set(d, 1e-12f)), hn::Div(hn::Set(d, 1.0f), hn::Sqrt(size)));
      between_[n] = {hn::Mul(between.x, scale), hn::Mul(between.y, scale), hn::Mul(between.z, scale)};
    }
  }

  // Lights `colour` by the gradient of w.
  HWY_INLINE void apply(const FastVolume& v, const Gradient& g, V (&colour)[3]) const {
    const D d;
    const auto rotated = [&](int a) {
      return hn::MulAdd(g.x, hn::Set(d, v.patientGradient[a][0]),
                        hn::MulAdd(g.y, hn::Set(d, v.patientGradient[a][1]),
                                   hn::Mul(g.z, hn::Set(d, v.patientGradient[a][2]))));
    };
    V3 n{rotated(0), rotated(1), rotated(2)};
    const V size = Dot(n, n), facing = Dot(n, toEye_);
    // Turned to the viewer, of length 1; 0 where there is no gradient.
    V scale = hn::Div(hn::Set(d, 1.0f), hn::Sqrt(size));
    scale = hn::IfThenElseZero(hn::Gt(size, hn::Set(d, 1e-30f)), hn::CopySign(scale, facing));
    n = {hn::Mul(n.x, scale), hn::Mul(n.y, scale), hn::Mul(n.z, scale)};
    const V towardsEye = hn::Mul(facing, scale);
    V sum[3];
    for (int c = 0; c < 3; ++c) {
      const V part = hn::Set(d, v.ambient[c]);
      sum[c] = v.ownColour ? hn::Mul(part, colour[c]) : part;
    }
    for (std::size_t k = 0; k < v.lamps.size(); ++k) {
      const FastLamp& lamp = v.lamps[k];
      const V3 l{hn::Set(d, lamp.towards[0]), hn::Set(d, lamp.towards[1]), hn::Set(d, lamp.towards[2])};
      const V nl = lamp.atEye ? towardsEye : hn::Max(hn::Zero(d), Dot(n, l));
      const V nh = lamp.atEye ? towardsEye : hn::Max(hn::Zero(d), Dot(n, between_[k]));
      // Without a normal there is no highlight either, whatever the power.
      const V shine =
          hn::IfThenElseZero(hn::Ne(scale, hn::Zero(d)), hn::Mul(hn::Set(d, v.specular), PowerOf(nh, v)));
      for (int c = 0; c < 3; ++c) {
        V own = hn::Mul(hn::Set(d, v.diffuse[c]), nl);
        if (v.ownColour) own = hn::Mul(own, colour[c]);
        sum[c] = hn::MulAdd(hn::Set(d, lamp.colour[c]), hn::Add(own, shine), sum[c]);
      }
    }
    for (int c = 0; c < 3; ++c) colour[c] = hn::Min(hn::Max(sum[c], hn::Zero(d)), hn::Set(d, 1.0f));
  }

 private:
  V3 toEye_;
  V3 between_[kMostLights];
};

}  // namespace HWY_NAMESPACE
}  // namespace vernier::native
HWY_AFTER_NAMESPACE();

#endif
