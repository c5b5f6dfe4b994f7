// SPDX-License-Identifier: GPL-3.0-or-later
#include "SourceFacts.h"

#include <filesystem>

namespace vernier::ui {
namespace {

std::string joined(std::initializer_list<std::string> parts) {
  std::string all;
  for (const std::string& p : parts) all += p + '\x1f';
  return all;
}

// As buildImageFrame places a frame of a multi-frame object: by the stack's fitted grid.
std::optional<FramePlane> planeOf(const Stack& stack, std::size_t k, const Instance& i) {
  if (i.pixels.framesDeclared <= 1 || stack.shape == StackShape::NoGeometry) return i.plane;
  const GridGeometry& g = stack.grid;
  const glm::dvec3 at = g.even() ? glm::dvec3(0, 0, static_cast<double>(k)) : g.sliceOrigin_vox[k];
  const glm::dmat3& m = g.patientFromVoxel.linear;
  return FramePlane{g.patientFromVoxel * VoxelPoint(at), normalize(PatientVec(m[0])),
                    normalize(PatientVec(m[1]))};
}

}  // namespace

std::string shownName(const std::string& name) {
  std::string shown;
  const std::string alphabetic = name.substr(0, name.find('='));
  for (const char c : alphabetic.empty() ? name : alphabetic) {
    if (c == '^' || c == '=') {
      if (!shown.empty() && shown.back() != ' ') shown += ", ";
    } else {
      shown += c;
    }
  }
  while (!shown.empty() && (shown.back() == ' ' || shown.back() == ',')) shown.pop_back();
  return shown;
}

SourceFacts factsOf(const app::Session& session, app::StackChoice choice, int document) {
  const StudySet& set = session.study();
  const Series& series = *session.seriesOf(choice);
  const Stack& stack = *session.stackOf(choice);
  SourceFacts f;
  f.id = {document, session.sourceName(choice)};
  f.title = series.description;
  if (!stack.label.empty()) f.title += (f.title.empty() ? "" : ", ") + stack.label;
  f.modality = series.modality;
  f.why2d = stack.why2d;
  if (stack.volume3d) f.grid = stack.grid;
  f.colour = isColour(set.instances[stack.slices.front().instance].pixels.colourSpace());
  for (std::size_t k = 0; k < stack.slices.size(); ++k) {
    const Instance& i = set.instances[stack.slices[k].instance];
    ImageFrameInfo info;
    info.columns = static_cast<std::int64_t>(i.pixels.columns);
    info.rows = static_cast<std::int64_t>(i.pixels.rows);
    info.pixelSpacing_mm = i.pixelSpacing_mm;
    info.plane = planeOf(stack, k, i);
    info.index = static_cast<std::int64_t>(k);
    info.count = static_cast<std::int64_t>(stack.slices.size());
    f.frames.push_back(std::move(info));
    f.files.push_back(std::filesystem::path(set.files[i.file].path).filename().string());
  }
  std::string id, issuer;
  if (const Patient* p = patientOf(set, stack)) {
    f.patient = shownName(p->name);
    f.personKey = joined({p->id, p->issuer, p->birthDate, p->sex, p->id.empty() ? p->name : ""});
    id = p->id, issuer = p->issuer;
    if (!id.empty()) f.idKey = joined({id, issuer});
  }
  const std::string& frame = set.instances[stack.slices.front().instance].frameOfReferenceUid;
  f.linkKey = frame.empty() ? joined({"source", std::to_string(document), f.id.name})
                            : joined({"frame", frame, id, issuer});
  return f;
}

SourceFacts factsOfVolumeFile(const app::Session& session, app::StackChoice choice, int document) {
  const VolumeFile& file = *session.volumeFileOf(choice);
  const VolumeInfo& info = file.facts->info;
  SourceFacts f;
  f.id = {document, session.sourceName(choice)};
  f.title = titleOf(session, file);
  f.modality = info.modality;
  f.grid = info.grid;
  f.isVolumeFile = true;
  f.colour = info.channels > 1;
  f.linkKey = joined({"source", std::to_string(document), f.id.name});  // it names no person
  return f;
}

std::string titleOf(const app::Session& session, const VolumeFile& file) {
  if (file.facts && !file.facts->info.title.empty()) return file.facts->info.title;
  return std::filesystem::path(session.study().files[file.file].path).filename().string();
}

std::optional<std::int64_t> nearestImage(const SourceFacts& f, PatientPoint p) {
  std::optional<std::int64_t> best;
  double closest = 0;
  for (const ImageFrameInfo& frame : f.frames) {
    if (!frame.plane) continue;
    const PatientVec n = cross(frame.plane->rowDirection, frame.plane->columnDirection);
    const double d = std::abs(dot(p - frame.plane->origin, n));
    if (!best || d < closest) closest = d, best = frame.index;
  }
  return best;
}

}  // namespace vernier::ui
