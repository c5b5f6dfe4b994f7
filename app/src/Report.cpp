// SPDX-License-Identifier: GPL-3.0-or-later
#include "Report.h"

#include <sys/resource.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "Version.h"
#include "vernier/plan/SceneJson.h"

namespace vernier::app {
namespace {
using Json = nlohmann::ordered_json;

// Of what was drawn: an image of a volume file, a volume; or of the stack as it was found.
std::vector<Finding> findingsOf(const ReportInput& in, const std::shared_ptr<const Volume>& volume) {
  if (in.session->chosenVolumeFile())
    for (const Layer& layer : in.request->scene.layers)
      if (const auto* image = std::get_if<ImageLayer>(&layer))
        if (const auto frame = in.session->image(image->source, image->index))
          return (*frame)->info().findings;
  if (volume) return volume->info().findings;
  const Stack* const stack = in.session->chosenStack();
  return stack ? stack->findings : std::vector<Finding>{};
}

Json inputFacts(const ReportInput& in, const std::shared_ptr<const Volume>& volume) {
  Json j;
  if (const Series* s = in.session->chosenSeries()) j["series"] = s->seriesUid;
  if (volume) {
    const GridGeometry& g = volume->grid();
    const glm::dvec3 sp = g.spacing_mm();
    j["dims"] = {g.columns, g.rows, g.slices};
    j["spacing_mm"] = {sp.x, sp.y, sp.z};
    j["unit"] = volume->info().unit;
  }
  j["findings"] = Json::array();
  for (const Finding& f : findingsOf(in, volume))
    j["findings"].push_back({{"code", f.code}, {"sentence", f.sentence}});
  return j;
}

Json planFacts(const Plan& plan) {
  Json j;
  j["passes"] = Json::array();
  for (const Pass& p : plan.passes) {
    Json resources = Json::array();
    for (const Resource& r : p.resources) resources.push_back({{"name", r.name}, {"bytes", r.bytes}});
    j["passes"].push_back({{"name", p.name},
                           {"technique", p.technique},
                           {"engine", p.engine == Engine::Native ? "native" : "gl"},
                           {"resources", resources},
                           {"predicted_ms", p.predicted_ms},
                           {"predicted_error", p.predictedError},
                           {"parameters", p.params ? p.params->dump() : ""}});
  }
  j["rejected"] = Json::array();
  for (const Rejected& r : plan.rejected) j["rejected"].push_back({{"what", r.what}, {"why", r.why}});
  j["afterwards"] = plan.afterwards;
  j["notes"] = plan.notes;
  return j;
}

Json ladderFacts(const std::vector<quality::LadderRung>& rungs) {
  Json j = Json::array();
  for (const quality::LadderRung& r : rungs)
    j.push_back(
        {{"step", r.step}, {"bound", r.error.bound ? Json(*r.error.bound) : Json()}, {"rms", r.error.rms}});
  return j;
}

Json errorFacts(const quality::ErrorReport& e, const std::string& goalNote) {
  Json j = {{"unit", "level/255"},
            {"n", e.n},
            {"max", e.max},
            {"rms", e.rms},
            {"p50", e.p50},
            {"p99", e.p99},
            {"p95_inner", e.innerP95},
            {"bound", e.bound ? Json(*e.bound) : Json()},
            {"share", e.share},
            {"confidence", e.exhaustive ? 1.0 : e.confidence},
            {"exhaustive", e.exhaustive},
            {"population", e.population},
            {"population_share", e.populationShare},
            {"edge", {{"share", e.edge.share}, {"p99", e.edge.p99}, {"max", e.edge.max}}},
            {"quantisation", e.quantisation},
            {"kind", quality::nameOf(e.kind)},
            {"seed", e.seed}};
  if (e.values)
    j["values"] = {{"n", e.values->n},
                   {"max_val", e.values->max_val},
                   {"worst_of_bound", e.values->worstOfBound},
                   {"coverage_differs_inside", e.values->coverageDiffersInside}};
  if (!goalNote.empty()) j["goal"] = goalNote;
  return j;
}

}  // namespace

double median(std::vector<double> v) {
  if (v.empty()) return 0;
  std::sort(v.begin(), v.end());
  return v.size() % 2 ? v[v.size() / 2] : (v[v.size() / 2 - 1] + v[v.size() / 2]) / 2;
}

double peakRss_mb() {
  rusage u{};
  ::getrusage(RUSAGE_SELF, &u);
  return static_cast<double>(u.ru_maxrss) / 1024.0;
}

std::string reportJson(const ReportInput& in) {
  const Rendered& r = *in.rendered;
  const Counters& c = r.frame.images.counters;
  const std::shared_ptr<const Volume> volume = in.session->builtVolume();
  std::vector<double> ms = in.timing.frame_ms;
  std::sort(ms.begin(), ms.end());
  Json j;
  j["schema"] = "vernier-report/1";
  j["vernier"] = kVersion;
  j["purpose"] = "not for primary diagnosis";
  j["input"] = inputFacts(in, volume);
  j["scene"] = Json::parse(writeScene(in.request->scene));
  j["counters"] = {{"samples", c.samples}, {"cells", c.cells},         {"triangles", c.triangles},
                   {"passes", c.passes},   {"bytes", c.bytesUploaded}, {"textures_3d", c.textures3dCreated}};
  j["plan"] = planFacts(r.plan);
  j["engine"] = {{"name", r.frame.engine},
                 {"renderer", r.frame.renderer},
                 {"technique", r.frame.technique},
                 {"simd", in.session->capabilities(false).simd},
                 {"threads", in.session->threadCount()}};
  j["timing"] = {{"load_ms", in.timing.load_ms},
                 {"prepare_ms", r.frame.prepare_ms},
                 {"first_frame_ms", in.timing.first_frame_ms},
                 {"frame_ms",
                  {{"median", median(ms)},
                   {"min", ms.empty() ? 0 : ms.front()},
                   {"max", ms.empty() ? 0 : ms.back()},
                   {"n", ms.size()}}}};
  j["memory"] = {{"volume_mb", volume ? static_cast<double>(volume->bytes()) / 1048576.0 : 0.0},
                 {"derived_mb", static_cast<double>(in.session->derivedBytes()) / 1048576.0},
                 {"peak_rss_mb", peakRss_mb()}};
  j["error"] = r.error ? errorFacts(*r.error, r.goalNote) : Json();
  j["ladder"] = ladderFacts(r.rungs);
  j["image"] = {
      {"width", r.frame.images.width}, {"height", r.frame.images.height}, {"sha256", in.imageSha256}};
  return j.dump(2) + "\n";
}

}  // namespace vernier::app
