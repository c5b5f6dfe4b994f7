// SPDX-License-Identifier: GPL-3.0-or-later
#include "InfoSurfaces.h"

#include <algorithm>

namespace vernier {
namespace {

SurfaceRecord recordOf(const FileRecord& f, MemoryBudget* budget, const std::stop_token& stop) {
  SurfaceRecord record;
  record.shown = f.shown;
  Result<SurfaceFile> file = readSurface(f.path, {budget}, stop);
  if (!file) {
    record.error = file.error();
    return record;
  }
  record.file = std::move(*file);
  const std::shared_ptr<const Mesh> mesh = std::exchange(record.file.mesh, nullptr);
  record.facts = meshFacts(*mesh);
  record.lowest = mesh->lowest(), record.highest = mesh->highest();
  record.vertices = mesh->vertices().size();
  for (Finding& finding : surfaceFindings(*mesh, record.facts))
    record.file.findings.push_back(std::move(finding));
  return record;
}

}  // namespace

std::vector<SurfaceRecord> surfacesOf(const StudySet& set, MemoryBudget* budget, std::stop_token stop) {
  std::vector<SurfaceRecord> records;
  for (const FileRecord& f : set.files)
    if (f.kind == FileKind::NotDicom && looksLikeSurface(f.path) && !stop.stop_requested())
      records.push_back(recordOf(f, budget, stop));
  return records;
}

const SurfaceRecord* surfaceNamed(const std::vector<SurfaceRecord>& records, const std::string& shown) {
  const auto it =
      std::find_if(records.begin(), records.end(), [&](const SurfaceRecord& r) { return r.shown == shown; });
  return it == records.end() ? nullptr : &*it;
}

}  // namespace vernier
