// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstdio>
#include <map>

#include "InfoJson.h"

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

// A terminal must not obey what a file says: control characters show as "?".
std::string safe(std::string s) {
  for (char& c : s)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  return s;
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
void addFindings(const std::vector<Finding>& findings, const std::string& indent, std::string& out) {
  for (const Finding& f : findings)
    out += indent + mark(f.severity) + " " + f.code + ": " + safe(f.sentence) + "\n";
}

std::string geometryText(const Stack& s) {
  switch (s.shape) {
    case StackShape::NoGeometry:
      return "no geometry";
    case StackShape::Single:
      return "one slice";
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
  const Instance& first = set.instances[s.slices.front().instance];
  out += "      stack  " + count(s.slices.size(), "slice") + " of " + std::to_string(first.pixels.columns) +
         "x" + std::to_string(first.pixels.rows) + ", ";
  if (first.pixelSpacing_mm.x > 0)
    out += "pixel " + number(first.pixelSpacing_mm.y, 4) + "x" + number(first.pixelSpacing_mm.x, 4) + " mm, ";
  out += geometryText(s) + ", unit " + first.unit;
  if (!s.label.empty()) out += "  [" + safe(s.label) + "]";
  out += s.volume3d ? "  3-D\n" : "  2-D only: " + s.why2d + "\n";
  addFindings(s.findings, "             ", out);
}

void addSeries(const StudySet& set, std::size_t index, std::string& out) {
  const Series& s = set.series[index];
  out += "    Series " + std::to_string(index + 1) + "  " + orDash(s.modality) + "  " +
         (s.number ? "#" + std::to_string(*s.number) + "  " : "") + safe(orDash(s.description)) + "  (" +
         count(s.instances.size(), "object") + ")\n";
  for (const Stack& stack : s.stacks) addStack(set, stack, out);
  std::map<std::string, std::size_t> others;
  for (const std::size_t i : s.instances)
    if (!set.instances[i].notShown.empty())
      ++others[set.instances[i].sopClassName + ", " + set.instances[i].notShown];
  for (const auto& [what, n] : others) out += "      " + std::to_string(n) + " x " + safe(what) + "\n";
  addFindings(s.findings, "      ", out);
}

}  // namespace

std::string infoText(const StudySet& set) {
  std::string out;
  for (const Patient& p : set.patients) {
    out += "Patient " + safe(orDash(p.name)) + "  id " + safe(orDash(p.id)) + "  born " +
           orDash(p.birthDate) + "  sex " + orDash(p.sex) + "\n";
    for (const std::size_t st : p.studies) {
      const Study& study = set.studies[st];
      out += "  Study " + orDash(study.date) + "  " + safe(orDash(study.description)) + "\n";
      for (const std::size_t s : study.series) addSeries(set, s, out);
    }
  }
  addFindings(set.findings, "", out);
  std::size_t notDicom = 0;
  for (const FileRecord& f : set.files) {
    if (f.kind == FileKind::NotDicom && set.files.size() > 1)
      ++notDicom;
    else if (f.error)
      out += "Failed " + safe(f.shown) + ": " + f.error->sentence + "\n";
  }
  out += count(set.files.size(), "file") + ": " + count(set.patients.size(), "patient") + ", " +
         std::to_string(set.studies.size()) + (set.studies.size() == 1 ? " study, " : " studies, ") +
         count(set.series.size(), "series") + ", " + count(set.instances.size(), "object");
  if (notDicom > 0) out += "; " + count(notDicom, "file") + " not DICOM";
  return out + "\n";
}

}  // namespace vernier
