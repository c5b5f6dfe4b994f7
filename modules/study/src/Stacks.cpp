// SPDX-License-Identifier: GPL-3.0-or-later
#include "Stacks.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <tuple>

#include "SplitKeys.h"
#include "StackGeometry.h"
#include "vernier/study/Limits.h"

namespace vernier {
namespace {

using Records = std::vector<Record>;
using Group = std::vector<FrameGroup>;

// Each member joins the first group whose first member it equals by all keys; members are in a fixed order,
// so the result is too. Members beyond kMaxStacksPerSeries groups go into one more.
std::vector<Group> split(const Records& records, const Group& members,
                         const std::vector<const SplitKey*>& keys) {
  std::vector<Group> groups;
  // Texts that must be equal find the groups in question; only those are compared by tolerance.
  std::map<std::string, std::vector<std::size_t>> byText;
  for (const FrameGroup& m : members) {
    const FrameView view = viewOf(records, m);
    std::string text;
    for (const SplitKey* k : keys)
      if (!k->equal) text += k->value(view) + '\x1f';
    std::vector<std::size_t>& candidates = byText[text];
    const auto same = [&](std::size_t g) {
      const FrameView first = viewOf(records, groups[g][0]);
      return std::all_of(keys.begin(), keys.end(),
                         [&](const SplitKey* k) { return !k->equal || k->equal(first, view); });
    };
    const auto g = std::find_if(candidates.begin(), candidates.end(), same);
    if (g != candidates.end()) {
      groups[*g].push_back(m);
    } else if (groups.size() > limits::kMaxStacksPerSeries) {
      groups.back().push_back(m);
    } else {
      candidates.push_back(groups.size());
      groups.push_back({m});
    }
  }
  return groups;
}

std::vector<SlicePlane> planesOf(const Records& records, const Group& g) {
  std::vector<SlicePlane> planes;
  for (std::size_t i = 0; i < g.size(); ++i)
    planes.push_back({*viewOf(records, g[i]).frame->plane, static_cast<std::int64_t>(i)});
  return planes;
}

// Frames of an object that does not describe them one by one have no places of their own.
bool anyUndescribed(const Group& g) {
  return std::any_of(g.begin(), g.end(), [](const FrameGroup& m) { return m.count > 1; });
}

bool positionsCoincide(const Records& records, const Group& g) {
  if (!viewOf(records, g[0]).frame->plane) return false;
  const auto planes = planesOf(records, g);
  const auto order = orderAlongNormal(planes);
  const PatientVec n = cross(planes[0].plane.rowDirection, planes[0].plane.columnDirection);
  for (std::size_t k = 1; k < order.size(); ++k)
    if (dot(planes[order[k]].plane.origin - planes[order[k - 1]].plane.origin, n) <= kCoincident_mm)
      return true;
  return false;
}

struct Parts {
  std::vector<Group> groups;
  SplitKey key;
};
// The first tie attribute that makes every position unique; nothing when there is none.
std::optional<Parts> tellApart(const Records& records, const Group& g) {
  for (const SplitKey& key : tieKeys(records, g)) {
    auto parts = split(records, g, {&key});
    if (parts.size() < 2 || parts.size() > limits::kMaxStacksPerSeries) continue;
    if (std::none_of(parts.begin(), parts.end(),
                     [&](const Group& p) { return positionsCoincide(records, p); }))
      return Parts{std::move(parts), key};
  }
  return std::nullopt;
}

// Without geometry: by object, then by the frames' dimension index values, which are 1-based positions.
void fillForBrowsing(const Records& records, Group g, Stack& stack) {
  std::stable_sort(g.begin(), g.end(), [&](const FrameGroup& a, const FrameGroup& b) {
    return a.record == b.record &&
           viewOf(records, a).frame->dimensionIndex < viewOf(records, b).frame->dimensionIndex;
  });
  for (const FrameGroup& m : g)
    for (std::uint64_t f = 0; f < m.count; ++f) stack.slices.push_back({m.record, m.first + f});
}

// A segmentation may leave out frames where a segment is empty (PS3.3 C.8.20.2): where all steps are
// multiples of the smallest, the places between are empty frames. Returns how many were added.
std::size_t addEmptyFrames(Stack& stack, std::vector<FramePlane>& planes) {
  const std::size_t n = planes.size();
  if (n < 2) return 0;
  const glm::dvec3 normal = glm::cross(planes[0].rowDirection.v, planes[0].columnDirection.v);
  std::vector<double> steps;
  for (std::size_t k = 1; k < n; ++k)
    steps.push_back(glm::dot(planes[k].origin.p - planes[k - 1].origin.p, normal));
  const double least = *std::min_element(steps.begin(), steps.end());
  if (!(least > kCoincident_mm)) return 0;
  std::vector<std::size_t> missing;
  std::size_t all = n;
  for (const double s : steps) {
    const double times = std::round(s / least);
    if (std::abs(s / least - times) > kUniformOfStep || times > 1e6) return 0;
    missing.push_back(static_cast<std::size_t>(times) - 1);
    all += missing.back();
  }
  if (all == n || all > limits::kMaxFrames) return 0;
  std::vector<SliceRef> slices{stack.slices[0]};
  std::vector<FramePlane> filled{planes[0]};
  for (std::size_t k = 1; k < n; ++k) {
    for (std::size_t m = 1; m <= missing[k - 1]; ++m) {
      const double t = static_cast<double>(m) / static_cast<double>(missing[k - 1] + 1);
      filled.push_back(planes[k]);
      filled.back().origin =
          PatientPoint(planes[k - 1].origin.p + t * (planes[k].origin.p - planes[k - 1].origin.p));
      slices.push_back({stack.slices[k].instance, SliceRef::kEmptyFrame});
    }
    filled.push_back(planes[k]);
    slices.push_back(stack.slices[k]);
  }
  stack.slices = std::move(slices);
  planes = std::move(filled);
  return all - n;
}

std::string whyBrowseOnly(const FrameView& first, bool undescribed, Stack& stack) {
  if (undescribed)
    return "The frames of this object have no positions of their own; they can be browsed only.";
  const bool crooked = first.keys->rawPlane && !first.frame->plane &&
                       !(first.keys->rawPlane->offOrthonormal <= kOrthonormalFlagged + 1e-9);
  if (!crooked) return "The images carry no usable position and orientation; they can be browsed only.";
  stack.findings.push_back(
      {"orientation-unusable",
       Severity::Refusal,
       "Row and column direction are not two perpendicular unit vectors; 3-D is refused.",
       {{"off_orthonormal", first.keys->rawPlane->offOrthonormal}}});
  return stack.findings.back().sentence;
}

void reportFixed(double off, Stack& stack) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", off);
  stack.orientationFixed = true;
  stack.findings.push_back({"orientation-fixed",
                            Severity::Notice,
                            std::string("Row and column direction are ") + text +
                                " off orthonormal and were made so; measurements are marked.",
                            {{"off_orthonormal", off}}});
}

Stack stackOf(const Records& records, const Group& g) {
  Stack stack;
  const FrameView first = viewOf(records, g[0]);
  const bool undescribed = anyUndescribed(g);
  if (!first.frame->plane || undescribed) {
    fillForBrowsing(records, g, stack);
    stack.why2d = whyBrowseOnly(first, undescribed, stack);
    return stack;
  }
  const auto planes = planesOf(records, g);
  std::vector<FramePlane> ordered;
  double off = 0;
  for (const std::size_t k : orderAlongNormal(planes)) {
    stack.slices.push_back({g[k].record, g[k].first});
    ordered.push_back(planes[k].plane);
    if (const auto& raw = viewOf(records, g[k]).keys->rawPlane) off = std::max(off, raw->offOrthonormal);
  }
  const Instance& i = first.record->instance;
  const std::size_t empty =
      i.segmentation != SegmentationKind::None ? addEmptyFrames(stack, ordered) : std::size_t{0};
  fitGeometry(ordered, static_cast<std::int64_t>(i.pixels.rows), static_cast<std::int64_t>(i.pixels.columns),
              first.frame->pixelSpacing_mm, stack);
  if (empty > 0)
    stack.findings.push_back({"empty-frames-left-out",
                              Severity::Info,
                              std::to_string(empty) +
                                  " frames in which the segment is empty are not in the file; they "
                                  "are shown as empty.",
                              {{"frames", static_cast<double>(empty)}}});
  if (off > kOrthonormalSilent + 1e-9) reportFixed(off, stack);
  if (isLocalizer(first) && stack.volume3d) {
    stack.volume3d = false;
    stack.why2d = "It is a localizer; it gives reference lines, never 3-D.";
  }
  return stack;
}

// Labels stand in menus and lines of text; what a file puts there may be of any length.
std::string shortened(std::string s) {
  constexpr std::size_t kLongest = 40;
  if (s.size() <= kLongest) return s;
  std::size_t end = kLongest;
  while (end > 0 && (static_cast<unsigned char>(s[end]) & 0xC0) == 0x80) --end;  // whole UTF-8 characters
  return s.substr(0, end) + "...";
}

// Planes of one orientation name ("coronal" at seven angles) still need to be told apart.
void numberEqualLabels(std::vector<Stack>& stacks) {
  std::map<std::string, std::size_t> uses, given;
  for (const Stack& s : stacks) ++uses[s.label];
  for (Stack& s : stacks)
    if (!s.label.empty() && uses[s.label] > 1) {
      const std::size_t n = ++given[s.label], of = uses[s.label];
      s.label += ", " + std::to_string(n) + " of " + std::to_string(of);
    }
}

std::string labelOf(const Records& records, const Group& g, const std::vector<SplitKey>& differing) {
  std::string label;
  for (const SplitKey& key : differing)
    label += (label.empty() ? "" : ", ") + key.name + " " + shortened(key.value(viewOf(records, g[0])));
  return label;
}

// By instance number, parts of a concatenation together and in their order, frames in theirs.
Group inOrder(const Records& records, std::vector<std::size_t> members) {
  std::map<std::string, std::int64_t> numberOf;  // of a concatenation: the lowest of its parts
  const auto number = [&](std::size_t m) { return records[m].instance.instanceNumber.value_or(0); };
  for (const std::size_t m : members)
    if (const auto& c = records[m].instance.concatenation) {
      const auto [at, isNew] = numberOf.try_emplace(c->uid, number(m));
      at->second = std::min(at->second, number(m));
    }
  const auto place = [&](std::size_t m) {
    const Instance& i = records[m].instance;
    return i.concatenation ? std::tuple(numberOf[i.concatenation->uid], i.concatenation->uid,
                                        i.concatenation->frameOffset)
                           : std::tuple(number(m), i.sopInstanceUid, std::uint64_t{0});
  };
  std::stable_sort(members.begin(), members.end(),
                   [&](std::size_t a, std::size_t b) { return place(a) < place(b); });
  Group out;
  for (const std::size_t m : members) {
    const Instance& i = records[m].instance;
    if (!i.frames) {
      out.push_back({m, 0, i.pixels.framesDeclared});
      continue;
    }
    for (std::uint64_t f = 0; f < i.frames->size(); ++f) out.push_back({m, f, 1});
  }
  return out;
}

// The keys in which the groups differ.
std::vector<SplitKey> differingKeys(const Records& records, const std::vector<Group>& groups) {
  Group firsts;
  for (const Group& g : groups) firsts.push_back(g[0]);
  std::vector<SplitKey> out;
  for (const SplitKey& key : splitKeys())
    if (split(records, firsts, {&key}).size() > 1) out.push_back(key);
  return out;
}

// Groups whose positions coincide are told apart by a tie key where one can.
std::vector<Group> withoutTies(const Records& records, std::vector<Group> groups,
                               std::vector<SplitKey>& differing) {
  std::vector<Group> out;
  std::set<std::string> named;
  for (Group& g : groups) {
    auto parts = !anyUndescribed(g) && positionsCoincide(records, g) ? tellApart(records, g) : std::nullopt;
    if (!parts) {
      out.push_back(std::move(g));
      continue;
    }
    if (named.insert(parts->key.name).second) differing.push_back(parts->key);
    for (Group& p : parts->groups) out.push_back(std::move(p));
  }
  return out;
}

void addPlaceFindings(const Record& r, Stack& stack) {
  if (r.quadruped)
    stack.findings.push_back(
        {"quadruped",
         Severity::Warning,
         "The patient is four-legged (Anatomical Orientation Type): the letters L R A P H F do not "
         "apply and are not shown.",
         {}});
  if (r.volumeFrame)
    stack.findings.push_back(
        {"not-patient-frame",
         Severity::Warning,
         "The frames are placed in the transducer's volume, not in the patient: the letters L R A "
         "P H F do not apply and are not shown.",
         {}});
}

Finding splitFinding(const std::vector<SplitKey>& differing, std::size_t stacks) {
  std::vector<std::string> names;
  std::string text;
  for (const SplitKey& k : differing) {
    names.push_back(k.name);
    text += (text.empty() ? "" : ", ") + k.name;
  }
  return {"split-into-stacks",
          Severity::Info,
          "The series is split by " + text + " into " + std::to_string(stacks) + " stacks.",
          {{"by", names}, {"stacks", static_cast<double>(stacks)}}};
}

// The last of more groups than there may be holds what was not split.
void refuseMixed(Stack& stack, std::vector<Finding>& findings) {
  stack.volume3d = false;
  stack.label = "the rest";
  stack.why2d = "The series would fall into more than " + std::to_string(limits::kMaxStacksPerSeries) +
                " stacks; these frames were not told apart and can be browsed only.";
  findings.push_back({"too-many-stacks", Severity::Refusal, stack.why2d, {}});
}

}  // namespace

