// SPDX-License-Identifier: GPL-3.0-or-later
// The SIMD kernel of sampled projections: blocks of 16 steps along one ray.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ProjectionFast.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <vector>

#include "ProjectionFast.h"
#include "SliceFastRead-inl.h"

HWY_BEFORE_NAMESPACE();
namespace vernier::native {
namespace HWY_NAMESPACE {

constexpr int kBlock = 16, kGroup = 8;  // steps that are read together; that share a bound
constexpr float kNever = -std::numeric_limits<float>::infinity();

// A ray's part under work.
struct Part {
  const FastProjection& p;
  const VoxelRay& ray;
  double from, to;
  double least, most;  // where samples may lie
  Steps steps;
  CueAlong cue;
  float best = kNever;  // score, or cued grey
  double at = 0;
  ProjectionWork& work;
};

// Where a block stands: its first sample in whole voxels and the rest, its ends as distances from there.
struct Block {
  double t = 0;
  std::int64_t whole[3] = {0, 0, 0};
  float part[3] = {0, 0, 0};
  float begin = 0, end = 0, least = 0, most = 0;
  float lanes = 0;  // that are steps of the part
  bool cut = false;
};

HWY_INLINE Block BlockAt(const Part& r, std::int64_t block) {
  const double step = r.p.job->step_mm;
  Block b;
  const std::int64_t first = r.steps.first + block * kBlock;
  b.t = (static_cast<double>(first) + 0.5) * step;
  const glm::dvec3 at = r.ray.at(b.t);
  for (int a = 0; a < 3; ++a) {
    const double whole = std::floor(at[a]);
    b.whole[a] = static_cast<std::int64_t>(whole);
    b.part[a] = static_cast<float>(at[a] - whole);
  }
  b.begin = static_cast<float>(r.from - b.t), b.end = static_cast<float>(r.to - b.t);
  b.least = static_cast<float>(r.least - b.t), b.most = static_cast<float>(r.most - b.t);
  b.lanes = static_cast<float>(r.steps.count - block * kBlock);
  // The samples of the last two steps of an extremum may lie beyond the part's end.
  b.cut = block == 0 || (block + 1) * kBlock + 1 >= r.steps.count;
  return b;
}

struct Lanes {
  V t, weight;  // mm from the block's first sample; mm that the sample stands for
};

// Extrema: the sample is moved to the part's end where it lies beyond a border. Integrals: to the middle of
// what the part has of the step.
template <Gather kG>
HWY_INLINE Lanes LanesOf(const Part& r, const Block& b, int first) {
  const D d;
  const V step = hn::Set(d, static_cast<float>(r.p.job->step_mm));
  const V t = hn::Mul(hn::Iota(d, static_cast<float>(first)), step);
  const V begin = hn::Set(d, b.begin), end = hn::Set(d, b.end);
  const V least = hn::Set(d, b.least), most = hn::Set(d, b.most);
  if constexpr (kG == Gather::Extreme || kG == Gather::Cued)
    return {b.cut ? hn::Min(hn::Max(t, least), most) : t, step};
  if (!b.cut) return {t, step};
  const V half = hn::Mul(step, hn::Set(d, 0.5f)), front = hn::Sub(t, half), back = hn::Add(t, half);
  const auto within = [](V v, V low, V high) { return hn::Min(hn::Max(v, low), high); };
  return {hn::Mul(hn::Add(within(front, least, most), within(back, least, most)), hn::Set(d, 0.5f)),
          hn::Sub(within(back, begin, end), within(front, begin, end))};
}

struct Place {
  VI cell[3];  // from the block's whole voxel
  V fraction[3];
};

HWY_INLINE Place PlaceOf(const Part& r, const Block& b, V t) {
  const D d;
  const DI di;
  Place at;
  for (int a = 0; a < 3; ++a) {
    const V pos = hn::MulAdd(t, hn::Set(d, static_cast<float>(r.ray.direction[a])), hn::Set(d, b.part[a]));
    const std::int64_t last = r.p.read.last[static_cast<std::size_t>(a)];
    VI c = hn::ConvertTo(di, hn::Floor(pos));
    c = hn::Min(hn::Max(c, Saturated(-b.whole[a])), Saturated(last - 1 - b.whole[a]));
    at.cell[a] = c;
    at.fraction[a] = hn::Min(hn::Max(hn::Sub(pos, hn::ConvertTo(d, c)), hn::Zero(d)), hn::Set(d, 1.0f));
  }
  return at;
}

HWY_INLINE VI FineIndex(const FastProjection& p, const Block& b, const Place& at) {
  const DI di;
  VI brick[3];
  for (int a = 0; a < 3; ++a)
    brick[a] = hn::ShiftRight<2>(hn::Add(at.cell[a], hn::Set(di, static_cast<std::int32_t>(b.whole[a]))));
  static_assert(kFineEdge == 4);
  return hn::Add(brick[0], hn::Mul(hn::Set(di, p.fineSize[0]),
                                   hn::Add(brick[1], hn::Mul(hn::Set(di, p.fineSize[1]), brick[2]))));
}

template <class T>
HWY_INLINE V Trilinear(const FastProjection& p, const Block& b, const Place& at) {
  const FastSlice& s = p.read;
  const std::int64_t base = b.whole[0] * s.stride[0] + b.whole[1] * s.stride[1] + b.whole[2] * s.stride[2];
  const auto* const data = reinterpret_cast<const std::uint8_t*>(reinterpret_cast<std::uintptr_t>(s.data) +
                                                                 static_cast<std::uintptr_t>(base));
  const VI offset = OffsetOf<T>(s, at.cell[0], at.cell[1], at.cell[2]);
  NoData unused;
  const auto row = [&](const std::uint8_t* from) {
    return AlongX<T, false, false>(s, from, offset, at.fraction[0], unused);
  };
  const std::uint8_t* const up = data + s.stride[2];
  const V low = Lerp<false>(row(data), row(data + s.stride[1]), at.fraction[1]);
  const V high = Lerp<false>(row(up), row(up + s.stride[1]), at.fraction[1]);
  return Lerp<false>(low, high, at.fraction[2]);
}

// Lanes beside no-data are done again in double; those without data leave `active`.
template <class T>
HWY_NOINLINE V Redo(const Part& r, const Block& b, V t, V w, M redo, M& active) {
  const D d;
  float times[kBlock], values[kBlock], wanted[kBlock], good[kBlock];
  hn::StoreU(t, d, times);
  hn::StoreU(w, d, values);
  hn::StoreU(hn::IfThenElseZero(redo, hn::Set(d, 1.0f)), d, wanted);
  hn::StoreU(hn::IfThenElseZero(active, hn::Set(d, 1.0f)), d, good);
  const GeneralSampler<T> sampler(*r.p.job->volume);
  std::uint64_t counted = 0;  // the caller has counted it
  for (std::size_t n = 0; n < hn::Lanes(d); ++n) {
    if (wanted[n] == 0 || good[n] == 0) continue;
    const double m = sampler.linear(r.ray.at(b.t + static_cast<double>(times[n])), counted);
    if (std::isnan(m))
      good[n] = 0;
    else
      values[n] = static_cast<float>((m - r.p.intercept) / r.p.slope - r.p.read.bias);
  }
  active = hn::Gt(hn::LoadU(d, good), hn::Zero(d));
  return hn::LoadU(d, values);
}

// w of the lanes that may matter: those whose bound passes `least`. False: none does.
template <class T, bool kHoles>
HWY_INLINE bool ReadLanes(const Part& r, const Block& b, int first, V t, float least, V& w, M& active) {
  const D d;
  const FastProjection& p = r.p;
  const Place at = PlaceOf(r, b, t);
  active = hn::Lt(hn::Iota(d, static_cast<float>(first)), hn::Set(d, b.lanes));
  if (p.fine) {
    const VI index = FineIndex(p, b, at);
    const V bound =
        hn::MulAdd(hn::GatherIndex(d, p.fine, index), hn::Set(d, p.boundScale), hn::Set(d, p.boundOffset));
    active = hn::And(active, hn::Gt(bound, hn::Set(d, least)));
    if (hn::AllFalse(d, active)) return false;
    w = Trilinear<T>(p, b, at);
    if constexpr (kHoles) {
      const M redo = hn::And(active, hn::Gt(hn::GatherIndex(d, p.holes, index), hn::Zero(d)));
      if (!hn::AllFalse(d, redo)) w = Redo<T>(r, b, t, w, redo, active);
    }
  } else {
    if (hn::AllFalse(d, active)) return false;
    w = Trilinear<T>(p, b, at);
  }
  r.work.samples += hn::CountTrue(d, active);
  return true;
}

HWY_INLINE V GreyOf(const FastProjection& p, V score) {
  const D d;
  const V grey = hn::MulAdd(score, hn::Set(d, p.greyScale), hn::Set(d, p.greyOffset));
  return hn::Min(hn::Max(grey, hn::Zero(d)), hn::Set(d, 1.0f));
}

template <class T, Gather kG, bool kHoles>
HWY_INLINE void TakeBlock(Part& r, std::int64_t block, float least) {
  const D d;
  const Block b = BlockAt(r, block);
  for (int first = 0; first < kBlock; first += static_cast<int>(hn::Lanes(d))) {
    const Lanes lanes = LanesOf<kG>(r, b, first);
    V w;
    M active;
    if (!ReadLanes<T, kHoles>(r, b, first, lanes.t, least, w, active)) continue;
    V score = hn::Mul(w, hn::Set(d, r.p.sign));
    if constexpr (kG == Gather::Cued) {
      const V t = hn::Add(lanes.t, hn::Set(d, static_cast<float>(b.t)));
      V cue =
          hn::MulAdd(t, hn::Set(d, static_cast<float>(r.cue.c1)), hn::Set(d, static_cast<float>(r.cue.c0)));
      if (r.cue.c2 != 0) cue = hn::Add(cue, hn::Div(hn::Set(d, static_cast<float>(r.cue.c2)), t));
      score = hn::Mul(GreyOf(r.p, score), hn::Min(cue, hn::Set(d, 1.0f)));
    }
    score = hn::IfThenElse(active, score, hn::Set(d, kNever));
    const float most = hn::GetLane(hn::MaxOfLanes(d, score));
    if (!(most > r.best)) continue;
    r.best = most;
    float times[kBlock];
    hn::StoreU(lanes.t, d, times);
    const intptr_t lane = hn::FindFirstTrue(d, hn::Eq(score, hn::Set(d, most)));
    r.at = b.t + static_cast<double>(times[lane]);
  }
}

// Bounds of the groups of 8 steps, as scores; an even number of them.
HWY_INLINE const float* GroupBounds(const Part& r, std::int64_t groups, std::vector<float>& store) {
  const D d;
  const DI di;
  const FastProjection& p = r.p;
  const auto lanes = static_cast<std::int64_t>(hn::Lanes(d));
  store.resize(static_cast<std::size_t>(groups + 2 * lanes));
  const double step = p.job->step_mm;
  const glm::dvec3 at = r.ray.at(r.from);
  const double firstCentre = static_cast<double>(r.steps.first + kGroup / 2) * step - r.from;
  const V length = hn::Set(d, static_cast<float>(r.to - r.from));
  for (std::int64_t g = 0; g < groups; g += lanes) {
    const V centre =
        hn::MulAdd(hn::Iota(d, static_cast<float>(g)), hn::Set(d, static_cast<float>(kGroup * step)),
                   hn::Set(d, static_cast<float>(firstCentre)));
    const V t = hn::Min(hn::Max(centre, hn::Zero(d)), length);
    VI brick[3];
    for (int a = 0; a < 3; ++a) {
      const V pos = hn::MulAdd(t, hn::Set(d, static_cast<float>(r.ray.direction[a])),
                               hn::Set(d, static_cast<float>(at[a])));
      static_assert(kCoarseEdge == 8);
      brick[a] = hn::Min(hn::Max(hn::ShiftRight<3>(hn::ConvertTo(di, pos)), hn::Zero(di)),
                         hn::Set(di, p.coarseSize[a] - 1));
    }
    const VI index =
        hn::Add(brick[0], hn::Mul(hn::Set(di, p.coarseSize[0]),
                                  hn::Add(brick[1], hn::Mul(hn::Set(di, p.coarseSize[1]), brick[2]))));
    const V bound =
        hn::MulAdd(hn::GatherIndex(d, p.coarse, index), hn::Set(d, p.boundScale), hn::Set(d, p.boundOffset));
    hn::StoreU(bound, d, store.data() + g);
  }
  for (std::int64_t g = groups; g % 2; ++g) store[static_cast<std::size_t>(g)] = kNever;
  return store.data();
}

// The coarse bounds speak of 4 voxels around a group's middle.
HWY_INLINE bool GroupsAreShort(const Part& r) {
  const glm::dvec3 step = r.p.job->step_mm * glm::abs(r.ray.direction);
  return (kGroup / 2) * std::max(step.x, std::max(step.y, step.z)) <= kCoarseReach_vox * 1.0001;
}

// One bound a block; null: every block must be read.
HWY_INLINE const float* BlockBounds(const Part& r, std::int64_t blocks) {
  thread_local std::vector<float> store;
  if (!r.p.coarse || !GroupsAreShort(r)) return nullptr;
  GroupBounds(r, (r.steps.count + kGroup - 1) / kGroup, store);
  for (std::int64_t b = 0; b < blocks; ++b) {
    const auto g = static_cast<std::size_t>(2 * b);
    store[static_cast<std::size_t>(b)] = std::max(store[g], store[g + 1]);
  }
  return store.data();
}

// The greatest grey that a block may show.
HWY_INLINE float CuedBound(const Part& r, std::int64_t block, float score) {
  const double t = std::max(r.from, static_cast<double>(r.steps.first + block * kBlock) * r.p.job->step_mm);
  const float grey = std::clamp(score * r.p.greyScale + r.p.greyOffset, 0.0f, 1.0f);
  return grey * static_cast<float>(r.cue.at(t)) * 1.000001f;
}

template <class T, Gather kG, bool kHoles>
void Extreme(const FastProjection& p, const VoxelRay& ray, const RayStretch& s, RayHint& hint, Gathered& out,
             ProjectionWork& work) {
  Part r{p,
         ray,
         s.from_mm,
         s.to_mm,
         s.from_mm,
         s.to_mm,
         stepsOf(s, p.job->step_mm, true),
         cueAlong(*p.job, ray),
         kNever,
         0,
         work};
  const std::int64_t blocks = (r.steps.count + kBlock - 1) / kBlock;
  const float* const bounds = BlockBounds(r, blocks);
  const auto boundOf = [&](std::int64_t b) {
    if (!bounds) return std::numeric_limits<float>::infinity();
    return kG == Gather::Cued ? CuedBound(r, b, bounds[b]) : bounds[b];
  };
  // Lanes of a cued block are not told apart by their bounds: what is read may win by lying nearer.
  const auto take = [&](std::int64_t b) {
    TakeBlock<T, kG, kHoles>(r, b, kG == Gather::Cued ? kNever : r.best);
  };
  // Where the neighbour's lay: a good start leaves out most of the rest.
  std::int64_t begun = static_cast<std::int64_t>(hint.at_mm / p.job->step_mm) - r.steps.first;
  begun = begun >= 0 && begun < r.steps.count && hint.at_mm >= 0 ? begun / kBlock : -1;
  if (begun >= 0 && boundOf(begun) > r.best) take(begun);
  for (std::int64_t b = 0; b < blocks; ++b)
    if (b != begun && boundOf(b) > r.best) take(b);
  if (r.best == kNever) return;
  hint.at_mm = r.at;
  out.at_mm = r.at;
  out.best = kG == Gather::Cued ? static_cast<double>(r.best) : p.modalityOf(static_cast<double>(r.best));
}

// Emission: grey by mm. Mean: w by mm, and the mm that have data.
template <class T, Gather kG, bool kHoles>
void Integral(const FastProjection& p, const VoxelRay& ray, const RayStretch& s, RayHint&, Gathered& out,
              ProjectionWork& work) {
  const D d;
  Part r{p,  ray,    s.from_mm, s.to_mm, s.least_mm(), s.most_mm(), stepsOf(s, p.job->step_mm, false),
         {}, kNever, 0,         work};
  const std::int64_t blocks = (r.steps.count + kBlock - 1) / kBlock;
  // A score that still emits nothing; a mean needs every value.
  const float dark = kG == Gather::Emission ? -p.greyOffset / p.greyScale : kNever;
  const float* const bounds = kG == Gather::Emission ? BlockBounds(r, blocks) : nullptr;
  V sum = hn::Zero(d), length = hn::Zero(d);
  for (std::int64_t n = 0; n < blocks; ++n) {
    if (bounds && !(bounds[n] > dark)) continue;
    const Block b = BlockAt(r, n);
    for (int first = 0; first < kBlock; first += static_cast<int>(hn::Lanes(d))) {
      const Lanes lanes = LanesOf<kG>(r, b, first);
      V w;
      M active;
      if (!ReadLanes<T, kHoles>(r, b, first, lanes.t, dark, w, active)) continue;
      const V value = kG == Gather::Emission ? GreyOf(p, hn::Mul(w, hn::Set(d, p.sign))) : w;
      sum = hn::Add(sum, hn::IfThenElseZero(active, hn::Mul(value, lanes.weight)));
      if constexpr (kG == Gather::Mean) length = hn::Add(length, hn::IfThenElseZero(active, lanes.weight));
    }
  }
  const double total = static_cast<double>(hn::GetLane(hn::SumOfLanes(d, sum)));
  if constexpr (kG == Gather::Emission) {
    out.integral = total, out.length_mm = s.to_mm - s.from_mm;
  } else {
    out.length_mm = static_cast<double>(hn::GetLane(hn::SumOfLanes(d, length)));
    out.integral = p.slope * total + (p.slope * p.read.bias + p.intercept) * out.length_mm;
  }
}

template <class T, bool kHoles>
FastKernel KernelOf(Gather gather) {
  switch (gather) {
    case Gather::Extreme:
      return Extreme<T, Gather::Extreme, kHoles>;
    case Gather::Cued:
      return Extreme<T, Gather::Cued, kHoles>;
    case Gather::Emission:
      return Integral<T, Gather::Emission, kHoles>;
    case Gather::Mean:
      break;
  }
  return Integral<T, Gather::Mean, kHoles>;
}

template <class T>
FastKernel KernelOf(const FastProjection& p) {
  const Gather gather = gatherOf(*p.job);
  return p.holes ? KernelOf<T, true>(gather) : KernelOf<T, false>(gather);
}

FastKernel KernelFor(const FastProjection& p) {
  switch (p.job->volume->type()) {
    case VoxelType::U8:
      return KernelOf<std::uint8_t>(p);
    case VoxelType::U16:
      return KernelOf<std::uint16_t>(p);
    case VoxelType::I16:
      return KernelOf<std::int16_t>(p);
    default:
      return KernelOf<float>(p);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace vernier::native
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vernier::native {

HWY_EXPORT(KernelFor);

FastKernel fastKernelFor(const FastProjection& p) { return HWY_DYNAMIC_DISPATCH(KernelFor)(p); }

}  // namespace vernier::native
#endif
