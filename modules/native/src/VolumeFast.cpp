// SPDX-License-Identifier: GPL-3.0-or-later
// The SIMD kernel of volume rendering: as many rays of a packet at a time as there are lanes.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "VolumeFast.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <type_traits>

#include "PacketLenses.h"
#include "VolumeFast.h"
#include "VolumeFastLens-inl.h"
#include "VolumeFastLight-inl.h"
#include "VolumeFastRead-inl.h"
#include "VolumeFastSteps-inl.h"

HWY_BEFORE_NAMESPACE();
namespace vernier::native {
namespace HWY_NAMESPACE {

constexpr std::int64_t kBlockSteps = 16;

// kLens: the packet's rays meet lenses, and change their tables there; all else is as without.
template <class T, bool kTable, bool kLens>
class March {
 public:
  March(const FastVolume& v, const RayPacket& p, const PacketMarks& marks, int lane0, ProjectionWork& work)
      : v_(v),
        p_(p),
        marks_(marks),
        lane0_(lane0),
        work_(work),
        step_(v.job->step_mm),
        steps_(StepsOf(p, step_, lane0)) {}

  HWY_INLINE void Run(RayLight* lights) {
    if (steps_.last < steps_.base) return;
    LoadLight(lights);
    for (int a = 0; a < 3; ++a) stride_[a] = DirectionOf(a);
    if (v_.shaded) lighting_.set(v_, p_, lane0_);
    if constexpr (kLens) lens_.set(p_, step_, lane0_, steps_);
    marks_.seen.eachRun(steps_.base, steps_.last, [&](std::int64_t begin, std::int64_t end) {
      if (marks_.holes) return WithHoles(lights, begin, end);
      return Steps(begin, end);
    });
    work_.samples += samples_;
    StoreLight(lights);
  }

 private:
  // Lanes of origin + t * direction, from the packet's double.
  HWY_INLINE void Begin(std::int64_t block) {
    const D d;
    const double t = (static_cast<double>(block) + 0.5) * step_;
    block_ = block;
    inner_ = inside_ = true;
    M ok = hn::Eq(stride_[0], stride_[0]), wide = ok;
    for (int a = 0; a < 3; ++a) {
      const double* const o = p_.origin[a] + lane0_;
      const double* const q = p_.direction[a] + lane0_;
      const double whole = std::floor(o[0] + t * q[0]);
      alignas(64) float part[kPacketRays];
      for (std::size_t l = 0; l < hn::Lanes(d); ++l) part[l] = static_cast<float>(o[l] - whole + t * q[l]);
      whole_[a] = static_cast<std::int64_t>(whole);
      start_[a] = hn::Load(d, part);
      const V end = hn::MulAdd(stride_[a], hn::Set(d, static_cast<float>(kBlockSteps)), start_[a]);
      const V begin = hn::Sub(start_[a], stride_[a]);
      const V least = hn::Min(begin, end), most = hn::Max(begin, end);
      const float low = static_cast<float>(-whole_[a]);
      const float high = static_cast<float>(v_.read.last[static_cast<std::size_t>(a)] - whole_[a]);
      ok = hn::And(ok, hn::And(hn::Ge(least, hn::Set(d, low)), hn::Lt(most, hn::Set(d, high))));
      wide = hn::And(wide, hn::And(hn::Ge(least, hn::Set(d, low + 1)), hn::Lt(most, hn::Set(d, high - 1))));
    }
    inside_ = hn::AllTrue(d, ok), inner_ = hn::AllTrue(d, wide);
  }

  HWY_INLINE V DirectionOf(int a) const {
    const D d;
    alignas(64) float f[kPacketRays];
    for (std::size_t l = 0; l < hn::Lanes(d); ++l)
      f[l] = static_cast<float>(p_.direction[a][static_cast<std::size_t>(lane0_) + l] * step_);
    return hn::Load(d, f);
  }

  // `steps` after the block's first sample.
  HWY_INLINE FieldPlace PlaceAt(float steps) const {
    const D d;
    V x[3];
    for (int a = 0; a < 3; ++a) x[a] = hn::MulAdd(stride_[a], hn::Set(d, steps), start_[a]);
    return PlaceOf(v_.read, whole_, x, inside_);
  }

