// SPDX-License-Identifier: GPL-3.0-or-later
#include "Attributes.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "FrameWindows.h"
#include "PixelModule.h"
#include "SopClasses.h"
#include "StackGeometry.h"
#include "Text.h"
#include "vernier/base/Checked.h"

namespace vernier {
namespace {

class Reader {
 public:
  explicit Reader(const Header& h) : h_(h), charset_(charsetOf(h.elements)) {}

  const Header& header() const { return h_; }
  const Element* element(Tag t) const { return h_.find(t); }
  std::string_view raw(Tag t) const {
    const Element* e = h_.find(t);
    return e ? rawText(h_, *e) : std::string_view();
  }
  // Codes, UIDs, dates: no character set applies. Bytes beyond ASCII would not be valid UTF-8.
  std::string code(Tag t) const {
    std::string s(raw(t));
    for (char& c : s)
      if (static_cast<unsigned char>(c) >= 0x80 || static_cast<unsigned char>(c) < 0x20) c = '?';
    return s;
  }
  std::string text(Tag t, bool personName = false) { return decoded(raw(t), charset_, personName); }
  std::string decoded(std::string_view bytes, const std::vector<std::string>& charset, bool personName) {
    DecodedText d = decodeText(bytes, charset, personName);
    damaged_ = damaged_ || d.damaged;
    return std::move(d.utf8);
  }
  std::vector<std::string> codes(Tag t) const { return splitValues(code(t)); }
  std::vector<double> decimals(Tag t) const { return decimalsOf(raw(t)); }
  static std::vector<double> decimalsOf(std::string_view text) {
    std::vector<double> out;
    for (const std::string& v : splitValues(text)) out.push_back(parseDecimal(v).value_or(std::nan("")));
    return out;
  }
  std::optional<double> decimal(Tag t) const {
    const auto v = decimals(t);
    return v.empty() || std::isnan(v[0]) ? std::nullopt : std::optional(v[0]);
  }
  std::optional<std::int64_t> integer(Tag t) const {
    const auto v = splitValues(raw(t));
    return v.empty() ? std::nullopt : parseInteger(v[0]);
  }
  // FD values, native order.
  std::vector<double> doubles(Tag t) const {
    const Element* e = h_.find(t);
    std::vector<double> out;
    if (!e || e->length % 8 != 0) return out;
    const auto bytes = h_.value(*e);
    for (std::size_t i = 0; i + 8 <= bytes.size() && out.size() < 16; i += 8) {
      std::uint64_t bits = 0;
      for (std::size_t b = 0; b < 8; ++b)
        bits = bits << 8 | std::to_integer<std::uint64_t>(bytes[i + (e->encoding.bigEndian ? b : 7 - b)]);
      out.push_back(std::bit_cast<double>(bits));
    }
    return out;
  }
  std::vector<std::string> charsetOf(const std::vector<Element>& elements) const {
    const Element* e = findIn(elements, 0x00080005);
    return e ? splitValues(rawText(h_, *e)) : std::vector<std::string>();
  }
  const std::vector<std::string>& charset() const { return charset_; }
  bool damaged() const { return damaged_; }

