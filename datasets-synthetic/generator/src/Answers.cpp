// SPDX-License-Identifier: GPL-3.0-or-later
#include "Answers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "PortableMath.h"
#include "Sample.h"

namespace vernier::phantoms {
namespace {

Json jsonOf(glm::dvec3 v) { return Json::array({v.x, v.y, v.z}); }

const Solid& named(const std::vector<Solid>& solids, const std::string& name) {
  for (const Solid& s : solids)
    if (s.name == name) return s;
  throw std::invalid_argument("recipe: no solid is called " + name);
}

// Twelve digits: the last bits of acos differ between C libraries, the answers shall not.
double twelveDigits(double v) {
  if (v == 0.0) return 0.0;
  double scale = 1.0;
  while (std::fabs(v) * scale < 1e11) scale *= 10.0;
  return std::floor(v * scale + 0.5) / scale;
}

Json measure(const Json& m, const std::vector<Solid>& solids) {
  Json out = m;
  const std::string kind = m.at("kind");
  const auto at = [&](const Json& name) { return named(solids, name.get<std::string>()).centre_mm; };
  if (kind == "length") {
    const glm::dvec3 a = at(m["between"][0]), b = at(m["between"][1]);
    out["points_mm"] = Json::array({jsonOf(a), jsonOf(b)});
    out["value"] = twelveDigits(std::sqrt(glm::dot(b - a, b - a)));
    out["unit"] = "mm";
  } else if (kind == "angle") {
    const glm::dvec3 o = at(m["at"]), a = at(m["between"][0]) - o, b = at(m["between"][1]) - o;
    out["points_mm"] = Json::array({jsonOf(o + a), jsonOf(o), jsonOf(o + b)});
    const double cosine = glm::dot(a, b) / std::sqrt(glm::dot(a, a) * glm::dot(b, b));
    out["value"] = twelveDigits(std::acos(std::clamp(cosine, -1.0, 1.0)) * 180.0 / kPi);
    out["unit"] = "degree";
  } else if (kind == "area") {  // of the section through the centre, across the local z axis
    const Solid& s = named(solids, m["of"].get<std::string>());
    const double factor = s.shape == Shape::Box ? 4.0 : kPi;
    out["centre_mm"] = jsonOf(s.centre_mm);
    out["normal"] = jsonOf(s.patientFromLocal[2]);
    out["value"] = twelveDigits(factor * s.size_mm.x * s.size_mm.y);
    out["unit"] = "mm2";
  } else if (kind == "volume") {
    const Solid& s = named(solids, m["of"].get<std::string>());
    const double factor = s.shape == Shape::Box        ? 8.0
                          : s.shape == Shape::Cylinder ? 2.0 * kPi
                                                       : 4.0 / 3.0 * kPi;
    out["value"] = twelveDigits(factor * s.size_mm.x * s.size_mm.y * s.size_mm.z);
    out["unit"] = "mm3";
  } else {
    throw std::invalid_argument("recipe: unknown measure " + kind);
  }
  return out;
}

// The voxel of a series whose centre is nearest to a point, with its exact stored value.
Json probe(const Json& p, const StudyPlan& study, const SeriesPlan& series,
           const std::vector<const Field*>& fields, const std::vector<Solid>& solids) {
  const glm::dvec3 wanted =
      p.contains("of") ? named(solids, p["of"].get<std::string>()).centre_mm : vecOf(p["at_mm"]);
  const SlicePlan* best = nullptr;
  double bestDistance = std::numeric_limits<double>::max();
  for (const SlicePlan& s : series.slices) {
    const glm::dvec3 normal = glm::cross(s.rowDirection, s.columnDirection);
    const double d = std::fabs(glm::dot(wanted - s.origin_mm, normal));
    if (d < bestDistance) {
      bestDistance = d;
      best = &s;
    }
  }
  const glm::dvec3 q = wanted - best->origin_mm;
  const auto index = [](double mm, double spacing_mm, std::int64_t count) {
    const double i = std::floor(mm / spacing_mm + 0.5);
    return std::clamp<std::int64_t>(static_cast<std::int64_t>(i), 0, count - 1);
  };
  const std::int64_t i = index(glm::dot(q, best->rowDirection), series.columnSpacing_mm, series.columns);
  const std::int64_t j = index(glm::dot(q, best->columnDirection), series.rowSpacing_mm, series.rows);
  const glm::dvec3 centre = best->origin_mm +
                            static_cast<double>(i) * series.columnSpacing_mm * best->rowDirection +
                            static_cast<double>(j) * series.rowSpacing_mm * best->columnDirection;
  const std::size_t channels = fields.size(),
                    at = static_cast<std::size_t>(j * series.columns + i) * channels;
  const std::vector<std::int32_t> stored = sampleChannels(fields, channels, series, *best, study.seed);
  Json place{{"name", p.at("name")},
             {"file", best->fileName},
             {"column", i},
             {"row", j},
             {"patient_mm", jsonOf(centre)}};
  if (channels > 1) {  // red, green, blue and alpha, which the DICOM files do not have
    place["stored"] =
        Json(std::vector<std::int32_t>(stored.begin() + static_cast<std::ptrdiff_t>(at),
                                       stored.begin() + static_cast<std::ptrdiff_t>(at + channels)));
    return place;
  }
  const std::int32_t value = stored[at];
  if (!series.palette.empty()) {
    place["stored"] = value;
    place["rgb"] = series.palette[static_cast<std::size_t>(value)];
    place["palette_bits"] = series.paletteBits;
    return place;
  }
  const Field& field = *fields.front();
  Json out{{"name", p.at("name")},
           {"file", best->fileName},
           {"column", i},
           {"row", j},
           {"patient_mm", jsonOf(centre)},
           {"stored", value},
           {"modality", slopeOf(series, *best) * value + series.intercept},
           {"modality_without_noise", best->factor * idealAt(field, centre) + best->valueOffset}};
  if (best->frame > 0) out["frame"] = best->frame;
  if (series.padding && *series.padding == value) out["padding"] = true;
  return out;
}

// What a picture of the slice shows at each of the probes under the presentation state: LINEAR window,
// inversion and shutter of PS3.3, in 0..1; and at which column and row of the frame as it is turned and
// flipped.
Json presentationAnswers(const PresentationPlan& p, const SeriesPlan& s, const Json& probes) {
  Json out{{"sop_instance_uid", p.sopUid},
           {"file", p.fileName},
           {"image_file", s.slices.at(p.slice).fileName},
           {"label", p.label},
           {"shown", Json::array()}};
  for (const Json& probe : probes) {
    if (probe.at("file") != s.slices.at(p.slice).fileName) continue;
    const std::int64_t column = probe.at("column"), row = probe.at("row");
    const double x = probe.at("modality"), y = (x - (p.center - 0.5)) / (p.width - 1) + 0.5;
    double grey = std::clamp(y, 0.0, 1.0);
    if (p.inverse) grey = 1 - grey;
    if (column + 1 < p.shutter[0] || column + 1 > p.shutter[1] || row + 1 < p.shutter[2] ||
        row + 1 > p.shutter[3])
      grey = p.shutterValue / 65535.0;
    std::int64_t across = column, down = row, width = s.columns, height = s.rows;
    for (int turned = 0; turned < p.rotation_deg; turned += 90) {
      const std::int64_t before = across;
      across = height - 1 - down;
      down = before;
      std::swap(width, height);
    }
    if (p.flip) across = width - 1 - across;
    out["shown"].push_back({{"name", probe.at("name")}, {"column", across}, {"row", down}, {"grey", grey}});
  }
  return out;
}

Json describe(const StudyPlan& study, const SeriesPlan& s, const Json& recipe,
              const std::vector<const Field*>& fields, const std::vector<Solid>& solids,
              const std::vector<SliceSums>& sums) {
  Json slices = Json::array();
  std::int64_t total = 0;
  int low = std::numeric_limits<int>::max(), high = std::numeric_limits<int>::min();
  for (std::size_t k = 0; k < s.slices.size(); ++k) {
    const SlicePlan& p = s.slices[k];
    const glm::dvec3 normal = glm::cross(p.rowDirection, p.columnDirection);
    slices.push_back({{"file", p.fileName},
                      {"sop_instance_uid", p.sopUid},
                      {"origin_mm", jsonOf(p.origin_mm)},
                      {"position_along_normal_mm", glm::dot(p.origin_mm, normal)},
                      {"stored_sum", sums[k].sum}});
    if (p.frame > 0) slices.back()["frame"] = p.frame;
    if (p.slope != 0) slices.back()["rescale_slope"] = p.slope;
    if (p.echoTime_ms > 0) slices.back()["echo_time_ms"] = p.echoTime_ms;
    if (p.bValue_s_mm2 >= 0) slices.back()["b_value_s_mm2"] = p.bValue_s_mm2;
    total += sums[k].sum;
    low = std::min(low, sums[k].low);
    high = std::max(high, sums[k].high);
  }
  Json probes = Json::array();
  for (const Json& p : recipe.value("probes", Json::array()))
    probes.push_back(probe(p, study, s, fields, solids));
  Json out{{"series_uid", s.seriesUid},
           {"description", s.description},
           {"modality", modalityOf(s.storage)},
           {"transfer_syntax", s.transferSyntaxUid},
           {"lossy", !s.lossyMethod.empty()},
           {"stored_bound", s.storedBound},
           {"columns", s.columns},
           {"rows", s.rows},
           {"pixel_spacing_row_col_mm", Json::array({s.rowSpacing_mm, s.columnSpacing_mm})},
           {"step_mm", s.step_mm},
           {"row_direction", jsonOf(s.slices.front().rowDirection)},
           {"column_direction", jsonOf(s.slices.front().columnDirection)},
           {"bits_stored", s.bitsStored},
           {"signed", s.isSigned},
           {"rescale_slope", s.slope},
           {"rescale_intercept", s.intercept},
           {"stored_min", low},
           {"stored_max", high},
           {"stored_sum", total},
           {"probes", probes},
           {"slices", slices}};
  if (s.samples > 1) out["samples"] = s.samples;
  if (study.presentation) out["presentation"] = presentationAnswers(*study.presentation, s, probes);
  return out;
}

}  // namespace

SliceSums sumsOf(const std::vector<std::int32_t>& stored) {
  SliceSums s{0, std::numeric_limits<int>::max(), std::numeric_limits<int>::min()};
  for (const std::int32_t v : stored) {
    s.sum += v;
    s.low = std::min(s.low, v);
    s.high = std::max(s.high, v);
  }
  return s;
}

Json answersOf(const Json& recipe, const std::string& variant, const StudyPlan& study,
               const std::vector<const Field*>& fields, const std::vector<Solid>& solids,
               const std::vector<std::vector<SliceSums>>& sums) {
  Json out{{"schema", "vernier-phantom-answers/1"},
           {"name", study.name},
           {"summary", recipe.at("summary")},
           {"settings", variant},
           {"seed", study.seed},
           {"study_uid", study.studyUid},
           {"frame_of_reference_uid", study.frameOfReferenceUid},
           {"findings", study.findings},
           {"source", recipe.contains("source") ? recipe["source"].at("kind")
                                                : recipe.at("channels").at(0).at("kind")}};
  if (recipe.contains("formula")) out["formula"] = recipe["formula"];
  Json measures = Json::array();
  for (const Json& m : recipe.value("measures", Json::array())) measures.push_back(measure(m, solids));
  out["measures"] = measures;
  out["series"] = Json::array();
  for (std::size_t n = 0; n < study.series.size(); ++n)
    out["series"].push_back(describe(study, study.series[n], recipe, fields, solids, sums[n]));
  return out;
}

}  // namespace vernier::phantoms
