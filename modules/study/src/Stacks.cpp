// SPDX-License-Identifier: GPL-3.0-or-later
#include "Stacks.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <set>

#include "StackGeometry.h"

namespace vernier {
namespace {

std::string shortNumber(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", v);
  return text;
}
std::string typeValue(const Record& r, std::size_t n) {
  return r.instance.imageType.size() > n ? r.instance.imageType[n] : std::string();
}
bool isLocalizer(const Record& r) { return typeValue(r, 2) == "LOCALIZER"; }

// One attribute that splits a series: equal or not, and how to say its value.
struct SplitKey {
  const char* name;
  std::function<bool(const Record&, const Record&)> equal;
  std::function<std::string(const Record&)> value;
};

SplitKey textKey(const char* name, std::function<std::string(const Record&)> value) {
  return {name, [value](const Record& a, const Record& b) { return value(a) == value(b); }, value};
}
bool close(double a, double b, double tolerance) { return std::abs(a - b) <= tolerance; }
bool close(const std::optional<double>& a, const std::optional<double>& b, double tolerance) {
  return a.has_value() == b.has_value() && (!a || close(*a, *b, tolerance));
}
bool within01deg(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) <= 0.1 * 3.14159265358979323846 / 180;
}
bool sameOrientation(const Record& a, const Record& b) {
  const auto& p = a.instance.plane;
  const auto& q = b.instance.plane;
  if (p.has_value() != q.has_value()) return false;
  return !p || (within01deg(p->rowDirection.v, q->rowDirection.v) &&
                within01deg(p->columnDirection.v, q->columnDirection.v));
}
bool sameSpacing(const Record& a, const Record& b) {
  const glm::dvec2 s = a.instance.pixelSpacing_mm, t = b.instance.pixelSpacing_mm;
  return close(s.x, t.x, 1e-4 * std::max(s.x, t.x)) && close(s.y, t.y, 1e-4 * std::max(s.y, t.y));
}
std::string orientationText(const Record& r) {
  if (!r.instance.plane) return "none";
  const glm::dvec3 n = glm::cross(r.instance.plane->rowDirection.v, r.instance.plane->columnDirection.v);
  const glm::dvec3 a = glm::abs(n);
  return a.z >= a.x && a.z >= a.y ? "axial" : a.y >= a.x ? "coronal" : "sagittal";
}

const std::vector<SplitKey>& splitKeys() {
  static const std::vector<SplitKey> keys = {
      {"patient",
       [](const Record& a, const Record& b) { return a.patientId == b.patientId && a.issuer == b.issuer; },
       [](const Record&) { return std::string("differs"); }},
      textKey("SOP class", [](const Record& r) { return r.instance.sopClassName; }),
      textKey("size",
              [](const Record& r) {
                return std::to_string(r.instance.pixels.columns) + "x" +
                       std::to_string(r.instance.pixels.rows);
              }),
      textKey("samples", [](const Record& r) { return std::to_string(r.instance.pixels.samplesPerPixel); }),
      textKey("photometric", [](const Record& r) { return r.instance.photometric; }),
      textKey("frame of reference", [](const Record& r) { return r.instance.frameOfReferenceUid; }),
      {"pixel spacing", sameSpacing,
       [](const Record& r) {
         return shortNumber(r.instance.pixelSpacing_mm.x) + "\\" + shortNumber(r.instance.pixelSpacing_mm.y) +
                " mm";
       }},
      {"orientation", sameOrientation, orientationText},
      textKey("image type",
              [](const Record& r) {
                const std::string all = typeValue(r, 0) + "\\" + typeValue(r, 2) + "\\" + typeValue(r, 3);
                return all == "\\\\" ? std::string("none") : all;
              }),
      textKey("kernel", [](const Record& r) { return r.kernel; }),
      textKey("kVp", [](const Record& r) { return r.kvp; }),
      {"echo time",
       [](const Record& a, const Record& b) {
         return close(a.instance.echoTime_ms, b.instance.echoTime_ms, 0.1);
       },
       [](const Record& r) {
         return r.instance.echoTime_ms ? shortNumber(*r.instance.echoTime_ms) + " ms" : "none";
       }},
      textKey("echo number", [](const Record& r) { return r.echoNumbers; }),
      {"b-value",
       [](const Record& a, const Record& b) { return close(a.bValue_s_mm2, b.bValue_s_mm2, 1e-6); },
       [](const Record& r) { return r.bValue_s_mm2 ? shortNumber(*r.bValue_s_mm2) : "none"; }},
      {"diffusion direction",
       [](const Record& a, const Record& b) {
         if (a.diffusionDirection.has_value() != b.diffusionDirection.has_value()) return false;
         return !a.diffusionDirection || glm::length(*a.diffusionDirection - *b.diffusionDirection) <= 1e-6;
       },
       [](const Record& r) {
         if (!r.diffusionDirection) return std::string("none");
         const glm::dvec3 d = *r.diffusionDirection;
         return shortNumber(d.x) + "\\" + shortNumber(d.y) + "\\" + shortNumber(d.z);
       }},
      textKey("temporal position",
              [](const Record& r) {
                return r.instance.temporalPosition ? std::to_string(*r.instance.temporalPosition)
                                                   : std::string();
              }),
      textKey("stack id", [](const Record& r) { return r.stackId; }),
      textKey("segment", [](const Record& r) { return r.segmentNumber; }),
      textKey("rescale type", [](const Record& r) { return r.rescaleType; }),
      textKey("units", [](const Record& r) { return r.units; }),
  };
  return keys;
}

// Used only when positions coincide without them.
const std::vector<SplitKey>& tieKeys() {
  static const std::vector<SplitKey> keys = {
      textKey("acquisition number", [](const Record& r) { return r.acquisitionNumber; }),
      textKey("contrast agent", [](const Record& r) { return r.contrastAgent; }),
      textKey("trigger time", [](const Record& r) { return r.triggerTime; }),
      textKey("cardiac phase", [](const Record& r) { return r.cardiacPhase; }),
      textKey("acquisition time", [](const Record& r) { return r.acquisitionTime; }),
      textKey("content time", [](const Record& r) { return r.contentTime; }),
  };
  return keys;
}

using Group = std::vector<std::size_t>;

// Each record joins the first group whose first member it equals; `members` are in a fixed order, so the
// result is too.
std::vector<Group> split(const std::vector<Record>& records, const Group& members,
                         const std::function<bool(const Record&, const Record&)>& equal) {
  std::vector<Group> groups;
  for (const std::size_t m : members) {
    const auto g = std::find_if(groups.begin(), groups.end(),
                                [&](const Group& x) { return equal(records[x[0]], records[m]); });
    if (g != groups.end())
      g->push_back(m);
    else
      groups.push_back({m});
  }
  return groups;
}

std::vector<SlicePlane> planesOf(const std::vector<Record>& records, const Group& g) {
  std::vector<SlicePlane> planes;
  for (std::size_t i = 0; i < g.size(); ++i)
    planes.push_back({*records[g[i]].instance.plane, static_cast<std::int64_t>(i)});
  return planes;
}

bool positionsCoincide(const std::vector<Record>& records, const Group& g) {
  if (!records[g[0]].instance.plane) return false;
  const auto planes = planesOf(records, g);
  const auto order = orderAlongNormal(planes);
  const PatientVec n = cross(planes[0].plane.rowDirection, planes[0].plane.columnDirection);
  for (std::size_t k = 1; k < order.size(); ++k)
    if (dot(planes[order[k]].plane.origin - planes[order[k - 1]].plane.origin, n) <= kCoincident_mm)
      return true;
  return false;
}

// The first tie attribute that makes every position unique; nothing when there is none.
std::optional<std::pair<std::vector<Group>, const SplitKey*>> tellApart(const std::vector<Record>& records,
                                                                        const Group& g) {
  for (const SplitKey& key : tieKeys()) {
    auto parts = split(records, g, key.equal);
    if (parts.size() < 2) continue;
    if (std::none_of(parts.begin(), parts.end(),
                     [&](const Group& p) { return positionsCoincide(records, p); }))
      return std::pair(std::move(parts), &key);
  }
  return std::nullopt;
}

Stack stackOf(const std::vector<Record>& records, const Group& g) {
  Stack stack;
  const Record& first = records[g[0]];
  // A multi-frame object of these classes has its frames in file order and no place per frame.
  const bool multiFrame = std::any_of(
      g.begin(), g.end(), [&](std::size_t m) { return records[m].instance.pixels.framesDeclared > 1; });
  if (!first.instance.plane || multiFrame) {
    for (const std::size_t m : g)
      for (std::uint64_t f = 0; f < records[m].instance.pixels.framesDeclared; ++f)
        stack.slices.push_back({m, f});
    const bool crooked = first.rawPlane && !first.instance.plane && !multiFrame;
    if (crooked)
      stack.findings.push_back(
          {"orientation-unusable",
           Severity::Refusal,
           "Row and column direction are not two perpendicular unit vectors; 3-D is refused.",
           {{"off_orthonormal", first.rawPlane->offOrthonormal}}});
    stack.why2d = crooked ? stack.findings.back().sentence
                  : multiFrame
                      ? "The frames of this object have no positions of their own; they can be browsed only."
                      : "The images carry no usable position and orientation; they can be browsed only.";
    return stack;
  }
  const auto planes = planesOf(records, g);
  std::vector<FramePlane> ordered;
  double off = 0;
  for (const std::size_t k : orderAlongNormal(planes)) {
    stack.slices.push_back({g[k], 0});
    ordered.push_back(planes[k].plane);
    if (records[g[k]].rawPlane) off = std::max(off, records[g[k]].rawPlane->offOrthonormal);
  }
  const Instance& i = first.instance;
  fitGeometry(ordered, static_cast<std::int64_t>(i.pixels.rows), static_cast<std::int64_t>(i.pixels.columns),
              i.pixelSpacing_mm, stack);
  if (off > kOrthonormalSilent + 1e-9) {
    stack.orientationFixed = true;
    stack.findings.push_back({"orientation-fixed",
                              Severity::Notice,
                              "Row and column direction are " + shortNumber(off) +
                                  " off orthonormal and were made so; measurements are marked.",
                              {{"off_orthonormal", off}}});
  }
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

std::string labelOf(const std::vector<Record>& records, const Group& g,
                    const std::vector<const SplitKey*>& differing) {
  std::string label;
  for (const SplitKey* key : differing)
    label +=
        (label.empty() ? "" : ", ") + std::string(key->name) + " " + shortened(key->value(records[g[0]]));
  return label;
}

}  // namespace

bool sameGeometry(const Record& a, const Record& b) {
  if (a.rawPlane.has_value() != b.rawPlane.has_value()) return false;
  const bool samePlace =
      !a.rawPlane || (glm::length(a.rawPlane->position - b.rawPlane->position) <= kCoincident_mm &&
                      glm::length(a.rawPlane->row - b.rawPlane->row) <= 1e-6 &&
                      glm::length(a.rawPlane->column - b.rawPlane->column) <= 1e-6);
  return samePlace && sameSpacing(a, b);
}

SplitResult makeStacks(const std::vector<Record>& records, std::vector<std::size_t> members) {
  SplitResult out;
  if (members.empty()) return out;
  std::stable_sort(members.begin(), members.end(), [&](std::size_t a, std::size_t b) {
    const Instance &x = records[a].instance, &y = records[b].instance;
    const std::int64_t i = x.instanceNumber.value_or(0), j = y.instanceNumber.value_or(0);
    return i != j ? i < j : x.sopInstanceUid < y.sopInstanceUid;
  });
  std::vector<Group> groups = split(records, members, [](const Record& a, const Record& b) {
    return std::all_of(splitKeys().begin(), splitKeys().end(),
                       [&](const SplitKey& k) { return k.equal(a, b); });
  });
  std::vector<const SplitKey*> differing;
  for (const SplitKey& key : splitKeys())
    if (split(
            records,
            [&] {
              Group firsts;
              for (const Group& g : groups) firsts.push_back(g[0]);
              return firsts;
            }(),
            key.equal)
            .size() > 1)
      differing.push_back(&key);

  std::set<const SplitKey*> tied;
  std::vector<Group> final;
  for (Group& g : groups) {
    if (positionsCoincide(records, g)) {
      if (auto parts = tellApart(records, g)) {
        tied.insert(parts->second);
        for (Group& p : parts->first) final.push_back(std::move(p));
        continue;
      }
    }
    final.push_back(std::move(g));
  }
  for (const SplitKey& key : tieKeys())
    if (tied.contains(&key)) differing.push_back(&key);

  for (const Group& g : final) {
    out.stacks.push_back(stackOf(records, g));
    if (final.size() > 1) out.stacks.back().label = labelOf(records, g, differing);
    if (records[g[0]].quadruped)
      out.stacks.back().findings.push_back(
          {"quadruped",
           Severity::Warning,
           "The patient is four-legged (Anatomical Orientation Type): the letters L R A P H F do not "
           "apply and are not shown.",
           {}});
  }
  numberEqualLabels(out.stacks);
  std::stable_sort(out.stacks.begin(), out.stacks.end(),
                   [](const Stack& a, const Stack& b) { return a.slices.size() > b.slices.size(); });
  if (final.size() > 1) {
    std::vector<std::string> names;
    std::string text;
    for (const SplitKey* k : differing) {
      names.push_back(k->name);
      text += (text.empty() ? "" : ", ") + std::string(k->name);
    }
    out.findings.push_back(
        {"split-into-stacks",
         Severity::Info,
         "The series is split by " + text + " into " + std::to_string(final.size()) + " stacks.",
         {{"by", names}, {"stacks", static_cast<double>(final.size())}}});
  }
  return out;
}

}  // namespace vernier