 private:
  const Header& h_;
  std::vector<std::string> charset_;
  bool damaged_ = false;
};

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
void readNames(Reader& r, std::vector<NamedText>& out) {
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

void readPlane(const Reader& r, Record& out) {
  const auto p = r.decimals(0x00200032), o = r.decimals(0x00200037);
  if (p.size() == 3 && o.size() == 6) {
    RawPlane plane;
    plane.position = {p[0], p[1], p[2]};
    plane.row = {o[0], o[1], o[2]};
    plane.column = {o[3], o[4], o[5]};
    plane.offOrthonormal =
        std::max({std::abs(glm::length(plane.row) - 1), std::abs(glm::length(plane.column) - 1),
                  std::abs(glm::dot(plane.row, plane.column))});
    out.rawPlane = plane;
    // 1e-9: what decimal text of the limit itself may be off.
    if (plane.offOrthonormal <= kOrthonormalFlagged + 1e-9)
      out.instance.plane = orthonormalPlane(plane.position, plane.row, plane.column);
    if (out.instance.plane)
      out.instance.filePlane =
          FramePlane{PatientPoint(plane.position), PatientVec(plane.row), PatientVec(plane.column)};
  }
  const auto s = r.decimals(0x00280030);
  if (s.empty()) return;
  const auto usable = [](double v) { return v >= 1e-4 && v <= 1e3; };  // false for NaN
  if (s.size() == 2 && usable(s[0]) && usable(s[1]))
    out.instance.pixelSpacing_mm = {s[0], s[1]};
  else
    out.pixelSpacingBad = true;
}

void readVoi(Reader& r, Record& out) {
  const auto centers = r.decimals(0x00281050), widths = r.decimals(0x00281051);
  const auto explanations = splitValues(r.text(0x00281055));
  const std::string function = r.code(0x00281056);
  for (std::size_t i = 0; i < std::min(centers.size(), widths.size()); ++i) {
    VoiWindow w{centers[i], widths[i], VoiFunction::Linear, i < explanations.size() ? explanations[i] : ""};
    if (function == "LINEAR_EXACT") w.function = VoiFunction::LinearExact;
    if (function == "SIGMOID") w.function = VoiFunction::Sigmoid;
    out.windowCenters.push_back(w.center);
    out.windowWidths.push_back(w.width);
    if (std::isfinite(w.center) && std::isfinite(w.width) && w.width > 0) {
      out.instance.windows.push_back(w);
    } else {
      out.badWindowCenters.push_back(w.center);
      out.badWindowWidths.push_back(w.width);
    }
  }
}

// One item of a Modality or VOI LUT Sequence.
std::optional<LutTable> readLut(Reader& r, const std::vector<Element>& item, bool signedInput) {
  const Header& h = r.header();
  const Element* descriptor = findIn(item, 0x00283002);
  const Element* data = findIn(item, 0x00283006);
  if (!descriptor || !data || descriptor->length < 6) return std::nullopt;
  const std::uint16_t declared = *word(h, *descriptor, 0), first = *word(h, *descriptor, 1);
  LutTable lut;
  const std::size_t n = declared == 0 ? 65536 : declared;
  const bool isSigned = descriptor->is("SS") || (!descriptor->is("US") && signedInput);
  lut.firstMapped = isSigned ? static_cast<std::int16_t>(first) : first;
  lut.bits = *word(h, *descriptor, 2);
  if (lut.bits == 0 || lut.bits > 16) return std::nullopt;
  if (data->length >= 2 * n) {
    for (std::size_t i = 0; i < n; ++i) lut.data.push_back(*word(h, *data, i));
  } else if (lut.bits <= 8 && data->length >= n) {
    for (const std::byte b : h.value(*data).first(n)) lut.data.push_back(std::to_integer<std::uint16_t>(b));
  } else {
    return std::nullopt;
  }
  if (const Element* e = findIn(item, 0x00283003))
    lut.explanation = r.decoded(rawText(h, *e), r.charset(), false);
  return lut;
}

void readValues(Reader& r, Record& out) {
  Instance& i = out.instance;
  const Header& h = r.header();
  const Element* sign = r.element(0x00280103);
  const bool isSigned = sign && word(h, *sign) == 1;

  const auto slope = r.decimals(0x00281053), intercept = r.decimals(0x00281052);
  if (!slope.empty()) i.rescale.slope = slope[0];
  if (!intercept.empty()) i.rescale.intercept = intercept[0];
  if (!std::isfinite(i.rescale.slope) || !std::isfinite(i.rescale.intercept) || i.rescale.slope == 0) {
    i.rescale = {};
    i.rescaleInvalid = true;
  }
  std::string lutType;
  if (const Element* e = r.element(0x00283000))
    for (const auto& item : itemsOf(h, *e))
      if (auto lut = readLut(r, item, isSigned); lut && !i.modalityLut) {
        i.modalityLut = std::move(lut);
        if (const Element* t = findIn(item, 0x00283004)) lutType = std::string(rawText(h, *t));
      }
  if (const Element* e = r.element(0x00283010))
    for (const auto& item : itemsOf(h, *e))
      if (auto lut = readLut(r, item, isSigned || i.rescale.intercept < 0))
        i.voiLuts.push_back(std::move(*lut));
  readVoi(r, out);

  const auto stored = [&](Tag t) -> std::optional<double> {
    const Element* e = r.element(t);
    const auto v = e ? word(h, *e) : std::nullopt;
    if (!v) return std::nullopt;
    return isSigned ? static_cast<std::int16_t>(*v) : *v;
  };
  if (const auto a = stored(0x00280120)) {
    const double b = stored(0x00280121).value_or(*a);
    i.paddingFirst = std::min(*a, b);
    i.paddingLast = std::max(*a, b);
  }

  out.rescaleType = r.code(0x00281054);
  out.units = r.code(0x00541001);
  const bool localizer = i.imageType.size() > 2 && i.imageType[2] == "LOCALIZER";
  const std::string type = i.modalityLut ? lutType : out.rescaleType;
  i.unit = "stored value";
  if (i.modality == "CT" && (type == "HU" || type.empty()) && !localizer)
    i.unit = "HU";
  else if (i.modality == "PT" && !out.units.empty())
    i.unit = out.units;
  else if (!type.empty() && type != "US" && type != "HU")
    i.unit = type;
  if (i.rescaleInvalid) i.unit = "stored value";
}

void readSplitKeys(Reader& r, Record& out) {
  Instance& i = out.instance;
  out.kernel = r.code(0x00181210);
  out.kvp = r.code(0x00180060);
  out.echoNumbers = r.code(0x00180086);
  i.echoTime_ms = r.decimal(0x00180081);
  out.stackId = r.code(0x00209056);
  const Element* segment = r.element(0x0062000B);
  if (segment && word(r.header(), *segment)) out.segmentNumber = std::to_string(*word(r.header(), *segment));
  if (const auto b = r.doubles(0x00189087); !b.empty()) out.bValue_s_mm2 = b[0];
  if (const auto d = r.doubles(0x00189089); d.size() == 3)
    out.diffusionDirection = glm::dvec3(d[0], d[1], d[2]);
  i.temporalPosition = r.integer(0x00200100);
  i.acquisitionNumber = r.integer(0x00200012);
  out.acquisitionNumber = r.code(0x00200012);
  out.contrastAgent = r.text(0x00180010);
  out.triggerTime = r.code(0x00181060);
  out.cardiacPhase = r.code(0x00189241);
  out.acquisitionTime = r.code(0x00080032);
  out.contentTime = r.code(0x00080033);
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
  if (h.pixels->encapsulated) {
    if (auto r = p.checkFileCanHold(h.pixels->bytesThere); !r) i.pixelError = r.error();
    return;
  }
  const auto bits = checkedProduct({p.rows, p.columns, p.samplesPerPixel, p.bitsAllocated, p.framesDeclared});
  // YBR_FULL_422 stores two chroma samples for two pixels.
  const std::uint64_t need = !bits ? 0 : (p.photometric == "YBR_FULL_422" ? *bits / 3 * 2 : *bits) / 8;
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
  if (c && c->kind == ObjectKind::Segmentation) return "not shown yet: segmentation";
  if (c && c->kind == ObjectKind::Dose) return "not shown yet: radiotherapy dose";
  if (c && c->kind == ObjectKind::EnhancedImage) return "not shown yet: enhanced multi-frame image";
  if (i.photometric == "PALETTE COLOR") return "not shown yet: palette colour";
  if (!i.pixelError && i.pixels.samplesPerPixel != 1) return "not shown yet: colour image";
  if (!i.pixelError && i.pixels.bitsAllocated == 1) return "not shown yet: one bit per pixel";
  return "";
}

}  // namespace

Record recordFrom(const Header& h) {
  Reader r(h);
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
  i.sliceThickness_mm = r.decimal(0x00180050).value_or(0);
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
  readPlane(r, out);
  readSplitKeys(r, out);
  if (i.isImage || out.imageClass) readValues(r, out);
  if (i.isImage) readPixels(h, out);
  if (i.isImage) out.frameWindows = differentFrameWindows(h);
  i.notShown = whyNotShown(out);

  out.lossyTag = r.code(0x00282110);
  const std::string& ts = h.transferSyntaxUid;
  i.lossy = out.lossyTag == "01" || ts == "1.2.840.10008.1.2.4.50" || ts == "1.2.840.10008.1.2.4.51" ||
            ts == "1.2.840.10008.1.2.4.81" || ts == "1.2.840.10008.1.2.4.91";
  readNames(r, i.names);
  out.part10 = h.part10;
  out.textDamaged = r.damaged();
  out.contradictsSyntax = h.contradictsSyntax;
  out.strayDelimiters = h.strayDelimiters;
  return out;
}

}  // namespace vernier
