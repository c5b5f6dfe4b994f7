// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>

#include "ExactField.h"
#include "ProjectionBounds.h"
#include "ProjectionRay.h"

namespace vernier::native {
namespace {

// Where the cubic passes `level` between a and b, when it does; it is monotonic there.
void addCrossing(const Cubic& g, double level, double a, double b, std::vector<double>& out) {
  const bool rises = g.at(b) > g.at(a);
  if ((g.at(a) < level) == (g.at(b) < level)) return;
  for (int n = 0; n < 60 && b > a; ++n) {
    const double middle = 0.5 * (a + b);
    if (middle <= a || middle >= b) break;
    ((g.at(middle) < level) == rises ? a : b) = middle;
  }
  out.push_back(0.5 * (a + b));
}

double antiderivative(const Cubic& g, double s) {
  return s * (g.c0 + s * (g.c1 / 2 + s * (g.c2 / 3 + s * g.c3 / 4)));
}

// Of clamp(g, 0, 1) over [0, 1].
double integralClamped(const Cubic& g) {
  const std::array<double, 4> control{g.c0, g.c0 + g.c1 / 3, g.c0 + (2 * g.c1 + g.c2) / 3,
                                      g.c0 + g.c1 + g.c2 + g.c3};
  const auto [low, high] = std::minmax_element(control.begin(), control.end());
  if (*high <= 0) return 0;
  if (*low >= 1) return 1;
  if (*low >= 0 && *high <= 1) return antiderivative(g, 1);
  double extrema[2];
  const int n = extremaInside(g, extrema);
  std::vector<double> monotonic{0, 1};
  monotonic.insert(monotonic.end(), extrema, extrema + n);
  std::sort(monotonic.begin(), monotonic.end());
  std::vector<double> cuts = monotonic;
  for (std::size_t i = 0; i + 1 < monotonic.size(); ++i)
    for (const double level : {0.0, 1.0}) addCrossing(g, level, monotonic[i], monotonic[i + 1], cuts);
  std::sort(cuts.begin(), cuts.end());
  double sum = 0;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    const double value = g.at(0.5 * (cuts[i] + cuts[i + 1]));
    if (value >= 1)
      sum += cuts[i + 1] - cuts[i];
    else if (value > 0)
      sum += antiderivative(g, cuts[i + 1]) - antiderivative(g, cuts[i]);
  }
  return sum;
}

// The field along a ray's part, in groups of steps whose bound may leave them out.
template <class T>
class ExactPart {
 public:
  ExactPart(const ProjectionJob& job, const VoxelRay& ray, double from, double to)
      : job_(job),
        ray_(ray),
        from_(from),
        length_(to - from),
        grid_(cellGridOf<T>(*job.volume)),
        rescale_(job.volume->rescaleOf(0)),
        walk_(grid_, ray.at(from), length_ * ray.direction) {
    const glm::dvec3 reach = 4 * job.step_mm * glm::abs(ray.direction);
    group_ = 8 * job.step_mm / length_;
    leavesOut_ = job.bounds && std::max(reach.x, std::max(reach.y, reach.z)) <= kCoarseReach_vox;
  }

  // A single point lies in no cell's inside.
  bool meetsVolume() const { return walk_.meetsVolume(); }

  Gathered extreme(const Gathered& start, ExactWork& work) {
    const bool greatest = job_.mode != ProjectionMode::Min;
    const double sign = greatest == (rescale_.slope > 0) ? 1 : -1;
    Greatest<T> search(sign);
    search.begin(-std::numeric_limits<double>::infinity(), -1);
    if (start.best == start.best) {
      // The sampled pass is in float: what it found is reached up to its rounding.
      const double stored = (start.best - rescale_.intercept) / rescale_.slope;
      search.begin(sign * stored - 1e-5 * (1 + std::abs(stored)), (start.at_mm - from_) / length_);
    }
    bricks(
        [&](float high, float low) {
          const double modality = static_cast<double>(greatest ? high : low);
          return sign * (modality - rescale_.intercept) / rescale_.slope > search.best();
        },
        [&](double a, double b) { search.within(walk_, a, b, work); });
    Gathered out;
    out.best = rescale_.intercept + rescale_.slope * sign * search.best();
    out.at_mm = from_ + search.place() * length_;
    out.length_mm = length_;
    return out;
  }

