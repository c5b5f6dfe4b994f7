// SPDX-License-Identifier: GPL-3.0-or-later
#include "PresentationFrom.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "AttributeReader.h"
#include "FrameReading.h"
#include "Text.h"

namespace vernier {
namespace {

constexpr std::string_view kAnyState = "1.2.840.10008.5.1.4.1.1.11.";
constexpr std::string_view kGrey = "1.2.840.10008.5.1.4.1.1.11.1", kColour = "1.2.840.10008.5.1.4.1.1.11.2";

// Values of four bytes each. In implicit encoding only the tag says that they are not of eight.
std::vector<std::uint32_t> words32(const AttributeReader& r, Tag t) {
  std::vector<std::uint32_t> out;
  const Element* e = r.element(t);
  for (std::size_t n = 0; e && n + 1 < e->length / 2; n += 2) {
    const std::uint32_t a = *word(r.header(), *e, n), b = *word(r.header(), *e, n + 1);
    out.push_back(e->encoding.bigEndian ? a << 16 | b : b << 16 | a);
  }
  return out;
}
std::vector<double> signedLongs(const AttributeReader& r, Tag t) {  // SL
  std::vector<double> out;
  for (const std::uint32_t w : words32(r, t)) out.push_back(std::bit_cast<std::int32_t>(w));
  return out;
}
std::vector<double> floats(const AttributeReader& r, Tag t) {  // FL
  std::vector<double> out;
  for (const std::uint32_t w : words32(r, t)) out.push_back(static_cast<double>(std::bit_cast<float>(w)));
  return out;
}

std::optional<glm::dvec2> pair(const std::vector<double>& v) {
  if (v.size() < 2) return std::nullopt;
  const glm::dvec2 p(v[0], v[1]);
  return std::isfinite(p.x) && std::isfinite(p.y) ? std::optional(p) : std::nullopt;
}

// Referenced Image Sequence (0008,1140) of an item.
std::vector<ReferencedImage> imagesOf(AttributeReader& item) {
  std::vector<ReferencedImage> out;
  for (AttributeReader& image : item.items(0x00081140)) {
    ReferencedImage r{image.code(0x00081155), {}};
    for (const double n : image.decimals(0x00081160))
      if (n >= 1 && n <= 1e9) r.frames.push_back(static_cast<std::int64_t>(n));
    if (!r.sopInstanceUid.empty()) out.push_back(std::move(r));
  }
  return out;
}

void readModality(AttributeReader& top, PresentationState& p) {
  const auto slope = top.decimals(0x00281053), intercept = top.decimals(0x00281052);
  const bool given = !slope.empty() || !intercept.empty();
  const ModalityRescale r{slope.empty() ? 1 : slope[0], intercept.empty() ? 0 : intercept[0]};
  if (given && std::isfinite(r.slope) && r.slope != 0 && std::isfinite(r.intercept))
    p.rescale = r;
  else if (given)
    p.notApplied.push_back("a rescale slope of zero or that is no number");
  for (AttributeReader& item : top.items(0x00283000)) {
    if (!p.modalityLut) p.modalityLut = readLut(item, false);
    if (!p.modalityLut) p.notApplied.push_back("a modality LUT that contradicts itself");
  }
}

void readVois(AttributeReader& top, PresentationState& p) {
  for (AttributeReader& item : top.items(0x00283110)) {
    PresentationVoi voi;
    voi.images = imagesOf(item);
    const bool signedInput = p.rescale.intercept < 0 && !p.modalityLut;
    for (AttributeReader& lut : item.items(0x00283010))
      if (!voi.lut) voi.lut = readLut(lut, signedInput);
    if (item.has(0x00283010) && !voi.lut) p.notApplied.push_back("a VOI LUT that contradicts itself");
    // Several windows are alternatives (C.11.8): the first is the default.
    if (const WindowList windows = readWindows(item); !voi.lut && !windows.valid.empty())
      voi.window = windows.valid.front();
    if (voi.lut || voi.window)
      p.vois.push_back(std::move(voi));
    else if (item.has(0x00281050))
      p.notApplied.push_back("a window without a usable width");
  }
}

void readPresentationLut(AttributeReader& top, PresentationState& p) {
  p.inverse = top.code(0x20500020) == "INVERSE";
  for (AttributeReader& item : top.items(0x20500010)) {
    if (!p.presentationLut) p.presentationLut = readLut(item, false);
    if (!p.presentationLut) p.notApplied.push_back("a presentation LUT that contradicts itself");
  }
}

void readShutter(AttributeReader& top, PresentationState& p) {
  Shutter s;
  bool any = false, wrong = false;
  const auto one = [&](Tag t, double& to) {
    const auto v = top.decimals(t);
    if (v.empty() || !std::isfinite(v[0])) return false;
    to = v[0];
    return true;
  };
  for (const std::string& shape : splitValues(top.code(0x00181600))) {
    if (shape == "RECTANGULAR") {
      Shutter::Rectangle r;
      const bool whole = one(0x00181602, r.left) && one(0x00181604, r.right) && one(0x00181606, r.upper) &&
                         one(0x00181608, r.lower);
      if (whole) s.rectangle = r;
      (whole ? any : wrong) = true;
    } else if (shape == "CIRCULAR") {
      Shutter::Circle c;
      const auto centre = pair(top.decimals(0x00181610));  // row\column
      const bool whole = centre && one(0x00181612, c.radius);
      if (whole) c.centre = {centre->y, centre->x}, s.circle = c;
      (whole ? any : wrong) = true;
    } else if (shape == "POLYGONAL") {
      const auto v = top.decimals(0x00181620);
      const bool whole = v.size() >= 6 && v.size() % 2 == 0 &&
                         std::all_of(v.begin(), v.end(), [](double x) { return std::isfinite(x); });
      for (std::size_t n = 0; whole && n < v.size(); n += 2) s.polygon.push_back({v[n + 1], v[n]});
      (whole ? any : wrong) = true;
    } else if (shape == "BITMAP") {
      p.notApplied.push_back("a bitmap shutter");
    } else if (!shape.empty()) {
      wrong = true;
    }
  }
  if (wrong) p.notApplied.push_back("a shutter that is not fully described");
  if (const auto v = top.words(0x00181622); !v.empty()) s.grey = v[0] / 65535.0;
  if (any) p.shutter = std::move(s);
}

void readAreas(AttributeReader& top, PresentationState& p) {
  for (AttributeReader& item : top.items(0x0070005A)) {
    DisplayedArea a;
    a.images = imagesOf(item);
    const auto first = pair(signedLongs(item, 0x00700052)), last = pair(signedLongs(item, 0x00700053));
    const std::string mode = item.code(0x00700100);
    a.mode = mode == "TRUE SIZE" ? AreaMode::TrueSize
             : mode == "MAGNIFY" ? AreaMode::Magnify
                                 : AreaMode::ScaleToFit;
    if (const auto m = floats(item, 0x00700103); !m.empty()) a.magnification = m[0];
    const auto positive = [](const std::optional<glm::dvec2>& v) { return v && v->x > 0 && v->y > 0; };
    if (const auto v = pair(item.decimals(0x00700101)); positive(v)) a.pixelSpacing_mm = v;
    if (const auto v = pair(item.decimals(0x00700102)); positive(v)) a.pixelAspect = v;
    if (a.mode == AreaMode::Magnify && !(a.magnification > 0 && a.magnification < 1e4)) {
      p.notApplied.push_back("a magnification that is no number above 0");
      a.mode = AreaMode::ScaleToFit;
    }
    if (!first || !last) {
      p.notApplied.push_back("a displayed area without corners");
      continue;
    }
    a.topLeft = *first;
    a.bottomRight = *last;
    p.areas.push_back(std::move(a));
  }
}

GraphicUnits unitsOf(const std::string& code) {
  return code == "DISPLAY" ? GraphicUnits::Display : GraphicUnits::Pixel;
}

std::optional<Graphic> graphicOf(AttributeReader& item) {
  Graphic g;
  const std::string type = item.code(0x00700023);
  g.units = unitsOf(item.code(0x00700005));
  g.filled = item.code(0x00700024) == "Y";
  const auto v = floats(item, 0x00700022);
  for (std::size_t n = 0; n + 1 < v.size(); n += 2) {
    if (!std::isfinite(v[n]) || !std::isfinite(v[n + 1])) return std::nullopt;
    g.points.push_back({v[n], v[n + 1]});
  }
  const std::size_t n = g.points.size();
  if (type == "POINT" && n == 1)
    g.shape = GraphicShape::Point;
  else if (type == "POLYLINE" && n >= 2)
    g.shape = GraphicShape::Polyline;
  else if (type == "INTERPOLATED" && n >= 2)
    g.shape = GraphicShape::Interpolated;
  else if (type == "CIRCLE" && n == 2)
    g.shape = GraphicShape::Circle;
  else if (type == "ELLIPSE" && n == 4)
    g.shape = GraphicShape::Ellipse;
  else
    return std::nullopt;
  return g;
}

GraphicText textOf(AttributeReader& item) {
  GraphicText t;
  for (const char c : item.text(0x00700006))
    if (c == '\n' || static_cast<unsigned char>(c) >= 0x20)
      t.text += c;
    else if (c == '\r')
      t.text += '\n';
  for (std::size_t at; (at = t.text.find("\n\n")) != std::string::npos;) t.text.erase(at, 1);  // \r\n
  t.boxUnits = unitsOf(item.code(0x00700003));
  t.anchorUnits = unitsOf(item.code(0x00700004));
  t.boxTopLeft = pair(floats(item, 0x00700010));
  t.boxBottomRight = pair(floats(item, 0x00700011));
  t.anchor = pair(floats(item, 0x00700014));
  t.anchorVisible = item.code(0x00700015) == "Y";
  return t;
}

struct Layer {
  std::string name;
  std::int64_t order = 0;
  double grey = 1;
};

void readAnnotations(AttributeReader& top, PresentationState& p) {
  std::vector<Layer> layers;
  for (AttributeReader& item : top.items(0x00700060)) {
    Layer l{item.code(0x00700002), 0, 1};
    if (const auto order = parseInteger(item.code(0x00700062))) l.order = *order;
    if (const auto grey = item.words(0x00700066); !grey.empty()) l.grey = grey[0] / 65535.0;
    layers.push_back(std::move(l));
  }
  bool compound = false, unreadable = false;
  for (AttributeReader& item : top.items(0x00700001)) {
    GraphicAnnotation a;
    a.images = imagesOf(item);
    const std::string name = item.code(0x00700002);
    const auto layer =
        std::find_if(layers.begin(), layers.end(), [&](const Layer& l) { return l.name == name; });
    if (layer != layers.end()) a.order = layer->order, a.grey = layer->grey;
    for (AttributeReader& g : item.items(0x00700009)) {
      if (auto graphic = graphicOf(g))
        a.graphics.push_back(std::move(*graphic));
      else
        unreadable = true;
    }
    for (AttributeReader& t : item.items(0x00700008)) {
      GraphicText text = textOf(t);
      if (!text.text.empty() && ((text.boxTopLeft && text.boxBottomRight) || text.anchor))
        a.texts.push_back(std::move(text));
      else
        unreadable = true;
    }
    compound |= item.has(0x00700209);
    p.annotations.push_back(std::move(a));
  }
  if (compound) p.notApplied.push_back("compound graphics");
  if (unreadable) p.notApplied.push_back("graphics that are not fully described");
}

bool hasOverlay(const Header& h) {
  return std::any_of(h.elements.begin(), h.elements.end(),
                     [](const Element& e) { return e.tag >> 24 == 0x60 && (e.tag & 0xFFFF) == 0x3000; });
}

bool activatesOverlay(const Header& h) {
  return std::any_of(h.elements.begin(), h.elements.end(), [](const Element& e) {
    return e.tag >> 24 == 0x60 && (e.tag & 0xFFFF) == 0x1001 && e.length > 0;
  });
}

void readOthers(AttributeReader& top, PresentationState& p) {
  const auto rotation = top.words(0x00700042);
  if (!rotation.empty() && rotation[0] < 360 && std::fmod(rotation[0], 90) == 0)
    p.rotation_deg = static_cast<int>(rotation[0]);
  else if (!rotation.empty())
    p.notApplied.push_back("a rotation that is not by right angles");
  p.flipHorizontal = top.code(0x00700041) == "Y";
  if (hasOverlay(top.header()) || activatesOverlay(top.header())) p.notApplied.push_back("overlays");
  if (top.has(0x00286100)) p.notApplied.push_back("mask subtraction");
  if (top.has(0x00282000)) p.notApplied.push_back("an ICC profile");
}

}  // namespace

std::optional<PresentationState> presentationFrom(const Header& h) {
  const Element* sopClass = h.find(0x00080016);
  const std::string uid(sopClass ? rawText(h, *sopClass) : std::string_view());
  if (!uid.starts_with(kAnyState)) return std::nullopt;
  AttributeReader top(h);
  PresentationState p;
  p.sopInstanceUid = top.code(0x00080018);
  p.label = top.code(0x00700080);
  p.description = top.text(0x00700081);
  for (AttributeReader& series : top.items(0x00081115)) {
    for (ReferencedImage& r : imagesOf(series)) p.images.push_back(std::move(r));
  }
  if (uid != kGrey && uid != kColour) {
    p.whyNot = "only greyscale and colour softcopy presentation states can be applied";
    return p;
  }
  p.greyscale = uid == kGrey;
  if (p.greyscale) {
    readModality(top, p);
    readVois(top, p);
    readPresentationLut(top, p);
  }
  readShutter(top, p);
  readAreas(top, p);
  readAnnotations(top, p);
  readOthers(top, p);
  return p;
}

bool refersTo(const std::vector<ReferencedImage>& images, const std::string& sopInstanceUid,
              std::int64_t frame) {
  return std::any_of(images.begin(), images.end(), [&](const ReferencedImage& r) {
    return r.sopInstanceUid == sopInstanceUid &&
           (r.frames.empty() || std::find(r.frames.begin(), r.frames.end(), frame) != r.frames.end());
  });
}

Result<FramePresentation> presentationFor(const PresentationState& p, const std::string& sopInstanceUid,
                                          std::int64_t frame) {
  if (!p.whyNot.empty())
    return makeError(ErrorCode::NotBuiltYet, "The presentation state cannot be applied: " + p.whyNot + ".");
  if (!refersTo(p.images, sopInstanceUid, frame))
    return makeError(
        ErrorCode::SceneInvalid,
        "The presentation state does not refer to this image; `vernier info` lists those that it is for.");
  const auto meant = [&](const std::vector<ReferencedImage>& images) {
    return images.empty() || refersTo(images, sopInstanceUid, frame);
  };
  FramePresentation f;
  f.sopInstanceUid = p.sopInstanceUid;
  f.label = p.label;
  f.greyscale = p.greyscale;
  f.rescale = p.rescale;
  f.modalityLut = p.modalityLut;
  f.presentationLut = p.presentationLut;
  f.inverse = p.inverse;
  f.shutter = p.shutter;
  f.rotation_deg = p.rotation_deg;
  f.flipHorizontal = p.flipHorizontal;
  f.notApplied = p.notApplied;
  for (const PresentationVoi& v : p.vois)
    if (meant(v.images)) {
      f.window = v.window;
      f.voiLut = v.lut;
      break;
    }
  for (const DisplayedArea& a : p.areas)
    if (meant(a.images)) {
      f.area = a;
      break;
    }
  if (f.area && f.area->mode == AreaMode::TrueSize)
    f.notApplied.push_back("true size (the size of the screen's pixels is not known)");
  for (const GraphicAnnotation& a : p.annotations)
    if (meant(a.images)) f.annotations.push_back(a);
  std::stable_sort(f.annotations.begin(), f.annotations.end(),
                   [](const GraphicAnnotation& a, const GraphicAnnotation& b) { return a.order < b.order; });
  return f;
}

}  // namespace vernier
