// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/volume/SurfaceFile.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "Readers.h"
#include "vernier/base/Guarded.h"
#include "vernier/base/Trace.h"
#include "vernier/study/Limits.h"

namespace vernier {
namespace {

using Reader = Result<void> (*)(std::string_view, surface::Polygons&, SurfaceFile&);

Reader readerFor(const std::string& path) {
  std::string ext = std::filesystem::path(path).extension().string();
  for (char& c : ext) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c + 32 : c);
  struct Row {
    const char* extension;
    Reader reader;
  };
  constexpr Row rows[] = {{".stl", surface::readStl},        {".ply", surface::readPly},
                          {".obj", surface::readObj},        {".vtp", surface::readVtp},
                          {".wrl", surface::readSceneGraph}, {".vrml", surface::readSceneGraph},
                          {".iv", surface::readSceneGraph}};
  for (const Row& r : rows)
    if (ext == r.extension) return r.reader;
  return nullptr;
}

std::string nameOnly(const std::string& path) { return std::filesystem::path(path).filename().string(); }

// The file's descriptor and bytes, closed at the end.
struct Open {
  int fd = -1;
  std::uint64_t bytes = 0;
  ~Open() {
    if (fd >= 0) ::close(fd);
  }
};

Result<void> openRegular(const std::string& path, Open& file) {
  file.fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // a pipe must not block us
  struct stat s {};
  if (file.fd < 0 || ::fstat(file.fd, &s) != 0)
    return makeError(ErrorCode::FileNotFound, "The file does not exist or cannot be read.");
  if (!S_ISREG(s.st_mode))
    return makeError(ErrorCode::NotAFile,
                     "This is not a regular file; name a surface file such as tool.stl.");
  file.bytes = static_cast<std::uint64_t>(s.st_size);
  if (file.bytes > limits::kMaxSurfaceFileBytes)
    return makeError(ErrorCode::LimitExceeded, "A surface file of more than " +
                                                   std::to_string(limits::kMaxSurfaceFileBytes >> 30) +
                                                   " GiB is not read; make it coarser first.");
  if (file.bytes == 0) return makeError(ErrorCode::FileDamaged, "The file is empty; fetch it again.");
  return {};
}

Result<std::string> readWhole(const Open& file) {
  std::string bytes(static_cast<std::size_t>(file.bytes), '\0');
  for (std::size_t at = 0; at < bytes.size();) {
    const ssize_t got = ::pread(file.fd, bytes.data() + at, bytes.size() - at, static_cast<off_t>(at));
    if (got <= 0) return makeError(ErrorCode::FileDamaged, "The file could not be read to its end.");
    at += static_cast<std::size_t>(got);
  }
  return bytes;
}

std::string lengthText(double mm) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", mm);
  return text;
}

std::string sizeText(const Mesh& mesh) {
  const glm::dvec3 size = mesh.highest().p - mesh.lowest().p;
  return lengthText(size.x) + " x " + lengthText(size.y) + " x " + lengthText(size.z) + " mm";
}

std::string counted(std::uint64_t n, const std::string& what) {
  return std::to_string(n) + " " + what + (n == 1 ? "" : "s");
}

void describe(SurfaceFile& file) {
  const glm::dvec3 size = file.mesh->highest().p - file.mesh->lowest().p;
  file.findings.push_back(
      {"unit-assumed",
       Severity::Info,
       "The file says no unit; mm is assumed, so the surface is " + sizeText(*file.mesh) + ".",
       {{"extent_mm", std::vector<double>{size.x, size.y, size.z}}}});
  const auto& [notFinite, zeroArea] = file.dropped;
  if (notFinite + zeroArea > 0)
    file.findings.push_back(
        {"triangles-dropped",
         Severity::Notice,
         counted(notFinite + zeroArea, "triangle") + " of " + std::to_string(file.triangles) +
             " left out: " + std::to_string(zeroArea) + " without area, " + std::to_string(notFinite) +
             " with a corner that is not finite.",
         {{"zero_area", static_cast<double>(zeroArea)}, {"not_finite", static_cast<double>(notFinite)}}});
}

