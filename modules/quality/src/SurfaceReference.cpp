// SPDX-License-Identifier: GPL-3.0-or-later
// S. Woop, C. Benthin, I. Wald, Watertight ray/triangle intersection (2013), in double and with a rule for
// exact zeros.
#include "SurfaceReference.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vernier::quality {
namespace {

constexpr std::size_t kLeaf = 4;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
// The definition of RENDERING's surfaces, written again here: shares of the headlight, and what counts as one
// place.
constexpr double kAmbientShare = 0.2, kDiffuseShare = 0.8, kOnePlace = 1e-9;

struct Target {
  glm::dvec3 centre{0};
  double diagonal = 0;
};

// The box of all placed surfaces together.
Target boxOf(const std::vector<const SurfaceLayer*>& layers, const Sources& sources) {
  glm::dvec3 low(kInfinity), high(-kInfinity);
  for (const SurfaceLayer* layer : layers) {
    const Mesh& mesh = *sources.meshes.at(layer->source);
    const glm::dvec3 ends[2] = {mesh.lowest().p, mesh.highest().p};
    for (int n = 0; n < 8; ++n) {
      const glm::dvec3 corner(ends[n & 1].x, ends[n >> 1 & 1].y, ends[n >> 2].z);
      const glm::dvec3 p = layer->pose.linear * corner + layer->pose.translation;
      low = glm::min(low, p), high = glm::max(high, p);
    }
  }
  return {0.5 * (low + high), glm::length(high - low)};
}

bool onePlace(double a, double b) { return std::abs(a - b) <= kOnePlace * std::min(a, b); }

}  // namespace

double shareOfHeadlight(double cosine) { return std::min(1.0, kAmbientShare + kDiffuseShare * cosine); }

Result<SurfaceReference> SurfaceReference::make(const Scene& scene, const View& view, const Sources& sources,
                                                const RayCamera* given) {
  std::vector<const SurfaceLayer*> layers;
  for (const Layer& layer : scene.layers)
    if (const auto* surface = std::get_if<SurfaceLayer>(&layer)) {
      if (!sources.meshes.contains(surface->source))
        return makeError(ErrorCode::SceneInvalid,
                         "The surface '" + surface->source + "' of a layer is not among the sources.");
      layers.push_back(surface);
    }
  SurfaceReference out;
  if (given) {
    out.camera_ = *given;
  } else {
    const Target box = boxOf(layers, sources);
    const auto camera = RayCamera::make(scene.camera, view, box.centre, box.diagonal);
    if (!camera) return camera.error();
    out.camera_ = *camera;
  }
  const RayCamera& camera = out.camera_;
  for (std::size_t n = 0; n < layers.size(); ++n) {
    const SurfaceLayer& layer = *layers[n];
    out.layers_.push_back({{layer.colour.r, layer.colour.g, layer.colour.b}, layer.opacity});
    if (!(layer.opacity > 0)) continue;
    const Mesh& mesh = *sources.meshes.at(layer.source);
    std::vector<glm::dvec3> seen;
    for (const MeshPoint& p : mesh.vertices()) {
      const glm::dvec3 q = layer.pose.linear * p.p + layer.pose.translation - camera.eye;
      seen.emplace_back(glm::dot(q, camera.right), glm::dot(q, camera.down), glm::dot(q, camera.forward));
    }
    for (std::size_t t = 0; t < mesh.triangles().size(); ++t) {
      const Triangle& k = mesh.triangles()[t];
      out.triangles_.push_back({{seen[k[0]], seen[k[1]], seen[k[2]]}, n, t});
    }
  }
  if (!out.triangles_.empty()) out.build(0, out.triangles_.size());
  return out;
}

void SurfaceReference::build(std::size_t begin, std::size_t end) {
  Node node{glm::dvec3(kInfinity), glm::dvec3(-kInfinity), begin, end, 0};
  glm::dvec3 low(kInfinity), high(-kInfinity);  // of the middles
  for (std::size_t i = begin; i < end; ++i) {
    glm::dvec3 middle(0);
    for (const glm::dvec3& p : triangles_[i].p) {
      node.low = glm::min(node.low, p), node.high = glm::max(node.high, p);
      middle += p;
    }
    low = glm::min(low, middle), high = glm::max(high, middle);
  }
  const std::size_t at = nodes_.size();
  nodes_.push_back(node);
  if (end - begin <= kLeaf) return;
  const glm::dvec3 size = high - low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::size_t half = begin + (end - begin) / 2;
  const auto place = [axis](const Placed& t) { return t.p[0][axis] + t.p[1][axis] + t.p[2][axis]; };
  const auto first = triangles_.begin();
  std::nth_element(first + static_cast<std::ptrdiff_t>(begin), first + static_cast<std::ptrdiff_t>(half),
                   first + static_cast<std::ptrdiff_t>(end),
                   [&](const Placed& x, const Placed& y) { return place(x) < place(y); });
  build(begin, half);
  nodes_[at].right = nodes_.size();
  build(half, end);
}

SurfaceReference::Ray SurfaceReference::rayOf(glm::dvec2 pixel) const {
  const glm::dvec2 across = (pixel - camera_.middle) * camera_.step;
  if (camera_.perspective) return {glm::dvec3(0), glm::dvec3(across, 1)};
  return {glm::dvec3(across, 0), glm::dvec3(0, 0, 1)};
}

