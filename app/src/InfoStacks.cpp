// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "InfoParts.h"

namespace vernier {
namespace {
using vernier::toJson;  // beside those below

const char* nameOf(StackShape s) {
  switch (s) {
    case StackShape::NoGeometry:
      return "no geometry";
    case StackShape::Single:
      return "single";
    case StackShape::Uniform:
      return "uniform";
    case StackShape::Sheared:
      return "sheared";
    case StackShape::Uneven:
      return "uneven";
  }
  return "";
}
Json rangeOf(const std::vector<double>& v) {
  if (v.empty()) return nullptr;
  return {{"min", *std::min_element(v.begin(), v.end())}, {"max", *std::max_element(v.begin(), v.end())}};
}

double medianOf(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  const std::size_t n = v.size();
  return n % 2 ? v[n / 2] : 0.5 * (v[n / 2 - 1] + v[n / 2]);
}

// Where a slice lies; empty frames of a segmentation have no place of their own.
glm::dvec3 originOf(const StudySet& set, const Stack& s, std::size_t k) {
  const Instance& i = set.instances[s.slices[k].instance];
  if (s.slices[k].frame != SliceRef::kEmptyFrame) return i.frame(s.slices[k].frame).plane->origin.p;
  const GridGeometry& g = s.grid;
  return (g.patientFromVoxel *
          VoxelPoint(g.even() ? glm::dvec3(0, 0, static_cast<double>(k)) : g.sliceOrigin_vox[k]))
      .p;
}

// The file of a slice, with the number of its frame where the file has several.
std::string nameOf(const StudySet& set, SliceRef r) {
  const Instance& i = set.instances[r.instance];
  const std::string& file = set.files[i.file].shown;
  if (r.frame == SliceRef::kEmptyFrame) return file + "#empty";
  return i.framesDeclared > 1 ? file + "#" + std::to_string(r.frame + 1) : file;
}

// Steps between neighbouring slices: along the normal, straight, and the angle between both.
void addSteps(const StudySet& set, const Stack& s, Json& j) {
  std::vector<double> along, straight, shear;
  for (std::size_t k = 1; k < s.positions_mm.size(); ++k) {
    along.push_back(s.positions_mm[k] - s.positions_mm[k - 1]);
    straight.push_back(glm::length(originOf(set, s, k) - originOf(set, s, k - 1)));
    const double side =
        std::sqrt(std::max(0.0, straight.back() * straight.back() - along.back() * along.back()));
    shear.push_back(std::atan2(side, along.back()) * 180 / 3.14159265358979323846);
  }
  if (along.empty()) return;
  j["step_mm"] = rangeOf(along);
  j["step_mm"]["median"] = medianOf(along);
  j["distance_between_origins_mm"] = rangeOf(straight);
  j["distance_between_origins_mm"]["median"] = medianOf(straight);
  j["shear_between_neighbours_deg"] = rangeOf(shear);
}

Json stackJson(const StudySet& set, const Stack& s) {
  const Instance& object = set.instances[s.slices.front().instance];
  const FrameAttributes& first = object.frame(s.slices.front().frame);
  Json j{{"label", s.label}, {"shape", nameOf(s.shape)}, {"slices", s.slices.size()}};
  j["rows"] = object.pixels.rows;
  j["columns"] = object.pixels.columns;
  j["pixel_spacing_row_col_mm"] = {first.pixelSpacing_mm.x, first.pixelSpacing_mm.y};
  if (first.echoTime_ms) j["echo_time_ms"] = *first.echoTime_ms;
  j["volume_3d"] = s.volume3d;
  if (!s.why2d.empty()) j["why_2d"] = s.why2d;
  Json files = Json::array();
  for (const SliceRef& r : s.slices) files.push_back(nameOf(set, r));
  j["order"] = std::move(files);
  if (!s.positions_mm.empty()) {
    j["positions_along_normal_mm"] = s.positions_mm;
    addSteps(set, s, j);
    j["shear_deg"] = s.shear_deg;
    j["max_deviation_of_origins_mm"] = s.deviation_mm;
    j["max_deviation_along_normal_mm"] = s.deviationAlongNormal_mm;
    j["first_origin_lps_mm"] = toJson(originOf(set, s, 0));
    j["last_origin_lps_mm"] = toJson(originOf(set, s, s.slices.size() - 1));
    j["row_direction_lps"] = toJson(first.plane->rowDirection.v);
    j["column_direction_lps"] = toJson(first.plane->columnDirection.v);
  }
  if (s.shape != StackShape::NoGeometry) {
    j["patient_from_voxel"] = toJson(s.grid.patientFromVoxel);
    j["gap_after_slice"] = s.grid.gapAfter;
    j["true_positions_kept"] = !s.grid.even();
  }
  j["orientation_fixed"] = s.orientationFixed;
  j["findings"] = toJson(s.findings);
  return j;
}

}  // namespace

Json seriesJson(const StudySet& set, const Series& s) {
  std::size_t images = 0, frames = 0;
  Json files = Json::array();
  for (const std::size_t i : s.instances) {
    const Instance& o = set.instances[i];
    images += o.isImage;
    if (o.isImage) frames += o.framesDeclared;
    files.push_back(set.files[o.file].shown);
  }
  Json j{{"series_uid", s.seriesUid}, {"study_uid", s.studyUid}, {"modality", s.modality}};
  if (s.number) j["number"] = *s.number;
  j["description"] = s.description;
  j["objects"] = s.instances.size();
  j["images"] = images;
  j["frames"] = frames;
  j["files"] = std::move(files);
  j["stacks"] = Json::array();
  for (const Stack& stack : s.stacks) j["stacks"].push_back(stackJson(set, stack));
  j["findings"] = toJson(s.findings);
  return j;
}

}  // namespace vernier
