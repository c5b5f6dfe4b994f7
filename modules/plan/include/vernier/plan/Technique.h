// SPDX-License-Identifier: GPL-3.0-or-later
// What a technique registers, and the host that a plugin registers with. A technique is one way of drawing
// some kinds of layers on one engine; it never asks who else is there.
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "vernier/base/Cache.h"
#include "vernier/base/Result.h"
#include "vernier/plan/Panel.h"
#include "vernier/plan/Plan.h"
#include "vernier/plan/Scene.h"
#include "vernier/volume/ImageFrame.h"
#include "vernier/volume/Mesh.h"
#include "vernier/volume/Volume.h"

namespace vernier::gpu {
class Device;
}

namespace vernier {

// The data that a scene's layers name. The session fills in what the scene needs before planning.
struct Sources {
  std::map<std::string, std::shared_ptr<const Volume>> volumes;
  std::map<std::pair<std::string, std::int64_t>, std::shared_ptr<const ImageFrame>> images;
  std::map<std::string, std::shared_ptr<const PresentationState>> presentations;  // by SOP Instance UID
  std::map<std::string, std::shared_ptr<const Mesh>> meshes;
};

// A triangle surface in its place.
struct PlacedSurface {
  std::shared_ptr<const Mesh> mesh;
  PatientFromMesh pose;
  glm::dvec3 colour{1};  // display-referred 0..1
  double opacity = 1;
};

// Costs measured on this machine, by technique; without an entry a technique uses its built-in figure.
struct CostTable {
  std::map<std::string, double> nsPerSample;
};

struct PlanContext {
  const Scene& scene;
  const View& view;
  const Quality& quality;
  const Capabilities& capabilities;
  const CostTable& costs;
  const Sources& sources;
  // The tools that stand among a layer that looks through a volume (projection, shells): its technique draws
  // them too. Empty in all other pictures, and where no technique draws surfaces.
  std::vector<PlacedSurface> tools = {};
  // The lenses that meet what is shown, in the scene's order; appearance n of RayIntervals.h is the n-th from
  // 1. For techniques that draw slices with lenses, and for those of kind "lens".
  std::vector<PlacedLens> lenses = {};
  // For techniques of kind "lens": how the outside and each lens gather, and whether the lens shows anything.
  struct Appearance {
    Accumulator accumulator = Accumulator::Ordered;
    bool empty = false;
  };
  std::vector<Appearance> appearances = {};
  // For techniques of kind "lens": one pass of another technique draws all appearances together.
  bool together = false;
};

// What a layer shows at a point of the picture (pixels, centres at half-integers), in double, over what lies
// below it: display-referred RGBA. Called from many threads at once.
using PixelTruth = std::function<glm::dvec4(glm::dvec2 pixel, glm::dvec4 under)>;

struct Technique {
  std::string name;                // "mpr.native", "mpr.strips", "mpr.polygon", "image.native"
  std::vector<std::string> kinds;  // layer kinds that it draws
  Engine engine = Engine::Native;
  // The passes that draw the layer, with resources, predicted ms and error. An Error says why it cannot here;
  // its sentence stands in Plan::rejected. Pure.
  std::function<Result<std::vector<Pass>>(const Layer&, std::size_t layerIndex, const PlanContext&)>
      passesFor;
  // Draws one pass into `images`, adding to its counters. Runs on the render thread; checks the stop token
  // per tile.
  std::function<Result<void>(const Pass&, Images&, std::stop_token)> execute;
  // It can draw parts of rays (RayIntervals.h), whole appearances of a picture with lenses: its one pass of
  // a layer obeys Pass::rays.
  bool drawsParts = false;
  // Of passes of this technique that draw the outside (the first) and what each lens shows (null: nothing),
  // one that draws them together, RaysOfPass::Together; nullopt where there is none. Absent: never. Pure.
  std::function<std::optional<Pass>(std::span<const Pass* const>)> together;
  // Slices: passesFor looks at PlanContext::lenses and draws them.
  bool drawsLenses = false;
  // Of kind "lens" only: the lens's faces in the patient. passesFor then gives two passes, which cut the rays
  // of the picture and join their parts; where appearances are drawn together one, which finds
  // RayIntervals::lenses. SceneInvalid for a shape without volume, with the reason. Pure.
  std::function<Result<std::shared_ptr<const ConvexRegion>>(const LensLayer&, const Sources&)> region;
  // For layers of a plugin's own kinds, which module quality does not know: the truth that the picture's
  // error is measured against. Absent: a picture with such a layer carries no error, and says so. Pure.
  std::function<Result<PixelTruth>(const Layer&, std::size_t layerIndex, const PlanContext&)> truth;
};

// What a plugin sees of the program. addTechnique refuses a duplicate name. Registration is transactional:
// when register() fails, nothing of the plugin stays.
class VERNIER_API Host {
 public:
  virtual ~Host() = default;
  virtual Result<void> addTechnique(Technique) = 0;
  // A panel for a layer kind of the plugin's own (Panel.h); refused when checkPanel does or when the kind has
  // one. A host without panels takes it and forgets it.
  virtual Result<void> addPanel(Panel);
  // The GL device of the render thread, made on first use; GlUnavailable with the reason when there is none.
  // To be called inside execute() only.
  virtual Result<gpu::Device*> glDevice() = 0;
  // Where techniques keep what they derive from volumes (bricks, meshes), for as long as the host lives.
  // Thread-safe. A host without a cache of its own has a small one here.
  virtual DerivedCache& derivedData();

 private:
  DerivedCache own_{256ull << 20};
};

class VERNIER_API TechniqueRegistry {
 public:
  Result<void> add(Technique);
  const Technique* find(const std::string& name) const;
  const std::vector<Technique>& all() const { return techniques_; }
  std::vector<const Technique*> drawing(const std::string& kind) const;

 private:
  std::vector<Technique> techniques_;
};

}  // namespace vernier