// Corners relative to the ray: x right of it, y below it, both at the corner's own depth. An edge function of
// two corners is exactly the negative of that of the neighbour's.
bool SurfaceReference::meets(const Ray& ray, const Placed& t, SurfaceHit& hit) const {
  glm::dvec3 p[3];
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 q = t.p[static_cast<std::size_t>(i)] - ray.origin;
    p[i] = {q.x - ray.direction.x * q.z, q.y - ray.direction.y * q.z, q.z};
  }
  double edge[3];
  bool positive[3];
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 &b = p[(i + 1) % 3], &c = p[(i + 2) % 3];
    edge[i] = b.x * c.y - b.y * c.x;
    // What the edge function becomes when the pixel moves right, else down: corners move left, or up, by
    // their depth.
    const double bw = camera_.perspective ? b.z : 1, cw = camera_.perspective ? c.z : 1;
    const double right = b.y * cw - bw * c.y, below = bw * c.x - b.x * cw;
    positive[i] = edge[i] > 0 || (edge[i] == 0 && (right > 0 || (right == 0 && below > 0)));
  }
  if (positive[0] != positive[1] || positive[0] != positive[2]) return false;
  const double sum = edge[0] + edge[1] + edge[2];
  if (sum == 0) return false;
  double z = (edge[0] * p[0].z + edge[1] * p[1].z + edge[2] * p[2].z) / sum;
  z = std::clamp(z, std::min({p[0].z, p[1].z, p[2].z}), std::max({p[0].z, p[1].z, p[2].z}));
  if (!(z >= camera_.near_mm)) return false;
  const double perDepth = glm::length(ray.direction);
  const glm::dvec3 normal = glm::cross(t.p[1] - t.p[0], t.p[2] - t.p[0]);
  const double size = glm::length(normal);
  hit = {z * perDepth, t.layer, t.triangle,
         size > 0 ? std::abs(glm::dot(normal, ray.direction)) / (size * perDepth) : 0};
  return true;
}

std::vector<SurfaceHit> SurfaceReference::hits(glm::dvec2 pixel) const {
  std::vector<SurfaceHit> found;
  if (nodes_.empty()) return found;
  const Ray ray = rayOf(pixel);
  // A ray runs through a box where its three intervals of depth overlap; a little room, since bounds are
  // rounded.
  const auto passes = [&](const Node& node) {
    double from = 0, to = kInfinity;
    for (int axis = 0; axis < 3; ++axis) {
      const double room =
          1e-9 * (std::abs(node.low[axis]) + std::abs(node.high[axis]) + std::abs(ray.origin[axis]));
      const double low = node.low[axis] - room - ray.origin[axis],
                   high = node.high[axis] + room - ray.origin[axis];
      const double d = ray.direction[axis];
      if (d == 0) {
        if (low > 0 || high < 0) return false;
        continue;
      }
      from = std::max(from, std::min(low / d, high / d));
      to = std::min(to, std::max(low / d, high / d));
    }
    return from <= to * (1 + 1e-9) + 1e-9;
  };
  std::vector<std::size_t> waiting{0};
  while (!waiting.empty()) {
    const std::size_t at = waiting.back();
    waiting.pop_back();
    const Node& node = nodes_[at];
    if (!passes(node)) continue;
    if (node.right != 0) {
      waiting.push_back(node.right);
      waiting.push_back(at + 1);
      continue;
    }
    SurfaceHit hit;
    for (std::size_t i = node.begin; i < node.end; ++i)
      if (meets(ray, triangles_[i], hit)) found.push_back(hit);
  }
  std::sort(found.begin(), found.end(), [](const SurfaceHit& x, const SurfaceHit& y) {
    return std::tie(x.t_mm, x.layer, x.triangle) < std::tie(y.t_mm, y.layer, y.triangle);
  });
  for (std::size_t i = 1; i < found.size(); ++i)
    for (std::size_t k = i;
         k > 0 && onePlace(found[k - 1].t_mm, found[k].t_mm) && found[k - 1].layer < found[k].layer; --k)
      std::swap(found[k - 1], found[k]);
  return found;
}

SurfaceReference::Look SurfaceReference::lookOf(const SurfaceHit& hit) const {
  const Look& look = layers_[hit.layer];
  return {shareOfHeadlight(hit.cosine) * look.colour, look.opacity};
}

SurfaceReference::Seen SurfaceReference::seen(glm::dvec2 pixel, glm::dvec3 background) const {
  Seen out;
  out.depth_mm = kInfinity;
  double through = 1;
  for (const SurfaceHit& hit : hits(pixel)) {
    const Look look = lookOf(hit);
    out.covered = true;
    out.colour += through * look.opacity * look.colour;
    through *= 1 - look.opacity;
    if (look.opacity < 1) continue;
    out.depth_mm = hit.t_mm;
    return out;
  }
  out.colour += through * background;
  return out;
}

bool SurfaceReference::corners(std::size_t triangle, std::array<glm::dvec2, 3>& px) const {
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3& p = triangles_[triangle].p[i];
    const double depth = camera_.perspective ? p.z : 1;
    if (!(p.z > 0)) return false;
    px[i] = glm::dvec2(p) / (depth * camera_.step) + camera_.middle;
  }
  return true;
}

}  // namespace vernier::quality
