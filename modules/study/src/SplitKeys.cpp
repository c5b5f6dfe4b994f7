// SPDX-License-Identifier: GPL-3.0-or-later
#include "SplitKeys.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

namespace vernier {
namespace {

constexpr std::uint32_t kInStackPosition = 0x00209057, kImagePosition = 0x00200032;

std::string shortNumber(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", v);
  return text;
}
std::string typeValue(const FrameView& v, std::size_t n) {
  return v.frame->imageType.size() > n ? v.frame->imageType[n] : std::string();
}

SplitKey textKey(const char* name, std::function<std::string(const FrameView&)> value) {
  return {name, std::move(value), {}};
}
SplitKey textKey(const char* name, std::string FrameKeys::*member) {
  return {name, [member](const FrameView& v) { return v.keys->*member; }, {}};
}

bool close(double a, double b, double tolerance) { return std::abs(a - b) <= tolerance; }
bool close(const std::optional<double>& a, const std::optional<double>& b, double tolerance) {
  return a.has_value() == b.has_value() && (!a || close(*a, *b, tolerance));
}
bool within01deg(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) <= 0.1 * 3.14159265358979323846 / 180;
}
bool sameOrientation(const FrameView& a, const FrameView& b) {
  const auto &p = a.frame->plane, &q = b.frame->plane;
  if (p.has_value() != q.has_value()) return false;
  return !p || (within01deg(p->rowDirection.v, q->rowDirection.v) &&
                within01deg(p->columnDirection.v, q->columnDirection.v));
}
std::string orientationText(const FrameView& v) {
  if (!v.frame->plane) return "none";
  const glm::dvec3 n = glm::cross(v.frame->plane->rowDirection.v, v.frame->plane->columnDirection.v);
  const glm::dvec3 a = glm::abs(n);
  return a.z >= a.x && a.z >= a.y ? "axial" : a.y >= a.x ? "coronal" : "sagittal";
}
bool sameDirection(const FrameView& a, const FrameView& b) {
  const auto &p = a.keys->diffusionDirection, &q = b.keys->diffusionDirection;
  return p.has_value() == q.has_value() && (!p || glm::length(*p - *q) <= 1e-6);
}
std::string directionText(const FrameView& v) {
  if (!v.keys->diffusionDirection) return "none";
  const glm::dvec3 d = *v.keys->diffusionDirection;
  return shortNumber(d.x) + "\\" + shortNumber(d.y) + "\\" + shortNumber(d.z);
}

// Segments are named where the object names them.
std::string segmentText(const FrameView& v) {
  std::string text = v.keys->segmentNumber;
  for (const Segment& s : v.record->instance.segments)
    if (std::to_string(s.number) == text && !s.label.empty()) return text + " (" + s.label + ")";
  return text;
}

std::vector<SplitKey> makeSplitKeys() {
  return {
      {"patient", [](const FrameView&) { return std::string("differs"); },
       [](const FrameView& a, const FrameView& b) {
         return a.record->patientId == b.record->patientId && a.record->issuer == b.record->issuer &&
                a.record->instance.patient == b.record->instance.patient;
       }},
      textKey("SOP class", [](const FrameView& v) { return v.record->instance.sopClassName; }),
      textKey("size",
              [](const FrameView& v) {
                return std::to_string(v.record->instance.pixels.columns) + "x" +
                       std::to_string(v.record->instance.pixels.rows);
              }),
      textKey("samples",
              [](const FrameView& v) { return std::to_string(v.record->instance.pixels.samplesPerPixel); }),
      textKey("photometric", [](const FrameView& v) { return v.record->instance.photometric; }),
      textKey("frame of reference",
              [](const FrameView& v) { return v.record->instance.frameOfReferenceUid; }),
      {"pixel spacing",
       [](const FrameView& v) {
         return shortNumber(v.frame->pixelSpacing_mm.x) + "\\" + shortNumber(v.frame->pixelSpacing_mm.y) +
                " mm";
       },
       [](const FrameView& a, const FrameView& b) { return sameSpacing(*a.frame, *b.frame); }},
      {"orientation", orientationText, sameOrientation},
      textKey("image type",
              [](const FrameView& v) {
                const std::string all = typeValue(v, 0) + "\\" + typeValue(v, 2) + "\\" + typeValue(v, 3);
                return all == "\\\\" ? std::string("none") : all;
              }),
      textKey("component", &FrameKeys::complexComponent),
      textKey("kernel", &FrameKeys::kernel),
      textKey("kVp", &FrameKeys::kvp),
      {"echo time",
       [](const FrameView& v) {
         return v.frame->echoTime_ms ? shortNumber(*v.frame->echoTime_ms) + " ms" : "none";
       },
       [](const FrameView& a, const FrameView& b) {
         return close(a.frame->echoTime_ms, b.frame->echoTime_ms, 0.1);
       }},
      textKey("echo number", &FrameKeys::echoNumbers),
      {"b-value",
       [](const FrameView& v) { return v.keys->bValue_s_mm2 ? shortNumber(*v.keys->bValue_s_mm2) : "none"; },
       [](const FrameView& a, const FrameView& b) {
         return close(a.keys->bValue_s_mm2, b.keys->bValue_s_mm2, 1e-6);
       }},
      {"diffusion direction", directionText, sameDirection},
      textKey("temporal position",
              [](const FrameView& v) {
                return v.frame->temporalPosition ? std::to_string(*v.frame->temporalPosition) : std::string();
              }),
      textKey("stack id", &FrameKeys::stackId),
      {"segment", segmentText,
       [](const FrameView& a, const FrameView& b) { return a.keys->segmentNumber == b.keys->segmentNumber; }},
      textKey("grid vectors", &FrameKeys::gridVectors),
      textKey("rescale type", &FrameKeys::rescaleType),
      textKey("units", &FrameKeys::units),
  };
}

// Which object a frame is of; parts of one concatenation are one.
std::string objectOf(const FrameView& v) {
  const Instance& i = v.record->instance;
  return i.concatenation ? i.concatenation->uid : i.sopInstanceUid;
}

}  // namespace

