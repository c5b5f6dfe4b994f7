// SPDX-License-Identifier: GPL-3.0-or-later
// What all techniques that draw shells share: the layer made ready for drawing, and the meshes.
#pragma once
#include <atomic>

#include "vernier/base/Cache.h"
#include "vernier/native/Shells.h"
#include "vernier/plan/Technique.h"

namespace vernier::angiography {

// Levels, meshes and estimates, kept from picture to picture in the host's cache. One for all techniques of
// the plugin.
struct ShellStore {
  explicit ShellStore(Host& h) : host(h) {}
  DerivedCache& cache() { return host.derivedData(); }
  Host& host;
  std::atomic<std::uint64_t> extracted = 0;  // levels, since the store was made
};

struct ShellParams final : PassParams {
  native::ShellsJob job;                    // without meshes: they are made when the pass is drawn
  std::uint64_t triangles = 0, levels = 0;  // an estimate of the shells' triangles; levels with disabled ones
  std::uint64_t working_bytes = 0;          // while levels are extracted
  std::string dump() const override;
};

// SceneInvalid, GeometryRefused with the sentence; OutOfMemory with the bytes when the store cannot hold the
// meshes.
Result<std::shared_ptr<const ShellParams>> shellParams(const Layer&, std::size_t index, const PlanContext&,
                                                       ShellStore&);
// The job with its meshes, of enabled levels only.
Result<native::ShellsJob> withMeshes(const ShellParams&, ShellStore&, std::stop_token);

// One pass with what is alike for all techniques; its time is the technique's to predict.
Pass shellPass(const std::shared_ptr<const ShellParams>&, std::size_t index);

}  // namespace vernier::angiography
