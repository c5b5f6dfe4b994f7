// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/volume/IsoSurface.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <charconv>
#include <cmath>
#include <mutex>
#include <numeric>

#include "../VtkSymbol.h"
#include "IsoField.h"
#include "VtkIso.h"
#include "vernier/base/Threads.h"
#include "vernier/base/Trace.h"

namespace vernier {
namespace {

constexpr int kSlab = 16;   // layers of cells that one task looks at
constexpr int kBlock = 16;  // voxels on a side of a block of triangles

using iso::IsoField;
using iso::VtkIsoSurface;

// What the cache keeps.
struct IsoMesh {
  std::shared_ptr<const Mesh> mesh;  // nullptr: no triangle
};

Error cancelled() { return makeError(ErrorCode::Cancelled, "Making the surfaces was cancelled."); }

std::string keyOf(double level) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, level);
  return std::string(text, end.ptr);
}

// One level as it comes out of the slabs.
struct Pieces {
  std::vector<VtkIsoSurface> slabs;
};

// Which block of voxels a triangle belongs to, by its first corner.
std::uint64_t blockOf(const float* xyz) {
  const auto n = [](float v) { return static_cast<std::uint64_t>(v) / kBlock; };
  return n(xyz[0]) | n(xyz[1]) << 20 | n(xyz[2]) << 40;
}

// Slabs are cut between blocks' layers, so a slab's triangles only have to be sorted among themselves.
Result<IsoMesh> assemble(const IsoField& field, Pieces& pieces, bool mirrored, const std::stop_token& stop) {
  std::size_t triangles = 0;
  for (const VtkIsoSurface& s : pieces.slabs) triangles += s.corners.size() / 3;
  if (triangles == 0) return IsoMesh{};
  MeshBuilder builder;
  builder.reserve(triangles);
  for (VtkIsoSurface& slab : pieces.slabs) {
    if (stop.stop_requested()) return cancelled();
    const std::size_t n = slab.corners.size() / 3;
    std::vector<std::pair<std::uint64_t, std::uint32_t>> order(n);
    for (std::size_t t = 0; t < n; ++t)
      order[t] = {blockOf(slab.xyz.data() + 3 * std::size_t{slab.corners[3 * t]}),
                  static_cast<std::uint32_t>(t)};
    std::sort(order.begin(), order.end());
    std::vector<std::uint32_t> named(slab.xyz.size() / 3, MeshBuilder::kNotFinite);
    const auto vertex = [&](std::uint32_t v) {
      if (named[v] == MeshBuilder::kNotFinite) {
        const float* const p = slab.xyz.data() + 3 * std::size_t{v};
        named[v] = builder.vertex(field.place(p[0], p[1], p[2]).p);
      }
      return named[v];
    };
    for (const auto& [block, t] : order) {
      const std::uint32_t* const c = slab.corners.data() + 3 * std::size_t{t};
      const std::uint32_t a = vertex(c[0]), b = vertex(c[1]), d = vertex(c[2]);
      mirrored ? builder.triangle(a, d, b) : builder.triangle(a, b, d);
    }
    slab = {};
  }
  if (builder.given() == builder.dropped().zeroArea + builder.dropped().notFinite) return IsoMesh{};
  Result<std::shared_ptr<const Mesh>> mesh = builder.finish();
  if (!mesh) return mesh.error();
  return IsoMesh{*mesh};
}

class Extraction {
 public:
  Extraction(const Volume& volume, iso::VtkIsoFn* vtk, std::stop_token stop, const ProgressFn& progress)
      : volume_(volume), field_(volume), vtk_(vtk), stop_(std::move(stop)), progress_(progress) {}

  Result<std::vector<IsoMesh>> run(std::span<const double> levels) {
    const int cells = field_.layers() - 1, slabs = (cells + kSlab - 1) / kSlab;
    std::vector<Pieces> pieces(levels.size());
    for (Pieces& p : pieces) p.slabs.resize(static_cast<std::size_t>(slabs));
    total_ = static_cast<std::uint64_t>(slabs) + levels.size();
    parallelFor(static_cast<std::size_t>(slabs), 1, [&](std::size_t begin, std::size_t end) {
      IsoField::Block block;
      for (std::size_t slab = begin; slab < end && !stop_.stop_requested(); ++slab) {
        cutSlab(static_cast<int>(slab), levels, block, pieces);
        report();
      }
    });
    if (stop_.stop_requested()) return cancelled();
    if (failed_) return makeError(ErrorCode::Internal, "VTK gave a surface that is not of triangles.");
    std::vector<IsoMesh> out(levels.size());
    std::vector<Result<void>> done(levels.size());
    const bool mirrored = glm::determinant(volume_.grid().patientFromVoxel.linear) < 0;
    parallelFor(levels.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        Result<IsoMesh> mesh = assemble(field_, pieces[i], mirrored, stop_);
        if (mesh)
          out[i] = std::move(*mesh);
        else
          done[i] = mesh.error();
        report();
      }
    });
    for (const Result<void>& r : done)
      if (!r) return r.error();
    return out;
  }

 private:
  void cutSlab(int slab, std::span<const double> levels, IsoField::Block& block,
               std::vector<Pieces>& pieces) {
    const int first = slab * kSlab, count = std::min(kSlab + 1, field_.layers() - first);
    field_.fill(first, count, block);
    const iso::VtkBlock vtkBlock{block.values.data(), field_.columns(), field_.rows(), count, first};
    for (std::size_t i = 0; i < levels.size() && !stop_.stop_requested(); ++i) {
      const float level = iso::asField(levels[i]);
      // Where all voxels are inside there is still the border of the volume, and what has no data.
      if (block.least > block.most || level > block.most) continue;
      if (!vtk_(vtkBlock, level, &pieces[i].slabs[static_cast<std::size_t>(slab)])) failed_ = true;
    }
  }
  void report() {
    if (!progress_) return;
    const std::lock_guard lock(reporting_);
    progress_("surfaces", ++done_, total_);
  }

  const Volume& volume_;
  const IsoField field_;
  iso::VtkIsoFn* const vtk_;
  const std::stop_token stop_;
  const ProgressFn& progress_;
  std::mutex reporting_;
  std::uint64_t done_ = 0, total_ = 0;
  std::atomic<bool> failed_ = false;
};

