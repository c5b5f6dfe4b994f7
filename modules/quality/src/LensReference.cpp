// SPDX-License-Identifier: GPL-3.0-or-later
#include "LensReference.h"

#include <algorithm>
#include <optional>

namespace vernier::quality {
namespace {

using Appearance = LensReference::Appearance;

template <class... Fns>
struct Overloaded : Fns... {
  using Fns::operator()...;
};
template <class... Fns>
Overloaded(Fns...) -> Overloaded<Fns...>;

Error notBuilt(const std::string& sentence) { return makeError(ErrorCode::NotBuiltYet, sentence); }

template <class R>
Result<Appearance> taken(Result<R> made) {
  if (!made) return made.error();
  return Appearance(std::move(*made));
}

// What a layer, or the inside of a lens, is made of.
struct Maker {
  const Scene& scene;
  const View& view;
  const Sources& sources;
  const ReferenceOptions& options;

  Result<Appearance> operator()(const ProjectionLayer& layer) const {
    auto made = ProjectionReference::make(scene, layer, view, sources);
    if (made && made->inverted())
      return notBuilt("An inverted projection cannot be joined with a lens, so no error is measured.");
    return taken(std::move(made));
  }
  Result<Appearance> operator()(const ShellsLayer& layer) const {
    return taken(ShellsReference::make(scene, layer, view, sources));
  }
  Result<Appearance> operator()(const VolumeLayer& layer) const {
    if (layer.mode != VolumeMode::Blend)
      return notBuilt(
          "With lenses a greatest or least value is drawn by a projection; of a volume layer in that mode "
          "no error is measured.");
    return taken(VolumeReference::make(scene, layer, view, sources, options));
  }
  Result<Appearance> operator()(const IsosurfaceLayer& layer) const {
    return taken(IsosurfaceReference::make(scene, layer, view, sources));
  }
  Result<Appearance> operator()(const CutOut&) const { return Appearance(); }
  template <class Other>
  Result<Appearance> operator()(const Other&) const {
    return makeError(ErrorCode::SceneInvalid, "A lens that shows 'slice' acts on slices.");
  }
};

Result<void> checkInside(const Layer& base, const LensInner& inner, const ReferenceOptions& options) {
  const std::string* source = std::visit(
      [](const auto& l) -> const std::string* {
        if constexpr (requires { l.source; })
          return &l.source;
        else
          return nullptr;
      },
      inner);
  if (source && *source != *volumeOf(base))
    return makeError(ErrorCode::SceneInvalid,
                     "A lens shows the volume that is seen around it, and names another.");
  const bool sampled = std::holds_alternative<VolumeLayer>(base) &&
                       (std::holds_alternative<VolumeLayer>(inner) || std::holds_alternative<CutOut>(inner));
  if (options.kind == ErrorKind::Implementation && !sampled)
    return notBuilt(
        "With lenses the reference samples blended volumes as an engine does; of other appearances it knows "
        "the continuous truth only (the model error).");
  return {};
}

std::uint64_t mixed(std::uint64_t key, std::uint64_t with) {
  key ^= with + 0x9e3779b97f4a7c15 + (key << 6) + (key >> 2);
  return key * 0xff51afd7ed558ccd;
}

std::size_t toolsBefore(const VolumeRay& ray, double t_mm) {
  return static_cast<std::size_t>(
      std::count_if(ray.tools.begin(), ray.tools.end(), [&](const RayTool& t) { return t.t_mm <= t_mm; }));
}

}  // namespace

Result<LensReference> LensReference::make(const Scene& scene, std::size_t base, const View& view,
                                          const Sources& sources, const ReferenceOptions& options) {
  LensReference r;
  r.lenses_ = *options.lenses;
  r.background_ = {scene.background.r, scene.background.g, scene.background.b};
  const Maker maker{scene, view, sources, options};
  auto outside = std::visit(maker, scene.layers[base]);
  if (!outside) return outside.error();
  r.appearances_.push_back(*std::move(outside));
  for (const PlacedLens& lens : r.lenses_) {
    const LensInner& inner = std::get<LensLayer>(scene.layers[lens.layer]).inner;
    if (auto ok = checkInside(scene.layers[base], inner, options); !ok) return ok.error();
    auto inside = std::visit(maker, inner);
    if (!inside) return inside.error();
    r.appearances_.push_back(*std::move(inside));
  }
  for (std::size_t n = 0; n < r.appearances_.size(); ++n) {
    r.groups_.push_back(n);
    const auto* one = std::get_if<ProjectionReference>(&r.appearances_[n]);
    for (std::size_t k = n + 1; one && k < r.appearances_.size(); ++k)
      if (const auto* other = std::get_if<ProjectionReference>(&r.appearances_[k]);
          other && one->sameMean(*other))
        r.groups_[n] = k;
  }
  return r;
}

const VolumeRays& LensReference::rays() const {
  return std::visit(Overloaded{[](const std::monostate&) -> const VolumeRays& { std::abort(); },
                               [](const auto& a) -> const VolumeRays& { return a.rays(); }},
                    appearances_[0]);
}

bool LensReference::ordered(std::size_t n) const {
  const auto* shells = std::get_if<ShellsReference>(&appearances_[n]);
  return (shells && shells->lit()) || std::holds_alternative<VolumeReference>(appearances_[n]) ||
         std::holds_alternative<IsosurfaceReference>(appearances_[n]);
}

// Whether level sets go on from one appearance into the other.
bool LensReference::goOn(std::size_t a, std::size_t b) const {
  const auto *one = std::get_if<ShellsReference>(&appearances_[a]),
             *other = std::get_if<ShellsReference>(&appearances_[b]);
  return one && other && one->lit() == other->lit() && one->sameLevels(*other);
}

std::vector<VolumeRay> LensReference::Parts::of(std::size_t group,
                                                const std::vector<std::size_t>& groups) const {
  std::vector<VolumeRay> out;
  for (std::size_t n = 0; n < parts.size(); ++n)
    if (groups[appearances[n]] == group) out.push_back(parts[n]);
  return out;
}

LensReference::Parts LensReference::cut(glm::dvec2 pixel) const {
  Parts p;
  p.whole = rays().ray(pixel);
  for (const LensPart& part : cutAtLenses(p.whole, lenses_)) {
    p.parts.push_back(partOf(p.whole, part));
    if (!p.appearances.empty() && goOn(p.appearances.back(), part.appearance))
      p.parts[p.parts.size() - 2].endsOpen = p.parts.back().beginsOpen = true;
    p.appearances.push_back(part.appearance);
  }
  return p;
}

std::vector<Gathering> LensReference::gatherings(const Parts& p) const {
  std::vector<Gathering> all;
  for (std::size_t n = 0; n < appearances_.size(); ++n) {
    if (ordered(n) || groups_[n] != n) continue;
    if (const auto* projection = std::get_if<ProjectionReference>(&appearances_[n]))
      all.push_back(projection->gathered(p.whole, p.of(n, groups_)));
    if (const auto* shells = std::get_if<ShellsReference>(&appearances_[n]))
      all.push_back(shells->gathered(p.whole, p.of(n, groups_)));
  }
  return all;
}

PartSeen LensReference::orderedPart(std::size_t n, const VolumeRay& part) const {
  return std::visit(Overloaded{[&](const ShellsReference& a) { return a.part(part); },
                               [&](const VolumeReference& a) { return a.part(part); },
                               [&](const IsosurfaceReference& a) { return a.part(part); },
                               [](const auto&) { return PartSeen{}; }},
                    appearances_[n]);
}

VolumeSeen LensReference::seen(glm::dvec2 pixel) const {
  const Parts p = cut(pixel);
  const VolumeRay& ray = p.whole;
  // Commuting appearances: the background of all that is ordered.
  const std::vector<Gathering> all = gatherings(p);
  const std::vector<const Gathering*> shown = shownOf(all);
  // Where nothing is gathered, what the outside has behind it.
  glm::dvec3 bare = background_;
  if (!ordered(0) && groups_[0] == 0) bare = all.front().bare;
  const glm::dvec3 behind = shown.empty() ? ray.backdrop(bare) : joined(shown, ray);
  // Front to back: tools and ordered parts.
  VolumeSeen out;
  double light = 1, orderedOnly = 1;
  std::size_t passed = 0;
  const auto passTools = [&](double upTo_mm) {
    for (; passed < ray.tools.size() && ray.tools[passed].t_mm <= upTo_mm; ++passed) {
      double reaching = light;
      for (const Gathering* g : shown) reaching *= g->reaching[passed];
      out.colour += reaching * ray.tools[passed].opacity * ray.tools[passed].colour;
      light *= 1 - ray.tools[passed].opacity;
    }
  };
  for (std::size_t n = 0; n < p.parts.size() && orderedOnly >= FrontToBack::kEnough; ++n) {
    const VolumeRay& part = p.parts[n];
    if (!ordered(p.appearances[n])) continue;
    for (double from = part.begin_mm; from < part.end_mm && orderedOnly >= FrontToBack::kEnough;) {
      passTools(from);
      const double to =
          passed < ray.tools.size() ? std::min(part.end_mm, ray.tools[passed].t_mm) : part.end_mm;
      const PartSeen seen = orderedPart(p.appearances[n], bareBetween(part, from, to));
      out.colour += light * seen.colour;
      light *= seen.left, orderedOnly *= seen.left;
      out.shown = out.shown || seen.left < 1;
      from = to;
    }
  }
  passTools(std::numeric_limits<double>::infinity());
  out.colour += orderedOnly * behind;
  out.shown = out.shown || !shown.empty();
  out.covered = out.shown || ray.opaque || !ray.tools.empty();
  return out;
}

PartMark LensReference::markPart(std::size_t n, const VolumeRay& part, double left,
                                 std::vector<EdgeMark::Hit>& hits) const {
  const std::size_t surfaces = n << 40;
  return std::visit(
      Overloaded{[](const std::monostate&) { return PartMark{}; },
                 [&](const ProjectionReference& a) { return a.mark(part); },
                 [&](const ShellsReference& a) { return a.mark(part); },
                 [&](const VolumeReference& a) { return a.mark(part, left, surfaces, hits); },
                 [&](const IsosurfaceReference& a) { return a.mark(part, left, surfaces, hits); }},
      appearances_[n]);
}

// The order of appearances on the ray as far as something is seen of them, or would be without the lens.
EdgeMark LensReference::edgeMark(glm::dvec2 pixel) const {
  const Parts p = cut(pixel);
  EdgeMark mark;
  mark.line = p.whole.line, mark.voxel_mm = rays().largestSpacing_mm();
  double left = 1, end_mm = std::numeric_limits<double>::infinity();
  for (std::size_t n = 0; n < p.parts.size() && left >= EdgeMark::kFound; ++n) {
    const std::size_t a = p.appearances[n];
    const VolumeRay& part = p.parts[n];
    const PartMark m = markPart(a, part, left, mark.hits);
    std::vector<EdgeMark::Hit> unused;
    const bool seen = m.shown || (a != 0 && markPart(0, part, left, unused).shown);
    if (!seen) continue;
    const bool bordered = m.shown && m.bordered;
    const bool begun = bordered && part.begunBy == Border::Cut,
               ended = bordered && m.left > 0 && part.endedBy == Border::Cut;
    mark.key = mixed(mark.key, 1 + 8 * a + (m.shown ? 1u : 0u) + (begun ? 2u : 0u) + (ended ? 4u : 0u));
    left *= m.left, end_mm = m.end_mm;
  }
  if (left >= EdgeMark::kFound) end_mm = std::numeric_limits<double>::infinity();
  mark.key = mixed(mark.key, toolsBefore(p.whole, end_mm));
  if (left >= EdgeMark::kFound && p.whole.opaque) mark.key = mixed(mark.key, p.whole.opaqueLayer + 1);
  return mark;
}

bool LensReference::contributes(std::size_t n, const LocalRange& values) const {
  if (isEmpty(n) || values.min > values.max) return false;
  // What is gathered inside shows instead of what is gathered outside, be it dark.
  if (n > 0 && !ordered(n)) return true;
  return std::visit(Overloaded{[](const std::monostate&) { return false; },
                               [&](const auto& a) { return a.contributes(values); }},
                    appearances_[n]);
}

}  // namespace vernier::quality