  Gathered emission(ExactWork& work) {
    const VoiRamp ramp = rampOf(job_.window);
    const double scale = 1 / (ramp.hi - ramp.lo);
    double sum = 0;
    bricks([&](float high, float) { return static_cast<double>(high) > ramp.lo; },
           [&](double a, double b) {
             pieces(a, b, work, [&](Cubic c, double length) {
               for (double* x : {&c.c0, &c.c1, &c.c2, &c.c3}) *x *= rescale_.slope * scale;
               c.c0 += (rescale_.intercept - ramp.lo) * scale;
               sum += length * integralClamped(c);
             });
           });
    Gathered out;
    out.integral = sum * length_, out.length_mm = length_;
    return out;
  }

  Gathered mean(ExactWork& work) {
    Gathered out;
    double sum = 0;
    pieces(walk_.begin(), walk_.end(), work,
           [&](const Cubic& c, double length) { sum += length * antiderivative(c, 1); });
    out.length_mm = (walk_.end() - walk_.begin()) * length_;
    out.integral = rescale_.slope * sum * length_ + rescale_.intercept * out.length_mm;
    return out;
  }

 private:
  // Calls take(a, b) for the stretches whose bounds matter: by coarse bricks first, then by fine ones.
  template <class Matters, class Take>
  void bricks(Matters&& matters, Take&& take) {
    if (!leavesOut_) return take(walk_.begin(), walk_.end());
    const BoundsLevel& coarse = job_.bounds->coarse;
    for (double a = walk_.begin(); a < walk_.end();) {
      const double b = std::min(a + group_, walk_.end());
      const glm::dvec3 middle = ray_.at(from_ + 0.5 * (a + b) * length_);
      std::int64_t at[3];
      for (int n = 0; n < 3; ++n)
        at[n] = std::clamp(static_cast<std::int64_t>(std::floor(middle[n] / kCoarseEdge)), std::int64_t{0},
                           static_cast<std::int64_t>(coarse.size[static_cast<std::size_t>(n)]) - 1);
      const std::size_t index = coarse.index(at[0], at[1], at[2]);
      if (matters(coarse.greatest[index], coarse.least[index])) fineBricks(a, b, matters, take);
      a = b;
    }
  }

  template <class Matters, class Take>
  void fineBricks(double a, double b, Matters&& matters, Take&& take) {
    const BoundsLevel& fine = job_.bounds->fine;
    const glm::dvec3 origin = ray_.at(from_), direction = length_ * ray_.direction;
    const glm::dvec3 at = origin + a * direction;
    std::int64_t brick[3];
    double next[3];
    const auto faceAhead = [&](int n) {
      if (std::abs(direction[n]) <= kParallel_vox) return std::numeric_limits<double>::infinity();
      const double face = static_cast<double>(kFineEdge * (brick[n] + (direction[n] > 0 ? 1 : 0)));
      return (face - origin[n]) / direction[n];
    };
    for (int n = 0; n < 3; ++n) {
      brick[n] = static_cast<std::int64_t>(std::floor(at[n] / kFineEdge));
      next[n] = faceAhead(n);
    }
    const auto bounded = [&](int n) {
      return std::clamp(brick[n], std::int64_t{0},
                        static_cast<std::int64_t>(fine.size[static_cast<std::size_t>(n)]) - 1);
    };
    for (double t = a; t < b;) {
      const int axis = next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : (next[1] < next[2] ? 1 : 2);
      const double end = std::min(next[axis], b);
      const std::size_t index = fine.index(bounded(0), bounded(1), bounded(2));
      if (end > t && matters(fine.greatest[index], fine.least[index])) take(t, end);
      t = std::max(t, end);
      if (end >= b) break;
      brick[axis] += direction[axis] > 0 ? 1 : -1;
      next[axis] = faceAhead(axis);
    }
  }