Result<SurfaceFile> readWith(Reader reader, const std::string& path, const SurfaceOptions& options,
                             const std::stop_token& stop) {
  const TraceSpan span("read surface");
  Open open;
  if (Result<void> ok = openRegular(path, open); !ok) return ok.error();
  MemoryBudget::Reservation reservation;
  if (options.budget) {
    // The bytes themselves, and a mesh with the tables it is made with: at most as much again in binary
    // files.
    Result<MemoryBudget::Reservation> r = options.budget->reserve(3 * open.bytes, "the surface");
    if (!r) return r.error();
    reservation = std::move(r).value();
  }
  const Result<std::string> bytes = readWhole(open);
  if (!bytes) return bytes.error();
  SurfaceFile file;
  file.bytes = open.bytes;
  MeshBuilder builder;
  surface::Polygons polygons(builder, stop);
  if (Result<void> ok = reader(*bytes, polygons, file); !ok) return ok.error();
  file.dropped = builder.dropped();
  file.triangles = builder.given();
  Result<std::shared_ptr<const Mesh>> mesh = builder.finish();
  if (!mesh) return mesh.error();
  file.mesh = std::move(*mesh);
  describe(file);
  return file;
}

}  // namespace

bool looksLikeSurface(const std::string& path) { return readerFor(path) != nullptr; }

Result<SurfaceFile> readSurface(const std::string& path, const SurfaceOptions& options,
                                std::stop_token stop) {
  const Reader reader = readerFor(path);
  if (!reader)
    return makeError(
        ErrorCode::FormatUnknown,
        "No surface format has this file name; there are .stl .ply .obj .vtp .wrl .vrml and .iv.",
        nameOnly(path));
  Result<SurfaceFile> file = guarded(nameOnly(path), [&] { return readWith(reader, path, options, stop); });
  if (!file) return makeError(file.error().code, file.error().sentence, nameOnly(path));
  return file;
}

std::vector<Finding> surfaceFindings(const Mesh& mesh, const MeshFacts& facts) {
  std::vector<Finding> out;
  const auto add = [&](const char* code, Severity severity, std::string sentence,
                       std::map<std::string, FindingValue> numbers) {
    out.push_back({code, severity, std::move(sentence), std::move(numbers)});
  };
  const double longest = std::max({facts.extent_mm.v.x, facts.extent_mm.v.y, facts.extent_mm.v.z});
  if (longest > 2000 || longest < 0.1)
    add("size-unlikely", Severity::Warning,
        "The surface is " + sizeText(mesh) +
            " when its numbers are mm, which fits no tool or patient; if they are of another unit, scale it "
            "in the pose.",
        {{"longest_mm", longest}});
  if (facts.duplicateTriangles > 0)
    add("duplicate-triangles", Severity::Notice,
        counted(facts.duplicateTriangles, "triangle") +
            " repeated; where the surface is translucent each counts again.",
        {{"count", static_cast<double>(facts.duplicateTriangles)}});
  if (facts.edgesUsedOverTwice > 0)
    add("not-manifold", Severity::Notice,
        counted(facts.edgesUsedOverTwice, "edge") + " used by more than two triangles; no volume is given.",
        {{"edges", static_cast<double>(facts.edgesUsedOverTwice)}});
  if (facts.edgesUsedOnce > 0)
    add("open-surface", Severity::Info,
        counted(facts.edgesUsedOnce, "edge") +
            " used by one triangle only: the surface is open and has no inside.",
        {{"edges", static_cast<double>(facts.edgesUsedOnce)}});
  if (facts.edgesUsedOverTwice == 0 && facts.directedEdgesUsedTwice > 0)
    add("mixed-orientation", Severity::Notice,
        counted(facts.directedEdgesUsedTwice, "edge") + " where neighbours are turned against each other.",
        {{"edges", static_cast<double>(facts.directedEdgesUsedTwice)}});
  if (facts.closed && facts.signedVolume_mm3 < 0)
    add("inside-out", Severity::Notice, "The surface is closed, but its triangles face inwards.",
        {{"signed_volume_mm3", facts.signedVolume_mm3}});
  return out;
}

}  // namespace vernier