  HWY_INLINE V TablePlace(V w) const {
    const D d;
    const V place = hn::MulAdd(w, hn::Set(d, v_.placeScale), hn::Set(d, v_.placeOffset));
    return hn::Min(hn::Max(place, hn::Zero(d)), hn::Set(d, v_.lastPlace));
  }

  // False: no lane needs any further step.
  HWY_INLINE bool Steps(std::int64_t begin, std::int64_t end) {
    V front = hn::Zero(D());
    bool first = true;
    fresh_ = true;
    for (std::int64_t k = begin; k < end; ++k) {
      const std::int64_t block = k - k % kBlockSteps;
      const bool fresh = block != block_;
      if (fresh) Begin(block);
      if constexpr (kTable)
        if (fresh || first)
          front = FrontOf(FieldAt<T>(v_.read, PlaceAt(static_cast<float>(k - block) - 0.5f)).value);
      first = false;
      if constexpr (kLens) {
        if (!LensedStep(k, front)) return false;
      } else if (!Step(k, front)) {
        return false;
      }
    }
    return true;
  }

  // What is kept of a step's end for the next one: with lenses the value, whose place depends on the tables.
  HWY_INLINE V FrontOf(V value) const {
    if constexpr (kLens)
      return value;
    else
      return TablePlace(value);
  }

  HWY_INLINE bool Step(std::int64_t k, V& front) {
    const D d;
    const DI di;
    const float within = static_cast<float>(k - block_);
    M active = hn::Ge(light_.through, hn::Set(d, static_cast<float>(v_.job->leastLight)));
    V share;
    const bool cut = k < steps_.wholeFrom || k > steps_.wholeTo;
    if (cut) {
      const VI now = hn::Set(di, static_cast<std::int32_t>(k - steps_.base));
      const auto outside = hn::Or(hn::Lt(now, steps_.first), hn::Gt(now, steps_.end));
      active = hn::AndNot(hn::RebindMask(d, outside), active);
      share = hn::IfThenElse(
          hn::RebindMask(d, hn::Eq(now, steps_.first)), steps_.firstShare,
          hn::IfThenElse(hn::RebindMask(d, hn::Eq(now, steps_.end)), steps_.lastShare, hn::Set(d, 1.0f)));
    }
    if (hn::AllFalse(d, active)) {
      // Lanes may yet begin.
      if constexpr (kTable) front = TablePlace(FieldAt<T>(v_.read, PlaceAt(within + 0.5f)).value);
      return AnyLeft(k);
    }
    V opacity, colour[3];
    FieldSample here;
    FieldPlace place;
    if constexpr (kTable) {
      const V back = TablePlace(FieldAt<T>(v_.read, PlaceAt(within + 0.5f)).value);
      samples_ += hn::CountTrue(d, active);
      const TablePair pair = PairOf(v_, front, back);
      front = back;
      opacity = hn::IfThenElseZero(active, Bilinear(v_.opacity.data(), v_, pair));
      active = hn::Gt(opacity, hn::Zero(d));
      if (hn::AllFalse(d, active)) return true;
      const V inverse = hn::Div(hn::Set(d, 1.0f), hn::IfThenElse(active, opacity, hn::Set(d, 1.0f)));
      for (std::size_t c = 0; c < 3; ++c) colour[c] = hn::Mul(Bilinear(v_.lit[c].data(), v_, pair), inverse);
      if (v_.shaded) place = PlaceAt(within), here = FieldAt<T>(v_.read, place);
    } else {
      place = PlaceAt(within);
      here = FieldAt<T>(v_.read, place);
      samples_ += hn::CountTrue(d, active);
      const V at = TablePlace(here.value);
      active =
          hn::And(active, hn::And(hn::Gt(at, hn::Set(d, v_.seenFrom)), hn::Lt(at, hn::Set(d, v_.seenTo))));
      if (hn::AllFalse(d, active)) return true;
      const VI entry = hn::ConvertTo(di, at);
      const V rest = hn::Sub(at, hn::ConvertTo(d, entry));
      const V low = hn::GatherIndex(d, v_.opacity.data(), entry);
      const V high = hn::GatherIndex(d, v_.opacity.data() + 1, entry);
      opacity = hn::IfThenElseZero(active, hn::MulAdd(rest, hn::Sub(high, low), low));
      for (std::size_t c = 0; c < 3; ++c) colour[c] = ColourOf(v_.colour[c].data(), entry, rest);
    }
    if (v_.shaded) lighting_.apply(v_, GradientAt<T>(v_.read, whole_, place, here, inner_), colour);
    if (cut) opacity = PartOf(opacity, share);
    light_.Add<kLens>(k - steps_.base, opacity, colour, opacity, opacity);
    return true;
  }

