// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstdio>
#include <map>
#include <set>

#include "InfoJson.h"
#include "InfoParts.h"

namespace vernier {
namespace {

std::string number(double v, int digits = 3) {
  char text[48];
  std::snprintf(text, sizeof text, "%.*f", digits, v);
  std::string s = text;
  while (s.find('.') != std::string::npos && (s.back() == '0' || s.back() == '.')) {
    const bool point = s.back() == '.';
    s.pop_back();
    if (point) break;
  }
  return s == "-0" ? "0" : s;
}
std::string count(std::size_t n, const std::string& what) {
  return std::to_string(n) + " " + what + (n == 1 || what == "series" ? "" : "s");
}
std::string orDash(const std::string& s) { return s.empty() ? "-" : s; }

// A terminal must not obey what a file says: control characters show as "?", those of UTF-8's second block
// (C2 80 to C2 9F) too.
std::string safe(std::string s) {
  for (std::size_t i = 0; i < s.size(); ++i) {
    const auto c = static_cast<unsigned char>(s[i]);
    if (c < 0x20 || c == 0x7f) s[i] = '?';
    if (c == 0xC2 && i + 1 < s.size() && static_cast<unsigned char>(s[i + 1]) < 0xA0) s.replace(i, 2, "?");
  }
  return s;
}

// 20150206 as 2015-02-06; what is no DICOM date stays as it is.
std::string date(const std::string& s) {
  const bool digits = s.size() == 8 && s.find_first_not_of("0123456789") == std::string::npos;
  return digits ? s.substr(0, 4) + "-" + s.substr(4, 2) + "-" + s.substr(6) : safe(orDash(s));
}

const char* mark(Severity s) {
  switch (s) {
    case Severity::Info:
      return "info   ";
    case Severity::Notice:
      return "notice ";
    case Severity::Warning:
      return "WARNING";
    case Severity::Refusal:
      return "REFUSED";
  }
  return "";
}
// Up to three of the files that a finding is about.
std::string filesOf(const Finding& f) {
  const auto at = f.numbers.find("files");
  const auto* files = at == f.numbers.end() ? nullptr : std::get_if<std::vector<std::string>>(&at->second);
  if (!files || files->empty()) return "";
  std::string out;
  for (std::size_t n = 0; n < std::min<std::size_t>(3, files->size()); ++n)
    out += (n ? ", " : "") + safe((*files)[n]);
  if (files->size() > 3) out += " and " + std::to_string(files->size() - 3) + " more";
  return " (" + out + ")";
}

// Equal lines once, with how often; files are named where something is wrong with them.
void addFindings(const std::vector<Finding>& findings, const std::string& indent, std::string& out) {
  std::vector<std::pair<std::string, std::size_t>> lines;
  for (const Finding& f : findings) {
    const bool wrong = f.severity == Severity::Warning || f.severity == Severity::Refusal;
    std::string line =
        indent + mark(f.severity) + " " + f.code + ": " + safe(f.sentence) + (wrong ? filesOf(f) : "");
    const auto same =
        std::find_if(lines.begin(), lines.end(), [&](const auto& l) { return l.first == line; });
    if (same == lines.end())
      lines.emplace_back(std::move(line), 1);
    else
      ++same->second;
  }
  for (const auto& [line, times] : lines)
    out += line + (times > 1 ? " (" + std::to_string(times) + " times)" : "") + "\n";
}

std::string geometryText(const Stack& s) {
  switch (s.shape) {
    case StackShape::NoGeometry:
      return "no geometry";
    case StackShape::Single:
      return "";  // the number of slices says it
    case StackShape::Uniform:
      return "step " + number(s.step_mm) + " mm";
    case StackShape::Sheared:
      return "step " + number(s.step_mm) + " mm, tilt " + number(s.shear_deg, 1) + " degrees";
    case StackShape::Uneven:
      return "median step " + number(s.step_mm) + " mm, " +
             (s.grid.gapAfter.empty() ? "uneven" : count(s.grid.gapAfter.size(), "gap"));
  }
  return "";
}

void addStack(const StudySet& set, const Stack& s, std::string& out) {
  const Instance& object = set.instances[s.slices.front().instance];
  const FrameAttributes& first = object.frame(s.slices.front().frame);
  out += "      stack  " + count(s.slices.size(), "slice") + " of " + std::to_string(object.pixels.columns) +
         "x" + std::to_string(object.pixels.rows) + ", ";
  if (first.pixelSpacing_mm.x > 0)
    out += "pixel " + number(first.pixelSpacing_mm.y, 4) + "x" + number(first.pixelSpacing_mm.x, 4) + " mm, ";
  const std::string geometry = geometryText(s);
  out += geometry + (geometry.empty() ? "unit " : ", unit ") + safe(first.unit);
  if (!s.label.empty()) out += "  [" + safe(s.label) + "]";
  out += s.volume3d ? "  3-D\n" : "  2-D only: " + s.why2d + "\n";
  addFindings(s.findings, "             ", out);
}

void addSegments(const Instance& i, std::string& out) {
  for (const Segment& s : i.segments) {
    out += "      segment " + std::to_string(s.number) + "  " + safe(orDash(s.label));
    if (!s.type.empty()) out += ", " + safe(s.type);
    if (s.colour) {
      char colour[16];
      const auto level = [&](std::size_t c) { return static_cast<unsigned>((*s.colour)[c] * 255 + 0.5); };
      std::snprintf(colour, sizeof colour, "#%02x%02x%02x", level(0), level(1), level(2));
      out += std::string(", colour ") + colour;
    }
    out += "\n";
  }
}

void addSeries(const StudySet& set, std::size_t index, std::string& out) {
  const Series& s = set.series[index];
  out += "    Series " + std::to_string(index + 1) + "  " + orDash(s.modality) + "  " +
         (s.number ? "#" + std::to_string(*s.number) + "  " : "") + safe(orDash(s.description)) + "  (" +
         count(s.instances.size(), "object") + ")\n";
  for (const Stack& stack : s.stacks) addStack(set, stack, out);
  for (const std::size_t i : s.instances) addSegments(set.instances[i], out);
  std::map<std::string, std::size_t> others;
  for (const std::size_t i : s.instances)
    if (!set.instances[i].notShown.empty())
      ++others[set.instances[i].sopClassName + ", " + set.instances[i].notShown];
  for (const auto& [what, n] : others) out += "      " + std::to_string(n) + " x " + safe(what) + "\n";
  addFindings(s.findings, "      ", out);
}

void addPresentations(const StudySet& set, std::string& out) {
  std::set<std::string_view> images;
  if (!set.presentations.empty())
    for (const Instance& i : set.instances)
      if (i.isImage) images.insert(i.sopInstanceUid);
  for (std::size_t n = 0; n < set.presentations.size(); ++n) {
    const PresentationState& p = set.presentations[n];
    std::size_t present = 0;
    for (const ReferencedImage& r : p.images) present += images.count(r.sopInstanceUid);
    out += "Presentation " + std::to_string(n + 1) + "  " + safe(orDash(p.label)) + "  " +
           safe(orDash(p.description)) + "  for " + count(p.images.size(), "image") + ", " +
           std::to_string(present) + " of them here\n";
    if (!p.whyNot.empty()) out += "    " + p.whyNot + "\n";
    for (const std::string& what : p.notApplied) out += "    not applied: " + what + "\n";
  }
}

void addSurface(const SurfaceRecord& s, std::string& out) {
  if (s.error) {
    out += "Failed " + safe(s.shown) + ": " + safe(s.error->sentence) + "\n";
    return;
  }
  const glm::dvec3 size = s.facts.extent_mm.v;
  out += "Surface " + safe(s.shown) + "  " + s.file.format + ", " +
         count(s.file.triangles - s.file.dropped.zeroArea - s.file.dropped.notFinite, "triangle") + ", " +
         number(size.x) + " x " + number(size.y) + " x " + number(size.z) + " mm, area " +
         number(s.facts.area_mm2, 1) + " mm2, " +
         (s.facts.closed ? "closed, volume " + number(s.facts.signedVolume_mm3, 1) + " mm3" : "not closed") +
         "\n";
  addFindings(s.file.findings, "  ", out);
}

// "int16"; "uint8 red, green, blue and alpha".
std::string voxelKind(const VolumeFileFacts& f) {
  if (f.info.channels == 1) return f.storedType;
  return f.storedType + (f.info.channels == 3 ? " red, green and blue" : " red, green, blue and alpha");
}

// Numbered after the series, as --series takes them.
void addVolumeFile(const StudySet& set, const VolumeFile& v, std::size_t index, std::string& out) {
  out += "Volume file " + std::to_string(index + 1) + "  " + safe(set.files[v.file].shown);
  if (!v.facts) {
    out += "\n";
    return;
  }
  const VolumeInfo& i = v.facts->info;
  const glm::dvec3 s = i.grid.spacing_mm();
  out += "  " + v.facts->format + "\n  " + std::to_string(i.grid.columns) + "x" +
         std::to_string(i.grid.rows) + "x" + std::to_string(i.grid.slices) + " voxels of " +
         voxelKind(*v.facts) + ", " + number(s.x, 4) + "x" + number(s.y, 4) + "x" + number(s.z, 4) + " mm";
  if (i.channels == 1) out += ", unit " + safe(i.unit);
  if (v.facts->frames > 1) out += ", " + count(static_cast<std::size_t>(v.facts->frames), "frame");
  out += "\n";
  addFindings(i.findings, "         ", out);
}

}  // namespace

std::string infoText(const StudySet& set, const std::vector<VolumeFile>& volumes,
                     const std::vector<SurfaceRecord>& surfaces) {
  std::string out;
  std::set<std::size_t> shown;  // a damaged study may stand under several patients
  for (const Patient& p : set.patients) {
    out += "Patient " + safe(orDash(p.name)) + "  id " + safe(orDash(p.id)) + "  born " + date(p.birthDate) +
           "  sex " + orDash(p.sex) + "\n";
    for (const std::size_t st : p.studies) {
      const Study& study = set.studies[st];
      const bool again = !shown.insert(st).second;
      out += "  Study " + date(study.date) + "  " + safe(orDash(study.description)) +
             (again ? "  (the same study as above)" : "") + "\n";
      if (again) continue;
      for (const std::size_t s : study.series) addSeries(set, s, out);
    }
  }
  addPresentations(set, out);
  for (std::size_t v = 0; v < volumes.size(); ++v) addVolumeFile(set, volumes[v], set.series.size() + v, out);
  for (const SurfaceRecord& s : surfaces) addSurface(s, out);
  addFindings(set.findings, "", out);
  std::size_t directories = 0, noObject = 0, notDicom = 0;
  for (const FileRecord& f : set.files) {
    if (surfaceNamed(surfaces, f.shown)) continue;
    directories += f.kind == FileKind::DicomDir;
    noObject += f.kind == FileKind::NoSopClass || f.kind == FileKind::Unreadable;
    notDicom += f.kind == FileKind::NotDicom;
    if (f.error && (f.kind != FileKind::NotDicom || set.files.size() == 1))
      out += "Failed " + safe(f.shown) + ": " + safe(f.error->sentence) + "\n";
  }
  // The objects and what follows the semicolons add up to the number of files.
  out += count(set.files.size(), "file") + ": " + count(patientIds(set), "patient") +
         (patientIds(set) < set.patients.size()
              ? " (" + std::to_string(set.patients.size()) + " by birth date and sex), "
              : ", ") +
         std::to_string(set.studies.size()) + (set.studies.size() == 1 ? " study, " : " studies, ") +
         count(set.series.size(), "series") + ", " + count(set.instances.size(), "object");
  if (!volumes.empty()) out += "; " + count(volumes.size(), "volume file");
  if (!surfaces.empty()) out += "; " + count(surfaces.size(), "surface");
  if (directories > 0) out += "; " + count(directories, "DICOMDIR");
  if (noObject > 0) out += "; " + count(noObject, "file") + " without a readable object";
  if (notDicom > 0) out += "; " + count(notDicom, "file") + " not DICOM";
  return out + "\n";
}

}  // namespace vernier