FrameView viewOf(const std::vector<Record>& records, const FrameGroup& g) {
  const Record& r = records[g.record];
  return {&r, &r.instance.frame(g.first), &r.keys(g.first)};
}

bool sameSpacing(const FrameAttributes& a, const FrameAttributes& b) {
  const glm::dvec2 s = a.pixelSpacing_mm, t = b.pixelSpacing_mm;
  return close(s.x, t.x, 1e-4 * std::max(s.x, t.x)) && close(s.y, t.y, 1e-4 * std::max(s.y, t.y));
}

bool isLocalizer(const FrameView& v) { return typeValue(v, 2) == "LOCALIZER"; }

const std::vector<SplitKey>& splitKeys() {
  static const std::vector<SplitKey> keys = makeSplitKeys();
  return keys;
}

std::vector<SplitKey> tieKeys(const std::vector<Record>& records, const std::vector<FrameGroup>& members) {
  std::vector<SplitKey> keys = {textKey("acquisition number", &FrameKeys::acquisitionNumber),
                                textKey("contrast agent", &FrameKeys::contrastAgent),
                                textKey("trigger time", &FrameKeys::triggerTime),
                                textKey("cardiac phase", &FrameKeys::cardiacPhase),
                                textKey("derivation", &FrameKeys::derivation),
                                textKey("acquisition time", &FrameKeys::acquisitionTime),
                                textKey("content time", &FrameKeys::contentTime)};
  const bool described = std::any_of(members.begin(), members.end(), [&](const FrameGroup& g) {
    return records[g.record].instance.frames != nullptr;
  });
  if (!described) return keys;
  const auto& dimensions = records[members.front().record].dimensions;
  const auto isPlace = [](const Dimension& d) {
    return d.pointer == kInStackPosition || d.pointer == kImagePosition;
  };
  const auto indexText = [](const FrameView& v, std::size_t d) {
    return d < v.frame->dimensionIndex.size() ? std::to_string(v.frame->dimensionIndex[d]) : std::string();
  };
  std::vector<std::size_t> others;
  for (std::size_t d = 0; d < dimensions.size(); ++d) {
    if (isPlace(dimensions[d])) continue;
    others.push_back(d);
    keys.push_back({dimensions[d].label.empty() ? "dimension " + std::to_string(d + 1) : dimensions[d].label,
                    [=](const FrameView& v) { return indexText(v, d); },
                    {}});
  }
  if (others.size() > 1)
    keys.push_back({"dimensions",
                    [=](const FrameView& v) {
                      std::string text;
                      for (const std::size_t d : others) text += (text.empty() ? "" : "-") + indexText(v, d);
                      return text;
                    },
                    {}});
  std::map<std::string, std::size_t> objects;
  for (const FrameGroup& g : members) objects.try_emplace(objectOf(viewOf(records, g)), objects.size() + 1);
  keys.push_back({"object",
                  [objects](const FrameView& v) {
                    const auto at = objects.find(objectOf(v));
                    return at == objects.end() ? std::string() : std::to_string(at->second);
                  },
                  {}});
  return keys;
}

}  // namespace vernier