  HWY_INLINE M Active(std::int64_t k) const {
    const D d;
    const M lit = hn::Ge(light_.through, hn::Set(d, static_cast<float>(v_.job->leastLight)));
    if (k >= steps_.wholeFrom && k <= steps_.wholeTo) return lit;
    const VI now = hn::Set(DI(), static_cast<std::int32_t>(k - steps_.base));
    const auto outside = hn::Or(hn::Lt(now, steps_.first), hn::Gt(now, steps_.end));
    return hn::AndNot(hn::RebindMask(d, outside), lit);
  }

  // One reading of the field, classified by each lane's own tables; where a lane's appearance changes within
  // the step, by both, each for its share.
  HWY_INLINE bool LensedStep(std::int64_t k, V& front) {
    const D d;
    const float within = static_cast<float>(k - block_);
    M active = Active(k);
    if (hn::AllFalse(d, active)) {
      if constexpr (kTable) front = FieldAt<T>(v_.read, PlaceAt(within + 0.5f)).value;
      return AnyLeft(k);
    }
    samples_ += hn::CountTrue(d, active);
    Reading r;
    if constexpr (kTable) {
      r.front = front, r.back = FieldAt<T>(v_.read, PlaceAt(within + 0.5f)).value;
      front = r.back;
    }
    if (!kTable || v_.shaded) r.place = PlaceAt(within), r.here = FieldAt<T>(v_.read, r.place);
    const std::int64_t n = k - steps_.base;
    V u = hn::Zero(d), stop = hn::Set(d, 1.0f);
    if (!lens_.cutAt(n)) {
      if (fresh_) look_ = LookOf(v_, lens_.appearance(n));
      fresh_ = false;
      Classified(k, r, look_, active, u, stop, false);
      return true;
    }
    fresh_ = true;
    const VI now = hn::Set(DI(), static_cast<std::int32_t>(n));
    u = hn::IfThenElse(hn::RebindMask(d, hn::Eq(now, steps_.first)), steps_.beginAt, u);
    stop = hn::IfThenElse(hn::RebindMask(d, hn::Eq(now, steps_.end)), steps_.endAt, stop);
    for (; !hn::AllFalse(d, active); active = hn::And(active, hn::Lt(u, stop))) {
      const V next = lens_.next(n, u, stop);
      Classified(k, r, LookOf(v_, lens_.appearanceFrom(n, u)), active, u, next, true);
      u = next;
    }
    return true;
  }

  struct Reading {
    V front, back;
    FieldPlace place;
    FieldSample here;
  };
  // Adds what a step shows between `u` and `next` of it.
  HWY_INLINE void Classified(std::int64_t k, const Reading& r, const Look& look, M active, V u, V next,
                             bool part) {
    const D d;
    V opacity, colour[3];
    if constexpr (kTable)
      ClassifyPair(v_, look, r.front, r.back, active, opacity, colour);
    else
      ClassifyPost(v_, look, r.here.value, active, opacity, colour);
    if (hn::AllFalse(d, active)) return;
    if (v_.shaded) lighting_.apply(v_, GradientAt<T>(v_.read, whole_, r.place, r.here, inner_), colour);
    if (part) opacity = PartOf(opacity, hn::Sub(next, u));
    light_.Add<kLens>(k - steps_.base, opacity, colour, u, next);
  }

  // Is there a lane with light left whose part goes on behind step k?
  HWY_INLINE bool AnyLeft(std::int64_t k) const {
    const D d;
    const M lit = hn::Ge(light_.through, hn::Set(d, static_cast<float>(v_.job->leastLight)));
    const M ahead =
        hn::RebindMask(d, hn::Gt(steps_.end, hn::Set(DI(), static_cast<std::int32_t>(k - steps_.base))));
    return !hn::AllFalse(d, hn::And(lit, ahead));
  }