DerivedCache::Key cacheKey(const Volume& volume, double level) {
  return {"iso-surface", volume.revision(), keyOf(level)};
}

}  // namespace

Result<IsoSurfaces> isoSurfaces(const Volume& volume, std::span<const double> levels, DerivedCache& cache,
                                std::stop_token stop, const ProgressFn& progress) {
  const TraceSpan span("iso-surfaces");
  if (volume.isColour())
    return makeError(ErrorCode::GeometryRefused,
                     "A colour volume has no single value whose surfaces could be shown.");
  auto* const vtk = reinterpret_cast<iso::VtkIsoFn*>(vtkSymbol(iso::kVtkIsoName));
  if (!vtk)
    return makeError(ErrorCode::FormatUnknown,
                     "Surfaces of a volume need VTK's libraries, which are not here; install Debian's "
                     "libvtk9.1, or take a view that needs no surfaces.");
  // Which are missing is found by asking for each with a maker that only says so.
  IsoSurfaces out;
  out.meshes.resize(levels.size());
  std::vector<std::size_t> missing;
  const Error notThere = makeError(ErrorCode::NothingToLoad, "not made yet");
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const auto kept = cache.get<IsoMesh>(cacheKey(volume, levels[i]),
                                         [&]() -> Result<DerivedCache::Made<IsoMesh>> { return notThere; });
    if (kept)
      out.meshes[i] = (*kept)->mesh;
    else
      missing.push_back(i);
  }
  if (missing.empty()) return out;
  std::vector<double> wanted;
  for (const std::size_t i : missing) wanted.push_back(levels[i]);
  Result<std::vector<IsoMesh>> made = Extraction(volume, vtk, stop, progress).run(wanted);
  if (!made) return made.error();
  for (std::size_t n = 0; n < missing.size(); ++n) {
    IsoMesh& mesh = (*made)[n];
    out.meshes[missing[n]] = mesh.mesh;
    const std::uint64_t bytes = sizeof(IsoMesh) + (mesh.mesh ? mesh.mesh->bytes() : 0);
    (void)cache.get<IsoMesh>(cacheKey(volume, wanted[n]), [&]() -> Result<DerivedCache::Made<IsoMesh>> {
      return DerivedCache::Made<IsoMesh>{std::make_shared<IsoMesh>(mesh), bytes};
    });
  }
  out.extracted = missing.size();
  return out;
}

std::uint64_t isoWorkingBytes(const GridGeometry& g, int threads) {
  const auto layer = static_cast<std::uint64_t>((g.columns + 2) * (g.rows + 2));
  // A slab of floats, and a byte per edge with a few numbers per row of VTK's own.
  return static_cast<std::uint64_t>(std::max(1, threads)) * (kSlab + 1) * (5 * layer + 48 * (g.rows + 2));
}

std::vector<std::uint64_t> estimateIsoTriangles(const Volume& volume, std::span<const double> levels) {
  // Each level between two neighbours along a row is one vertex on an edge of that direction; a surface has
  // about as many on the others, and twice as many triangles as vertices.
  constexpr std::int64_t kEvery = 4;
  const GridGeometry& g = volume.grid();
  std::vector<std::int64_t> change(levels.size() + 1, 0);
  const auto rank = [&](std::int64_t i, std::int64_t j, std::int64_t k) -> std::ptrdiff_t {
    if (i < 0 || i >= g.columns || volume.isNoData(volume.stored(i, j, k))) return 0;
    return std::upper_bound(levels.begin(), levels.end(), volume.modality(i, j, k)) - levels.begin();
  };
  for (std::int64_t k = 0; k < g.slices; k += kEvery)
    for (std::int64_t j = 0; j < g.rows; j += kEvery) {
      std::ptrdiff_t before = 0;
      for (std::int64_t i = 0; i <= g.columns; ++i) {
        const std::ptrdiff_t here = rank(i, j, k);
        if (here != before) {
          ++change[static_cast<std::size_t>(std::min(here, before))];
          --change[static_cast<std::size_t>(std::max(here, before))];
        }
        before = here;
      }
    }
  std::vector<std::uint64_t> out(levels.size());
  std::int64_t crossings = 0;
  const auto rows = [](std::int64_t n) { return (n + kEvery - 1) / kEvery; };
  const double each =
      static_cast<double>(g.rows * g.slices) / static_cast<double>(rows(g.rows) * rows(g.slices));
  for (std::size_t i = 0; i < levels.size(); ++i) {
    crossings += change[i];
    out[i] = static_cast<std::uint64_t>(static_cast<double>(crossings) * each * 6);
  }
  return out;
}

}  // namespace vernier
