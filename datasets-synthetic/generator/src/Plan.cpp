// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plan.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "MultiFrame.h"
#include "PortableMath.h"
#include "vernier/base/Random.h"

namespace vernier::phantoms {
namespace {

struct Axes {
  glm::dvec3 row, column, normal;
};

// Directions of increasing column index and row index.
Axes axesOf(const Json& grid) {
  const std::string plane = grid.value("plane", "axial");
  glm::dvec3 row(1, 0, 0), column(0, 1, 0);
  if (plane == "coronal") column = {0, 0, -1};
  if (plane == "sagittal") {
    row = {0, 1, 0};
    column = {0, 0, -1};
  }
  const int flip = static_cast<int>(grid.value("flip", 0.0));
  if (flip & 1) row = -row;
  if (flip & 2) column = -column;
  if (flip & 4) std::swap(row, column);
  const double oblique_deg = grid.value("oblique_deg", 0.0);
  if (oblique_deg != 0.0) {
    const glm::dmat3 turn = rotationOf({oblique_deg, 0.7 * oblique_deg, -0.4 * oblique_deg});
    row = turn * row;
    column = turn * column;
  }
  const auto rounded = [](glm::dvec3 v) {
    return glm::dvec3(dsRounded(v.x), dsRounded(v.y), dsRounded(v.z));
  };
  row = rounded(row);
  column = rounded(column);
  return {row, column, glm::cross(row, column)};
}

std::string numbered(const char* prefix, std::size_t n) {
  const std::string digits = std::to_string(n);
  std::string name = prefix;
  name.append(digits.size() < 4 ? 4 - digits.size() : 0, '0').append(digits).append(".dcm");
  return name;
}

std::vector<SlicePlan> evenSlices(const Json& grid, const Axes& axes) {
  const auto columns = grid.at("columns").get<double>(), rows = grid.at("rows").get<double>();
  const auto slices = grid.at("slices").get<std::int64_t>();
  const glm::dvec3 spacing = vecOf(grid.at("spacing_mm"));
  const glm::dvec3 centre = grid.contains("centre_mm") ? vecOf(grid["centre_mm"]) : glm::dvec3(0.0);
  const glm::dvec3 first = centre - 0.5 * (columns - 1.0) * spacing.x * axes.row -
                           0.5 * (rows - 1.0) * spacing.y * axes.column -
                           0.5 * static_cast<double>(slices - 1) * spacing.z * axes.normal;
  std::vector<SlicePlan> all(static_cast<std::size_t>(slices));
  for (std::size_t k = 0; k < all.size(); ++k) {
    all[k].origin_mm = first + static_cast<double>(k) * spacing.z * axes.normal;
    all[k].rowDirection = axes.row;
    all[k].columnDirection = axes.column;
    all[k].noiseKey = static_cast<std::int64_t>(k);
  }
  return all;
}

void tilt(std::vector<SlicePlan>& slices, const Json& fault, const Axes& axes, double step_mm,
          Json& findings) {
  const double deg = fault.at("deg");
  const double shift_mm = step_mm * portableSin(radiansOf(deg)) / portableCos(radiansOf(deg));
  const double middle = 0.5 * static_cast<double>(slices.size() - 1);
  for (std::size_t k = 0; k < slices.size(); ++k)
    slices[k].origin_mm += (static_cast<double>(k) - middle) * shift_mm * axes.column;
  findings.push_back({{"code", "tilt"}, {"shear_deg", deg}});
}

void gap(std::vector<SlicePlan>& slices, const Json& fault, const Axes& axes, Json& findings) {
  const auto from = fault.at("first_missing").get<std::size_t>(),
             count = fault.at("missing").get<std::size_t>();
  if (from == 0 || from + count >= slices.size())
    throw std::invalid_argument("recipe: the gap is not inside the stack");
  findings.push_back({{"code", "gap"},
                      {"from_mm", glm::dot(slices[from - 1].origin_mm, axes.normal)},
                      {"to_mm", glm::dot(slices[from + count].origin_mm, axes.normal)},
                      {"slices_missing", count}});
  slices.erase(slices.begin() + static_cast<std::ptrdiff_t>(from),
               slices.begin() + static_cast<std::ptrdiff_t>(from + count));
}

void uneven(std::vector<SlicePlan>& slices, const Json& fault, const Axes& axes, Json& findings) {
  const Json& offsets = fault.at("offsets_mm");
  for (std::size_t k = 0; k < slices.size(); ++k)
    slices[k].origin_mm += offsets.at(k % offsets.size()).get<double>() * axes.normal;
  findings.push_back({{"code", "uneven-spacing"}});
}

// Names and numbers that say nothing, or the wrong thing, about the order.
void shuffle(std::vector<SlicePlan>& slices, std::uint64_t seed) {
  std::vector<std::size_t> order(slices.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::sort(order.begin(), order.end(), [seed](std::size_t a, std::size_t b) {
    return randomBits(seed, 5000 + a) < randomBits(seed, 5000 + b);
  });
  static constexpr char kHex[] = "0123456789ABCDEF";
  for (std::size_t k = 0; k < slices.size(); ++k) {
    slices[k].instanceNumber = static_cast<int>(order[k]) + 1;
    std::string name;
    for (std::uint64_t bits = randomBits(seed, 9000 + k), n = 0; n < 8; ++n, bits >>= 4)
      name += kHex[bits & 15];
    slices[k].fileName = name + ".dcm";
  }
}

void duplicate(SeriesPlan& series, const Json& fault, const StudyPlan& study, const std::string& variant,
               Json& findings) {
  const auto index = fault.at("slice").get<std::size_t>();
  SlicePlan twin = series.slices.at(index);
  twin.fileName = numbered("TWIN", index + 1);
  const std::string kind = fault.at("kind");
  if (kind != "identical") twin.valueOffset = fault.at("value_offset");
  if (kind == "position") {
    twin.sopUid = uidOf(study.name + ":" + variant, study.seed, "twin");
    twin.instanceNumber = static_cast<int>(series.slices.size()) + 1;
    findings.push_back({{"code", "coincident-positions"}, {"pairs", 1}});
  } else {
    findings.push_back(
        {{"code", "repeated-sop-instance-uid"}, {"files", 2}, {"identical", kind == "identical"}});
  }
  series.slices.push_back(twin);
}

std::vector<Window> windowsOf(const Json& list) {
  const auto text = [](const Json& v) {
    return v.is_string() ? v.get<std::string>() : dsOf(v.get<double>());
  };
  std::vector<Window> all;
  for (const Json& w : list) all.push_back({text(w.at("center")), text(w.at("width")), w.value("name", "")});
  return all;
}

// Red rises, green falls, blue runs through its range five times: no two entries are alike.
void paletteOf(const Json& palette, SeriesPlan& s) {
  const std::string coding = palette.at("coding");
  s.paletteBits = coding == "8" ? 8 : 16;
  s.paletteSegmented = coding == "segmented";
  const unsigned unit = s.paletteBits == 8 ? 1 : 257;
  for (unsigned n = 0; n < 256; ++n)
    s.palette.push_back({static_cast<std::uint16_t>(unit * n), static_cast<std::uint16_t>(unit * (255 - n)),
                         static_cast<std::uint16_t>(unit * (5 * n % 256))});
}

PresentationPlan presentationOf(const Json& p) {
  PresentationPlan plan;
  plan.label = p.at("label");
  plan.slice = p.at("slice");
  plan.center = p.at("center");
  plan.width = p.at("width");
  plan.inverse = p.at("inverse");
  plan.rotation_deg = p.at("rotation_deg");
  plan.flip = p.at("flip");
  for (std::size_t n = 0; n < 4; ++n) plan.shutter[n] = p.at("shutter").at(n);
  plan.shutterValue = p.at("shutter_value");
  plan.text = p.at("text");
  return plan;
}

void describe(SeriesPlan& s, const Json& recipe) {
  const Json& grid = recipe.at("grid");
  const std::string modality = recipe.at("modality");
  s.storage = modality == "MR" ? Storage::Mr : modality == "CT" ? Storage::Ct : Storage::SecondaryCapture;
  s.columns = grid.at("columns");
  s.rows = grid.at("rows");
  const glm::dvec3 spacing = vecOf(grid.at("spacing_mm"));
  s.columnSpacing_mm = dsRounded(spacing.x);
  s.rowSpacing_mm = dsRounded(spacing.y);
  s.step_mm = spacing.z;
  s.thickness_mm = dsRounded(grid.value("thickness_mm", spacing.z));
  if (recipe.contains("channels")) s.samples = 3;
  if (recipe.contains("pixels")) {
    const Json& p = recipe["pixels"];
    if (p.contains("palette")) paletteOf(p["palette"], s);
    s.bitsAllocated = p.value("bits_allocated", 16);
    s.bitsStored = p.value("bits_stored", 16);
    s.isSigned = p.value("signed", true);
    s.slope = p.value("slope", 1.0);
    s.intercept = p.value("intercept", 0.0);
    if (p.contains("padding")) s.padding = p["padding"].get<int>();
    s.fieldOfView_mm = p.value("field_of_view_mm", 0.0);
  }
}

void encodeAs(SeriesPlan& s, const Json& syntax) {
  s.transferSyntaxUid = syntax.at("uid");
  s.quality = syntax.value("quality", 0);
  s.lossyMethod = syntax.value("lossy_method", "");
  s.storedBound = syntax.value("stored_bound", 0.0);
  if (syntax.value("eight_bit",
                   false)) {  // 12 bits of values in 8: SC, since CT and MR images have 16 allocated
    s.storage = Storage::SecondaryCapture;
    s.bitsAllocated = s.bitsStored = 8;
    s.slope *= 16.0;
  }
}

// A grid given as n voxels along each edge of a cube, first and last centre on its faces.
Json withCube(Json recipe) {
  Json& grid = recipe["grid"];
  if (!grid.contains("cube_mm")) return recipe;
  const int n = std::stoi(grid.at("n").get<std::string>());
  const double spacing_mm = grid["cube_mm"].get<double>() / (n - 1);
  grid["columns"] = grid["rows"] = grid["slices"] = n;
  grid["spacing_mm"] = {spacing_mm, spacing_mm, spacing_mm};
  return recipe;
}

}  // namespace

const char* modalityOf(Storage s) {
  switch (s) {
    case Storage::Ct:
    case Storage::EnhancedCt:
      return "CT";
    case Storage::Mr:
    case Storage::EnhancedMr:
      return "MR";
    case Storage::SecondaryCapture:
      break;
  }
  return "OT";
}

std::uint64_t seedOf(const Json& recipe) {
  return static_cast<std::uint64_t>(recipe.at("seed").get<double>());
}

StudyPlan makeStudyPlan(const Json& given, const std::string& variant) {
  const Json recipe = withCube(given);
  const Json& grid = recipe.at("grid");
  StudyPlan study;
  study.name = recipe.at("name");
  study.title = recipe.at("title");
  study.bodyPart = recipe.value("body_part", "HEAD");
  study.seed = seedOf(recipe);
  const std::string uidName = study.name + ":" + variant;
  const auto uid = [&](const std::string& role) { return uidOf(uidName, study.seed, role); };
  study.studyUid = uid("study");
  study.frameOfReferenceUid = uid("frame");

  const Json fault = recipe.value("fault", Json{{"kind", "none"}});
  const std::string kind = fault.at("kind");
  const Axes axes = axesOf(grid);

  SeriesPlan base;
  describe(base, recipe);
  base.slices = evenSlices(grid, axes);
  if (kind == "tilt") tilt(base.slices, fault, axes, base.step_mm, study.findings);
  if (kind == "gap") gap(base.slices, fault, axes, study.findings);
  if (kind == "uneven") uneven(base.slices, fault, axes, study.findings);
  if (kind == "two-orientations") {
    Json second = grid;
    second["plane"] = fault.at("plane");
    for (SlicePlan& s : evenSlices(second, axesOf(second))) {
      s.noiseKey += 100000;
      base.slices.push_back(s);
    }
    study.findings.push_back({{"code", "several-orientations-in-series"}, {"stacks", 2}});
  }
  const bool reversed = grid.value("left_handed", "no") == std::string("yes");
  const std::vector<Window> windows = windowsOf(recipe.value("windows", Json::array()));
  for (std::size_t k = 0; k < base.slices.size(); ++k) {
    SlicePlan& s = base.slices[k];
    const std::size_t place = reversed ? base.slices.size() - 1 - k : k;
    s.origin_mm = {dsRounded(s.origin_mm.x), dsRounded(s.origin_mm.y), dsRounded(s.origin_mm.z)};
    s.instanceNumber = static_cast<int>(place) + 1;
    s.fileName = numbered("IM", place + 1);
    s.windows = windows;
    if (fault.contains("windows_by_slice") && !fault["windows_by_slice"].empty()) {
      const Json& odd = fault["windows_by_slice"].at(k % fault["windows_by_slice"].size());
      s.windows = windowsOf(odd.at("windows"));
      s.windowFunction = odd.value("function", "");
    }
  }
  if (kind == "shuffled") shuffle(base.slices, study.seed);

  const Json syntaxes =
      recipe.value("syntaxes", Json::array({Json{{"name", ""}, {"uid", base.transferSyntaxUid}}}));
  for (std::size_t n = 0; n < syntaxes.size(); ++n) {
    SeriesPlan series = base;
    encodeAs(series, syntaxes[n]);
    const std::string name = syntaxes[n].at("name");
    series.number = static_cast<int>(n) + 1;
    series.description = name.empty() ? study.title : name;
    series.seriesUid = uid("series " + std::to_string(n));
    for (std::size_t k = 0; k < series.slices.size(); ++k) {
      SlicePlan& s = series.slices[k];
      s.sopUid = uid("series " + std::to_string(n) + " image " + std::to_string(k));
      if (syntaxes.size() > 1)
        s.fileName = std::string("S").append(std::to_string(n + 1)).append("-").append(s.fileName);
    }
    if (fault.contains("value_offset")) duplicate(series, fault, study, variant, study.findings);
    study.series.push_back(std::move(series));
  }
  if (recipe.contains("multi_frame")) makeMultiFrame(recipe, uid, study);
  if (recipe.contains("presentation")) {
    study.presentation = presentationOf(recipe["presentation"]);
    study.presentation->sopUid = uid("presentation");
    study.presentation->seriesUid = uid("presentation series");
  }
  if (base.padding) study.findings.push_back({{"code", "padding-pixels"}, {"padding", *base.padding}});
  return study;
}

}  // namespace vernier::phantoms