  // Calls fn(cubic of stored values, length) for the pieces of [a, b] within one cell each.
  template <class Fn>
  void pieces(double a, double b, ExactWork& work, Fn&& fn) {
    T stored[8];
    double v[8], f[3], g[3];
    for (walk_.enter(a);; walk_.step()) {
      const double end = std::min(walk_.exit(), b), length = end - walk_.entry();
      ++work.cells;
      if (length > 0) {
        ++work.samples;
        walk_.corners(stored);
        signedCorners(stored, 1, v);
        walk_.fractions(walk_.entry(), f);
        for (int n = 0; n < 3; ++n) g[n] = length * walk_.direction()[n];
        fn(cubicAlong(v, f, g), length);
      }
      if (walk_.atEnd() || walk_.exit() >= b) break;
    }
  }

  const ProjectionJob& job_;
  const VoxelRay& ray_;
  double from_, length_;
  CellGrid<T> grid_;
  ModalityRescale rescale_;
  CellWalk<T> walk_;
  double group_ = 1;
  bool leavesOut_ = false;
};

template <class T>
Gathered gather(const ProjectionJob& job, const VoxelRay& ray, double from, double to, const Gathered& start,
                ProjectionWork& work) {
  ExactPart<T> part(job, ray, from, to);
  if (!part.meetsVolume()) return {};
  ExactWork done;
  const Gather how = gatherOf(job);
  const Gathered out = how == Gather::Extreme    ? part.extreme(start, done)
                       : how == Gather::Emission ? part.emission(done)
                                                 : part.mean(done);
  work.samples += done.samples, work.cells += done.cells;
  return out;
}

}  // namespace

Gathered gatherExact(const ProjectionJob& job, const VoxelRay& ray, double from, double to,
                     const Gathered& start, ProjectionWork& work) {
  switch (job.volume->type()) {
    case VoxelType::U8:
      return gather<std::uint8_t>(job, ray, from, to, start, work);
    case VoxelType::I8:
      return gather<std::int8_t>(job, ray, from, to, start, work);
    case VoxelType::U16:
      return gather<std::uint16_t>(job, ray, from, to, start, work);
    case VoxelType::I16:
      return gather<std::int16_t>(job, ray, from, to, start, work);
    case VoxelType::U32:
      return gather<std::uint32_t>(job, ray, from, to, start, work);
    case VoxelType::I32:
      return gather<std::int32_t>(job, ray, from, to, start, work);
    case VoxelType::F32:
      break;
  }
  return gather<float>(job, ray, from, to, start, work);
}

std::string whyNotExact(const ProjectionJob& job) {
  const Volume& v = *job.volume;
  if (job.interpolation != Interpolation::Linear)
    return "It follows the linear field, and nearest was asked for.";
  if (job.cue > 0) return "It follows the field, and a depth cue weighs it along the ray.";
  if (!v.grid().even()) return "It needs evenly spaced slices without a gap.";
  if (v.info().rescale.size() > 1) return "It needs one rescale for all slices.";
  if (v.info().noData) return "It needs data in every voxel, and the volume declares padding.";
  if (v.type() == VoxelType::F32 && mayHoldNan(v))
    return "It needs data in every voxel, and some may not be a number.";
  if (gatherOf(job) == Gather::Emission) {
    if (job.window.function == VoiFunction::Sigmoid)
      return "It integrates a window that is a ramp, and this one is a sigmoid.";
    if (const VoiRamp r = rampOf(job.window); !(r.hi > r.lo))
      return "It integrates a window that is a ramp, and this one is a step.";
  }
  return "";
}

}  // namespace vernier::native
