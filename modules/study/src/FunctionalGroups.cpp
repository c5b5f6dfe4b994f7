// SPDX-License-Identifier: GPL-3.0-or-later
#include "FunctionalGroups.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "FrameReading.h"

namespace vernier {
namespace {

constexpr Tag kShared = 0x52009229, kPerFrame = 0x52009230;
constexpr std::size_t kMaxWindows = 8;  // of one frame
constexpr std::size_t kMaxDimensions = 16;
constexpr Tag kFrameTypes[] = {0x00189226, 0x00189329, 0x00189751, 0x00189504,
                               0x00409092, 0x00189806, 0x00520025, 0x00400710};

// One frame while it is put together: macros of the shared groups first, those of the frame over them.
struct FrameState {
  FrameAttributes a;
  FrameKeys k;
  Position position;
  Orientation orientation;
  bool spacingBad = false;
  bool hasValues = false;                          // a pixel value transformation was there
  std::pair<std::string, std::string> windowText;  // center and width as in the file
};

class GroupReader {
 public:
  GroupReader(Record& record, bool signedPixels) : record_(record), signed_(signedPixels) {}

  void apply(const AttributeReader& groups, FrameState& s) {
    applyPlace(groups, s);
    applyValues(groups, s);
    applyContent(groups, s);
    applyContrast(groups, s);
    applySource(groups);
  }

 private:
  void applyPlace(const AttributeReader& g, FrameState& s) {
    if (const auto m = g.item(0x00209113)) s.position = positionOf(m->decimals(0x00200032));
    if (const auto m = g.item(0x00209116)) s.orientation = orientationOf(m->decimals(0x00200037));
    // Enhanced ultrasound volumes stand in the transducer's frame of reference.
    if (const auto m = g.item(0x0020930E))
      s.position = positionOf(m->doubles(0x00209301)), record_.volumeFrame = true;
    if (const auto m = g.item(0x0020930F)) s.orientation = orientationOf(m->doubles(0x00209302));
    if (const auto m = g.item(0x00289110)) {
      s.spacingBad = !readSpacing(*m, s.a);
      if (s.spacingBad) s.a.pixelSpacing_mm = {0, 0};
      s.a.sliceThickness_mm = m->decimal(0x00180050).value_or(0);
    }
  }

  void applyValues(const AttributeReader& g, FrameState& s) {
    if (const auto m = g.item(0x00289145)) {
      readRescale(*m, s.a, s.k);
      s.hasValues = true;
    }
    if (auto m = g.item(0x00289132)) {
      WindowList windows = readWindows(*m);
      if (record_.badWindowCenters.empty()) {
        record_.badWindowCenters = std::move(windows.badCenters);
        record_.badWindowWidths = std::move(windows.badWidths);
      }
      windows.valid.resize(std::min(windows.valid.size(), kMaxWindows));
      for (VoiWindow& w : windows.valid)
        w.explanation.resize(std::min<std::size_t>(w.explanation.size(), 64));
      s.a.windows = std::move(windows.valid);
      s.windowText = {std::string(m->raw(0x00281050)), std::string(m->raw(0x00281051))};
    }
    if (auto real = readRealWorld(g, signed_)) s.a.realWorld = std::move(real);
  }

  void applyContent(const AttributeReader& g, FrameState& s) {
    if (const auto m = g.item(0x00209111)) {
      s.k.stackId = shortCode(*m, 0x00209056);
      s.k.acquisitionNumber = firstWord(*m, 0x00209156);
      s.k.acquisitionTime = shortCode(*m, 0x00189074);
      s.k.contentTime = shortCode(*m, 0x00189151);
      s.k.cardiacPhase = shortCode(*m, 0x00189236);
      if (const auto t = m->longs(0x00209128); !t.empty()) s.a.temporalPosition = t[0];
      s.a.dimensionIndex = m->longs(0x00209157);
      s.a.dimensionIndex.resize(std::min(s.a.dimensionIndex.size(), kMaxDimensions));
    }
    for (const Tag t : kFrameTypes)
      if (const auto m = g.item(t)) {
        if (m->has(0x00089007)) s.a.imageType = limited(m->codes(0x00089007));
        s.k.complexComponent = shortCode(*m, 0x00089208);
      }
    if (const auto m = g.item(0x0062000A)) {
      s.a.segments = m->words(0x0062000B);
      s.a.segments.resize(std::min<std::size_t>(s.a.segments.size(), 1));  // a frame shows one segment
      s.k.segmentNumber = s.a.segments.empty() ? std::string() : std::to_string(s.a.segments[0]);
    }
    if (auto m = g.item(0x00089124)) s.k.derivation = shortText(*m, 0x00082111);
    if (const auto m = g.item(0x00209310))
      if (const auto t = m->doubles(0x0020930D); !t.empty() && std::isfinite(t[0]))
        s.k.triggerTime = std::to_string(t[0]);
  }

