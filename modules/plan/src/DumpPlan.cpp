// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "Numbers.h"
#include "vernier/plan/Plan.h"

namespace vernier {
namespace {

std::string joined(const std::vector<std::string>& items) {
  std::string out;
  for (const std::string& item : items) out += (out.empty() ? "" : ", ") + item;
  return out.empty() ? "none" : out;
}

std::string dumpPass(const Pass& pass, std::size_t index) {
  std::string out = "pass " + std::to_string(index) + ": " + pass.name + "\n";
  const bool native = pass.engine == Engine::Native;
  out += std::string("  engine: ") + (native ? "native" : "gl") + "\n";
  out += "  technique: " + pass.technique + "\n";
  out += "  inputs: " + joined(pass.inputs) + "\n";
  out += "  outputs: " + joined(pass.outputs) + "\n";
  if (!native) {
    out +=
        "  gl state: blend " + pass.gl.blend + ", depth " + pass.gl.depth + ", cull " + pass.gl.cull + "\n";
    out += std::string("  filtering: ") + (pass.fixedFunctionFiltering ? "fixed-function" : "float") + "\n";
  }
  std::vector<std::string> resources;
  for (const Resource& r : pass.resources)
    resources.push_back(r.name + " " + std::to_string(r.bytes) + " bytes");
  out += "  resources: " + joined(resources) + "\n";
  out += "  predicted: " + rounded(pass.predicted_ms, 3) + " ms, error " + rounded(pass.predictedError, 2) +
         " of 255\n";
  if (pass.params) out += "  parameters: " + pass.params->dump() + "\n";
  return out;
}

}  // namespace

std::string dumpPlan(const Plan& plan) {
  double ms = 0, error = 0;
  std::uint64_t bytes = 0;
  for (const Pass& pass : plan.passes) {
    ms += pass.predicted_ms;
    error = std::max(error, pass.predictedError);
    for (const Resource& r : pass.resources) bytes += r.bytes;
  }
  std::string out = "plan: " + std::to_string(plan.passes.size()) +
                    (plan.passes.size() == 1 ? " pass" : " passes") + ", predicted " + rounded(ms, 3) +
                    " ms, error " + rounded(error, 2) + " of 255, " + std::to_string(bytes) + " bytes, " +
                    (plan.showsWholeScene ? "whole scene" : "not the whole scene") + "\n";
  for (std::size_t i = 0; i < plan.passes.size(); ++i) out += dumpPass(plan.passes[i], i);
  for (const Rejected& r : plan.rejected) out += "rejected: " + r.what + ": " + r.why + "\n";
  for (const std::string& what : plan.afterwards) out += "afterwards: " + what + "\n";
  for (const std::string& note : plan.notes) out += "note: " + note + "\n";
  return out;
}

}  // namespace vernier