  // Bins with no-data about are done in double, lane by lane.
  HWY_NOINLINE bool WithHoles(RayLight* lights, std::int64_t begin, std::int64_t end) {
    const RayMarks& m = marks_.seen;
    for (std::int64_t k = begin; k < end;) {
      const std::int64_t bin = (k - m.firstStep) / m.stepsPerBin;
      const std::int64_t binEnd = std::min(end, m.firstStep + (bin + 1) * m.stepsPerBin);
      if (marks_.holes[bin / 64] >> (bin % 64) & 1) {
        StoreLight(lights);
        for (std::size_t l = 0; l < hn::Lanes(D()); ++l) {
          const int n = lane0_ + static_cast<int>(l);
          if constexpr (kLens)
            GeneralParts(n, k, binEnd, lights[n]);
          else if (p_.to_mm[n] > p_.from_mm[n])
            v_.general->steps(p_.ray(n), p_.forward(n), p_.from_mm[n], p_.to_mm[n], k, binEnd, lights[n],
                              work_);
        }
        LoadLight(lights);
      } else if (!Steps(k, binEnd)) {
        return false;
      }
      k = binEnd;
    }
    return true;
  }

  // Steps [begin, end) of one ray in double, part by part.
  void GeneralParts(int n, std::int64_t begin, std::int64_t end, RayLight& light) {
    eachPart(p_, n, [&](int appearance, double from, double to) {
      const GeneralBlend* const general = v_.looks.general[static_cast<std::size_t>(appearance)];
      const auto first = static_cast<std::int64_t>(std::floor(from / step_)),
                 last = static_cast<std::int64_t>(std::ceil(to / step_));
      if (general && std::max(begin, first) < std::min(end, last))
        general->steps(p_.ray(n), p_.forward(n), from, to, std::max(begin, first), std::min(end, last), light,
                       work_);
    });
  }

  HWY_INLINE void LoadLight(const RayLight* lights) { light_.Load(lights + lane0_); }
  HWY_INLINE void StoreLight(RayLight* lights) {
    light_.Store<kLens>(p_, steps_.base, step_, lane0_, lights);
  }

  const FastVolume& v_;
  const RayPacket& p_;
  const PacketMarks& marks_;
  const int lane0_;
  ProjectionWork& work_;
  const double step_;
  const LaneSteps steps_;
  std::uint64_t samples_ = 0;
  std::int64_t block_ = std::numeric_limits<std::int64_t>::min();
  std::int64_t whole_[3] = {0, 0, 0};
  V start_[3], stride_[3];  // voxels from the block's whole ones, and per step
  bool inside_ = false, inner_ = false;
  Light light_;
  PacketLighting lighting_;
  std::conditional_t<kLens, LensLanes, char> lens_;
  Look look_;          // with lenses: of the steps until the next cut
  bool fresh_ = true;  // it must be made anew
};

template <class T, bool kTable, bool kLens>
void Blend(const FastVolume& v, const RayPacket& p, const PacketMarks& marks, RayLight* lights,
           ProjectionWork& work) {
  for (int lane = 0; lane < kPacketRays; lane += static_cast<int>(hn::Lanes(D()))) {
    March<T, kTable, kLens> march(v, p, marks, lane, work);
    march.Run(lights);
  }
}

template <class T, bool kLens>
FastBlend BlendOf(const FastVolume& v) {
  return v.job->classification == Classification::PreIntegrated ? Blend<T, true, kLens>
                                                                : Blend<T, false, kLens>;
}

template <bool kLens>
FastBlend OfType(const FastVolume& v) {
  switch (v.job->volume->type()) {
    case VoxelType::U8:
      return BlendOf<std::uint8_t, kLens>(v);
    case VoxelType::U16:
      return BlendOf<std::uint16_t, kLens>(v);
    case VoxelType::I16:
      return BlendOf<std::int16_t, kLens>(v);
    default:
      return BlendOf<float, kLens>(v);
  }
}

FastBlends BlendsFor(const FastVolume& v) { return {OfType<false>(v), OfType<true>(v)}; }

}  // namespace HWY_NAMESPACE
}  // namespace vernier::native
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vernier::native {

HWY_EXPORT(BlendsFor);

FastBlends fastBlendsFor(const FastVolume& v) { return HWY_DYNAMIC_DISPATCH(BlendsFor)(v); }

}  // namespace vernier::native
#endif