  void applyContrast(const AttributeReader& g, FrameState& s) {
    // What Legacy Converted objects could not assign to a macro stands as it did in the classic object.
    for (const Tag t : {Tag{0x00209170}, Tag{0x00209171}})
      if (auto m = g.item(t)) keepFilled(*m, s);
    if (const auto m = g.item(0x00189114))
      if (const auto te = m->doubles(0x00189082); !te.empty() && std::isfinite(te[0]))
        s.a.echoTime_ms = te[0];
    if (const auto m = g.item(0x00189117)) {
      if (const auto b = m->doubles(0x00189087); !b.empty()) s.k.bValue_s_mm2 = b[0];
      s.k.diffusionDirection.reset();
      if (const auto direction = m->item(0x00189076))
        if (const auto d = direction->doubles(0x00189089); d.size() == 3)
          s.k.diffusionDirection = glm::dvec3(d[0], d[1], d[2]);
    }
    if (const auto m = g.item(0x00189314)) s.k.kernel = shortCode(*m, 0x00181210);
    if (const auto m = g.item(0x00189325)) s.k.kvp = shortCode(*m, 0x00180060);
    if (const auto m = g.item(0x00189118)) {
      if (const auto t = m->doubles(0x00209153); !t.empty() && std::isfinite(t[0]))
        s.k.triggerTime = std::to_string(t[0]);
      if (const auto p = m->doubles(0x00209241); !p.empty() && std::isfinite(p[0]))
        s.k.cardiacPhase = std::to_string(p[0]);
    }
  }

  void applySource(const AttributeReader& g) {
    for (const AttributeReader& source : g.items(0x00209172))
      if (std::string uid = shortCode(source, 0x00081155); !uid.empty())
        record_.convertedFrom.push_back(std::move(uid));
  }

  static void keepFilled(AttributeReader& m, FrameState& s) {
    FrameAttributes a;
    FrameKeys k;
    readClassicKeys(m, a, k);
    const auto take = [](std::string& to, std::string& from) {
      if (!from.empty()) to = std::move(from);
    };
    take(s.k.kernel, k.kernel);
    take(s.k.kvp, k.kvp);
    take(s.k.echoNumbers, k.echoNumbers);
    take(s.k.units, k.units);
    take(s.k.acquisitionNumber, k.acquisitionNumber);
    take(s.k.contrastAgent, k.contrastAgent);
    take(s.k.triggerTime, k.triggerTime);
    take(s.k.cardiacPhase, k.cardiacPhase);
    take(s.k.acquisitionTime, k.acquisitionTime);
    take(s.k.contentTime, k.contentTime);
    if (a.echoTime_ms) s.a.echoTime_ms = a.echoTime_ms;
    if (a.temporalPosition) s.a.temporalPosition = a.temporalPosition;
    if (k.bValue_s_mm2) s.k.bValue_s_mm2 = k.bValue_s_mm2;
    if (k.diffusionDirection) s.k.diffusionDirection = k.diffusionDirection;
  }

  static std::string firstWord(const AttributeReader& m, Tag t) {
    const auto v = m.words(t);
    return v.empty() ? std::string() : std::to_string(v[0]);
  }
  static std::vector<std::string> limited(std::vector<std::string> values) {
    values.resize(std::min<std::size_t>(values.size(), 4));
    for (std::string& v : values) v.resize(std::min<std::size_t>(v.size(), 16));
    return values;
  }