bool sameGeometry(const Record& a, const Record& b) {
  const Instance &x = a.instance, &y = b.instance;
  const auto frames = [](const Instance& i) { return i.frames ? i.frames->size() : std::size_t{1}; };
  if (frames(x) != frames(y)) return false;
  for (std::uint64_t f = 0; f < frames(x); ++f) {
    const auto &p = a.keys(f).rawPlane, &q = b.keys(f).rawPlane;
    if (p.has_value() != q.has_value() || !sameSpacing(x.frame(f), y.frame(f))) return false;
    if (p && !(glm::length(p->position - q->position) <= kCoincident_mm &&
               glm::length(p->row - q->row) <= 1e-6 && glm::length(p->column - q->column) <= 1e-6))
      return false;
  }
  return true;
}

SplitResult makeStacks(const std::vector<Record>& records, std::vector<std::size_t> members) {
  SplitResult out;
  if (members.empty()) return out;
  std::vector<const SplitKey*> keys;
  for (const SplitKey& k : splitKeys()) keys.push_back(&k);
  std::vector<Group> groups = split(records, inOrder(records, std::move(members)), keys);
  const bool tooMany = groups.size() > limits::kMaxStacksPerSeries;
  std::vector<SplitKey> differing = differingKeys(records, groups);
  if (!tooMany) groups = withoutTies(records, std::move(groups), differing);

  for (const Group& g : groups) {
    out.stacks.push_back(stackOf(records, g));
    if (groups.size() > 1) out.stacks.back().label = labelOf(records, g, differing);
    addPlaceFindings(records[g[0].record], out.stacks.back());
  }
  if (tooMany) refuseMixed(out.stacks.back(), out.findings);
  numberEqualLabels(out.stacks);
  std::stable_sort(out.stacks.begin(), out.stacks.end(),
                   [](const Stack& a, const Stack& b) { return a.slices.size() > b.slices.size(); });
  if (groups.size() > 1) out.findings.push_back(splitFinding(differing, groups.size()));
  return out;
}

}  // namespace vernier
