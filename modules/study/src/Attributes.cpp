// SPDX-License-Identifier: GPL-3.0-or-later
#include "Attributes.h"

#include <algorithm>

#include "AttributeReader.h"
#include "FrameReading.h"
#include "FunctionalGroups.h"
#include "GridVectors.h"
#include "Luts.h"
#include "PixelModule.h"
#include "References.h"
#include "Segments.h"
#include "SopClasses.h"
#include "vernier/base/Checked.h"

namespace vernier {
namespace {

constexpr std::string_view kRealWorldMappingClass = "1.2.840.10008.5.1.4.1.1.67";

struct Keyword {
  Tag tag;
  const char* word;
};
constexpr Keyword kNames[] = {{0x00080090, "ReferringPhysicianName"},
                              {0x0008009C, "ConsultingPhysicianName"},
                              {0x00081048, "PhysiciansOfRecord"},
                              {0x00081050, "PerformingPhysicianName"},
                              {0x00081060, "NameOfPhysiciansReadingStudy"},
                              {0x00081070, "OperatorsName"},
                              {0x00100010, "PatientName"},
                              {0x00101001, "OtherPatientNames"},
                              {0x00101005, "PatientBirthName"},
                              {0x00101060, "PatientMotherBirthName"},
                              {0x00102297, "ResponsiblePerson"},
                              {0x00321032, "RequestingPhysician"},
                              {0x0040A075, "VerifyingObserverName"},
                              {0x0040A123, "PersonName"},
                              {0x00700084, "ContentCreatorName"},
                              {0x300E0008, "ReviewerName"}};
constexpr Keyword kSequences[] = {{0x00321064, "RequestedProcedureCodeSequence"},
                                  {0x00400275, "RequestAttributesSequence"},
                                  {0x00081111, "ReferencedPerformedProcedureStepSequence"},
                                  {0x0040A073, "VerifyingObserverSequence"}};
const char* wordOf(std::span<const Keyword> list, Tag t) {
  for (const Keyword& k : list)
    if (k.tag == t) return k.word;
  return nullptr;
}

bool looksLikeSequence(const Header& h, const Element& e) {
  if (e.is("SQ") || (e.undefinedLength && e.length > 0)) return true;
  if (e.vr[0] != ' ' && !e.is("UN")) return false;
  return e.length >= 8 && word(h, e, 0) == 0xFFFE && word(h, e, 1) == 0xE000;
}

// The names of the object itself and of its sequences' items, one level down, each in its own character set.
void readNames(AttributeReader& r, std::vector<NamedText>& out) {
  const Header& h = r.header();
  for (const Element& e : h.elements) {
    if (const char* w = wordOf(kNames, e.tag); w && e.length > 0)
      out.push_back({w, r.decoded(rawText(h, e), r.charset(), true)});
    if (e.tag >> 16 == 0x5200 || !looksLikeSequence(h, e)) continue;  // functional groups hold no names
    const auto items = itemsOf(h, e);
    for (std::size_t i = 0; i < items.size(); ++i) {
      auto charset = r.charsetOf(items[i]);
      if (charset.empty()) charset = r.charset();
      for (const Element& inner : items[i])
        if (const char* w = wordOf(kNames, inner.tag); w && inner.length > 0) {
          const char* outer = wordOf(kSequences, e.tag);
          out.push_back({(outer ? outer : tagText(e.tag)) + ("[" + std::to_string(i) + "].") + w,
                         r.decoded(rawText(h, inner), charset, true)});
        }
    }
  }
}

// Image Plane, rescale and windows of the root: they hold for all frames of an object without functional
// groups.
void readRootFrame(AttributeReader& r, Record& out) {
  Instance& i = out.instance;
  i.sliceThickness_mm = r.decimal(0x00180050).value_or(0);
  setPlane(positionOf(r.decimals(0x00200032)), orientationOf(r.decimals(0x00200037)), i, out);
  out.pixelSpacingBad = !readSpacing(r, i);
  readRescale(r, i, out);
  WindowList windows = readWindows(r);
  out.windowCenters = std::move(windows.centers);
  out.windowWidths = std::move(windows.widths);
  out.badWindowCenters = std::move(windows.badCenters);
  out.badWindowWidths = std::move(windows.badWidths);
  i.windows = std::move(windows.valid);
  readClassicKeys(r, i, out);
  out.stackId = shortCode(r, 0x00209056);
  const auto segment = r.words(0x0062000B);
  if (!segment.empty()) out.segmentNumber = std::to_string(segment[0]);
}

void readPadding(const AttributeReader& r, Instance& i) {
  const auto sign = r.words(0x00280103);
  const bool isSigned = !sign.empty() && sign[0] == 1;
  const auto stored = [&](Tag t) -> std::optional<double> {
    const auto v = r.words(t);
    if (v.empty()) return std::nullopt;
    return isSigned ? static_cast<double>(static_cast<std::int16_t>(v[0])) : static_cast<double>(v[0]);
  };
  const auto a = stored(0x00280120);
  if (!a) return;
  const double b = stored(0x00280121).value_or(*a);
  i.paddingFirst = std::min(*a, b);
  i.paddingLast = std::max(*a, b);
}

// LUTs, the real world and the unit.
void readRootValues(AttributeReader& r, Record& out) {
  Instance& i = out.instance;
  const auto sign = r.words(0x00280103);
  const bool isSigned = !sign.empty() && sign[0] == 1;
  std::optional<std::string> lutType;
  for (AttributeReader& item : r.items(0x00283000))
    if (auto lut = readLut(item, isSigned); lut && !i.modalityLut) {
      i.modalityLut = std::move(lut);
      lutType = shortCode(item, 0x00283004);
    }
  for (AttributeReader& item : r.items(0x00283010))
    if (auto lut = readLut(item, isSigned || i.rescale.intercept < 0)) i.voiLuts.push_back(std::move(*lut));
  i.realWorld = readRealWorld(r, isSigned);
  i.unit = unitOf(i, i, out, lutType);
}

void readConcatenation(const AttributeReader& r, Instance& i) {
  const std::string uid = r.code(0x00209161);
  if (uid.empty()) return;
  const auto first = [](const auto& v) {
    return v.empty() ? std::int64_t{0} : static_cast<std::int64_t>(v[0]);
  };
  i.concatenation = Concatenation{uid, first(r.words(0x00209162)), first(r.words(0x00209163)),
                                  static_cast<std::uint64_t>(first(r.longs(0x00209228)))};
}

// What the frames of an image are and where they lie: functional groups where the class or the object has
// them.
void readFrames(AttributeReader& r, const SopClass* c, Record& out) {
  Instance& i = out.instance;
  if (!i.isImage && !out.imageClass) return;
  const bool segmentation = c && c->kind == ObjectKind::Segmentation;
  readPadding(r, i);
  if (segmentation || (c && c->kind == ObjectKind::EnhancedImage) || hasFunctionalGroups(r.header())) {
    if (segmentation) readSegments(r, out);
    readFunctionalGroups(r, out);
    if (out.volumeFrame) i.frameOfReferenceUid = r.code(0x00209312);
    readConcatenation(r, i);
    return;
  }
  readRootFrame(r, out);
  readRootValues(r, out);
  if (!i.isImage || i.pixelError) return;  // the number of frames is not to be trusted
  if (c && c->kind == ObjectKind::Dose) return readDose(r, out);
  if (i.modality == "NM") readNuclear(r, out);
  readFrameTimes(r, out);
}

void readPixels(const Header& h, Record& out) {
  Instance& i = out.instance;
  auto spec = frameSpecOf(h);
  if (!spec) {
    i.pixelError = spec.error();
    return;
  }
  i.pixels = std::move(*spec);
  const FrameSpec& p = i.pixels;
  if (p.colourSpace() == ColourSpace::Palette) {
    auto palette = paletteFrom(h, p.isSigned);
    if (!palette) {
      i.pixelError = palette.error();
      return;
    }
    i.palette = std::move(palette->palette);
    i.pixels.corrected += palette->corrected;
  }
  if (h.pixels->encapsulated) {
    if (auto r = p.checkFileCanHold(h.pixels->bytesThere); !r) i.pixelError = r.error();
    return;
  }
  const auto bits = checkedProduct({p.rows, p.columns, p.samplesPerPixel, p.bitsAllocated, p.framesDeclared});
  // YBR_FULL_422 stores two chroma samples for two pixels.
  const std::uint64_t used = !bits ? 0 : p.photometric == "YBR_FULL_422" ? *bits / 3 * 2 : *bits;
  const std::uint64_t need = used / 8 + (used % 8 != 0);
  if (!bits || h.pixels->bytesThere < need)
    i.pixelError = makeError(ErrorCode::PixelDataShort,
                             "The pixel data has " + std::to_string(h.pixels->bytesThere) + " bytes, but " +
                                 (bits ? std::to_string(need) : "more than can be counted") +
                                 " are needed for its rows, columns and frames; fetch the file again.",
                             "Pixel Data (7FE0,0010)");
}

// Why an object is listed but not drawn.
std::string whyNotShown(const Record& rec) {
  const Instance& i = rec.instance;
  const SopClass* c = findSopClass(i.sopClassUid);
  if (c && c->kind == ObjectKind::Document) return "kept, not shown: " + std::string(c->what);
  if (!i.isImage)
    return rec.imageClass ? "incomplete: an image object without pixel data"
                          : "kept, not shown: not an image";
  return "";
}

}  // namespace

Record recordFrom(const Header& h) {
  AttributeReader r(h);
  Record out;
  Instance& i = out.instance;
  i.transferSyntaxUid = h.transferSyntaxUid;
  i.sopClassUid = r.code(0x00080016);
  if (const Element* media = findIn(h.meta, 0x00020002); media && i.sopClassUid.empty())
    i.sopClassUid = std::string(rawText(h, *media));
  i.sopInstanceUid = r.code(0x00080018);
  const SopClass* c = findSopClass(i.sopClassUid);
  i.sopClassName = c ? std::string(c->name) : i.sopClassUid;
  out.imageClass = isImageClass(c);
  i.modality = r.code(0x00080060);
  i.imageType = r.codes(0x00080008);
  i.instanceNumber = r.integer(0x00200013);
  i.frameOfReferenceUid = r.code(0x00200052);
  i.patientOrientation = r.code(0x00200020);
  out.quadruped = r.code(0x00102210) == "QUADRUPED";
  i.photometric = r.code(0x00280004);
  i.presentationLutShape = r.code(0x20500020);
  const auto frames = r.integer(0x00280008);
  i.framesDeclared = frames && *frames > 0 ? static_cast<std::uint64_t>(*frames) : 1;

  out.patientId = r.text(0x00100020);
  out.issuer = r.text(0x00100021);
  out.patientName = r.text(0x00100010, true);
  out.birthDate = r.code(0x00100030);
  out.sex = r.code(0x00100040);
  out.studyUid = r.code(0x0020000D);
  out.studyDate = r.code(0x00080020);
  out.studyTime = r.code(0x00080030);
  out.studyDescription = r.text(0x00081030);
  out.accession = r.text(0x00080050);
  out.seriesUid = r.code(0x0020000E);
  out.seriesDescription = r.text(0x0008103E);
  out.seriesNumber = r.integer(0x00200011);

  i.isImage = h.pixels.has_value();
  if (i.isImage) readPixels(h, out);
  readFrames(r, c, out);
  if (i.sopClassUid == kRealWorldMappingClass) out.realWorldOf = readRealWorldReferences(r);
  i.acquisitionNumber = r.integer(0x00200012);
  i.notShown = whyNotShown(out);

  out.lossyTag = r.code(0x00282110);
  const std::string& ts = h.transferSyntaxUid;
  i.lossy = out.lossyTag == "01" || ts == "1.2.840.10008.1.2.4.50" || ts == "1.2.840.10008.1.2.4.51" ||
            ts == "1.2.840.10008.1.2.4.81" || ts == "1.2.840.10008.1.2.4.91";
  readNames(r, i.names);
  out.part10 = h.part10;
  out.textDamaged = r.textDamaged();
  out.contradictsSyntax = h.contradictsSyntax;
  out.strayDelimiters = h.strayDelimiters;
  return out;
}

}  // namespace vernier