  Record& record_;
  bool signed_;
};

void readDimensions(AttributeReader& root, Record& record) {
  for (AttributeReader& item : root.items(0x00209222)) {
    if (record.dimensions.size() == kMaxDimensions) break;
    const auto pointer = item.longs(0x00209165);
    record.dimensions.push_back({pointer.empty() ? 0 : pointer[0], shortText(item, 0x00209421)});
  }
}

Finding countFinding(std::size_t groups, std::uint64_t frames) {
  return {"functional-groups-count",
          Severity::Refusal,
          "The object describes " + std::to_string(groups) + " frames one by one, but has " +
              std::to_string(frames) +
              ": which description belongs to which frame is unknown. The frames have no positions, 3-D is "
              "refused, "
              "and values that differ from frame to frame are shown as stored.",
          {{"groups", static_cast<double>(groups)}, {"frames", static_cast<double>(frames)}}};
}

void finish(const Instance& i, FrameState& s) {
  setPlane(s.position, s.orientation, s.a, s.k);
  s.a.paddingFirst = i.paddingFirst;
  s.a.paddingLast = i.paddingLast;
  s.a.unit = unitOf(i, s.a, s.k, std::nullopt);
  if (i.segmentation == SegmentationKind::None) return;
  if (i.segmentation == SegmentationKind::Fractional) s.a.unit = "fraction";
  s.a.windows = {{0.5, 1, VoiFunction::LinearExact, "segment"}};
}

bool finite(const RawPlane& p) {
  const auto all = [](const glm::dvec3& v) { return std::isfinite(v.x + v.y + v.z); };
  return all(p.position) && all(p.row) && all(p.column);
}

void reportFrames(const std::vector<FrameState>& frames, Record& record) {
  std::size_t misplaced = 0;
  for (const FrameState& s : frames) {
    const bool unusable = !s.k.rawPlane || !finite(*s.k.rawPlane);
    misplaced += (s.position || s.orientation) && unusable;
    record.pixelSpacingBad |= s.spacingBad;
  }
  if (misplaced == 0) return;
  record.findings.push_back(
      {"frames-without-place",
       Severity::Warning,
       std::to_string(misplaced) + " of " + std::to_string(frames.size()) +
           " frames have a position or orientation that is incomplete or no number; they can be "
           "browsed, not placed.",
       {{"frames", static_cast<double>(misplaced)}}});
}

std::size_t differentWindows(const std::vector<FrameState>& frames) {
  std::set<std::pair<std::string, std::string>> seen;
  for (const FrameState& s : frames)
    if (!s.windowText.first.empty() || !s.windowText.second.empty()) seen.insert(s.windowText);
  return seen.size();
}

// Without a group for each frame: what is shared holds for all, and no frame has a place of its own.
void dropPerFrame(const std::vector<AttributeReader>& perFrame, GroupReader& reader, Record& record,
                  FrameState& shared) {
  const std::uint64_t frames = record.instance.framesDeclared;
  if (!perFrame.empty()) {
    record.findings.push_back(countFinding(perFrame.size(), frames));
    FrameState any;
    for (const AttributeReader& groups : perFrame) reader.apply(groups, any);
    if (any.hasValues) setRescale(0, 0, shared.a);  // refused: which frame has which is unknown
  } else {
    record.findings.push_back(
        {"functional-groups-missing",
         Severity::Notice,
         "The object does not describe its frames one by one; they have no positions and can "
         "be browsed only.",
         {}});
  }
  if (frames > 1 || !perFrame.empty()) shared.position.reset();
}

}  // namespace

bool hasFunctionalGroups(const Header& h) { return h.find(kShared) || h.find(kPerFrame); }

void readFunctionalGroups(AttributeReader& root, Record& record) {
  Instance& i = record.instance;
  const auto sign = root.words(0x00280103);
  GroupReader reader(record, !sign.empty() && sign[0] == 1);
  readDimensions(root, record);

  FrameState shared;
  shared.a.imageType = i.imageType;
  shared.a.rescale = i.rescale;  // of a fractional segmentation; else the identity
  if (const auto groups = root.item(kShared)) reader.apply(*groups, shared);
  const auto perFrame = root.items(kPerFrame);
  const bool complete = perFrame.size() == i.framesDeclared;
  if (!complete) dropPerFrame(perFrame, reader, record, shared);
  std::vector<FrameState> frames(complete ? perFrame.size() : 1, shared);
  if (complete)
    for (std::size_t f = 0; f < frames.size(); ++f) reader.apply(perFrame[f], frames[f]);
  for (FrameState& s : frames) finish(i, s);
  if (complete) reportFrames(frames, record);
  record.frameWindows = differentWindows(frames);
  static_cast<FrameAttributes&>(i) = frames.front().a;
  static_cast<FrameKeys&>(record) = frames.front().k;
  if (!complete) return;
  std::vector<FrameAttributes> attributes;
  for (FrameState& s : frames) {
    attributes.push_back(std::move(s.a));
    record.frameKeys.push_back(std::move(s.k));
  }
  i.frames = std::make_shared<const std::vector<FrameAttributes>>(std::move(attributes));
}

}  // namespace vernier
