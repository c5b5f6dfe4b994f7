// SPDX-License-Identifier: GPL-3.0-or-later
// What differs between two stacks, slice by slice.
#include <algorithm>
#include <cstdio>
#include <iostream>

#include "Compare.h"
#include "OptionText.h"
#include "vernier/measure/CompareVolumes.h"

namespace vernier::app {
namespace {
using Json = nlohmann::ordered_json;

const Patient* patientOf(const Session& session, StackChoice choice) {
  if (choice.volumeFile) return nullptr;  // volume files name no patient
  return vernier::patientOf(session.study(), *session.stackOf(choice));
}

struct Input {
  std::unique_ptr<Session> session;
  StackChoice choice;
  std::shared_ptr<const Volume> volume;
};

Result<Input> open(const GlobalOptions& global, const std::string& path, const std::string& series) {
  Input in;
  in.session = makeSession(global);
  if (!in.session) return makeError(ErrorCode::OptionInvalid, "The settings cannot be used.");
  if (const Result<void> r = in.session->open({path}, terminalProgress(global), interruptToken()); !r)
    return r.error();
  const Result<StackChoice> choice = in.session->choose(series);
  if (!choice) return choice.error();
  in.choice = *choice;
  in.session->use(*choice);
  return in;
}

// Where B is laid on A, and by whose word.
struct Place {
  PatientVec offset_mm;
  std::string by;
};
Result<Place> placeOf(const CompareOptions& o, const Volume& a, const Volume& b) {
  if (!o.offset.empty()) {
    const Result<glm::dvec3> v = vec3("--offset", "It", split(o.offset, ','));
    if (!v) return invalid("--offset", "'" + o.offset + "' is no shift; give x,y,z in mm, such as 0,0,2.5.");
    return Place{PatientVec(*v), "manual"};
  }
  const std::string& frame = a.info().frameOfReferenceUid;
  if (frame.empty() || frame != b.info().frameOfReferenceUid)
    return makeError(
        ErrorCode::OptionInvalid,
        "The stacks have no frame of reference in common, so nothing says how they lie on each other; "
        "give --offset x,y,z (mm from A to B; 0,0,0 as they stand).",
        "--offset");
  return Place{PatientVec(), "frame of reference"};
}

Json voxelFacts(const measure::VoxelDifference& d) {
  return {{"compared", d.compared}, {"unmatched", d.unmatched}, {"max", d.max},
          {"mean", d.mean},         {"rmse", d.rmse},           {"bias", d.bias}};
}

Json figures(const measure::VolumeDifference& d, const Place& place) {
  const glm::dvec3 v = place.offset_mm.v;
  Json j = {{"schema", "vernier-compare/1"},
            {"what", "stacks"},
            {"unit", d.unit},
            {"alignment", {{"by", place.by}, {"offset_mm", {v.x, v.y, v.z}}}},
            {"resampled", d.resampled}};
  j.update(voxelFacts(d.all));
  j["worst_slice"] = d.worstSlice;
  j["slices"] = Json::array();
  for (const measure::VoxelDifference& s : d.slices) j["slices"].push_back(voxelFacts(s));
  return j;
}

void print(const measure::VolumeDifference& d, const Place& place) {
  std::printf("B on A by %s%s; B - A in %s%s\n", place.by.c_str(), place.by == "manual" ? " offset" : "",
              d.unit.c_str(), d.resampled ? ", B interpolated" : ", voxel against voxel");
  std::printf("%6s %12s %12s %12s %12s %10s %10s\n", "slice", "mean B-A", "mean |B-A|", "RMSE", "max",
              "compared", "one only");
  const auto line = [](const std::string& name, const measure::VoxelDifference& v) {
    std::printf("%6s %12.6g %12.6g %12.6g %12.6g %10llu %10llu\n", name.c_str(), v.bias, v.mean, v.rmse,
                v.max, static_cast<unsigned long long>(v.compared),
                static_cast<unsigned long long>(v.unmatched));
  };
  for (std::size_t s = 0; s < d.slices.size(); ++s) line(std::to_string(s), d.slices[s]);
  line("all", d.all);
}

}  // namespace

Result<void> samePatient(const Session& a, StackChoice ca, const Session& b, StackChoice cb) {
  const Patient *p = patientOf(a, ca), *q = patientOf(b, cb);
  if (!p || !q) return {};
  if (p->id != q->id || p->issuer != q->issuer)
    return makeError(
        ErrorCode::OptionInvalid,
        "The two inputs are of different patients (their Patient IDs differ), so no difference is "
        "made; check which studies were meant.");
  if (p->birthDate != q->birthDate || p->sex != q->sex)
    return makeError(ErrorCode::OptionInvalid,
                     "The two inputs have one Patient ID but another birth date or sex, so they may be of "
                     "different patients and no difference is made; check which studies were meant.");
  return {};
}

int compareStacks(const GlobalOptions& global, const CompareOptions& o) {
  if (!o.heatmap.empty() || !o.mode.empty() || o.align)
    return report(invalid(!o.heatmap.empty() ? "--heatmap"
                          : o.align          ? "--align"
                                             : "--mode",
                          "It goes with two pictures; draw the stacks with `vernier render` first."));
  Result<Input> a = open(global, o.a, o.seriesA);
  if (!a) return report(a.error());
  Result<Input> b = open(global, o.b, o.seriesB);
  if (!b) return report(b.error());
  if (const Result<void> same = samePatient(*a->session, a->choice, *b->session, b->choice); !same)
    return report(same.error());
  for (Input* in : {&*a, &*b}) {
    const auto volume = in->session->volume("", terminalProgress(global), interruptToken());
    if (!volume) return report(volume.error());
    in->volume = *volume;
  }
  const Result<Place> place = placeOf(o, *a->volume, *b->volume);
  if (!place) return report(place.error());
  const Result<measure::VolumeDifference> d =
      measure::compareVolumes(*a->volume, *b->volume, place->offset_mm);
  if (!d) return report(d.error());
  if (o.json)
    std::cout << figures(*d, *place).dump(2) << "\n";
  else
    print(*d, *place);
  if (o.maxError && d->all.compared == 0)
    return report(makeError(ErrorCode::OutOfTolerance,
                            "The stacks have no voxel in common; nothing was compared.", "--max-error"));
  if (o.maxError && !d->resampled && d->all.unmatched > 0)
    return report(makeError(ErrorCode::OutOfTolerance,
                            std::to_string(d->all.unmatched) + " voxels have data in one of the stacks only.",
                            "--max-error"));
  return judgeMaxError(o, d->all.max, d->unit);
}

}  // namespace vernier::app
