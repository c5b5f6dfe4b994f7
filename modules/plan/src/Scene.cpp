// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/plan/Scene.h"

namespace vernier {
namespace {
std::string kind(const ImageLayer&) { return "image"; }
std::string kind(const SliceLayer&) { return "slice"; }
std::string kind(const CurvedLayer&) { return "curved"; }
std::string kind(const CustomLayer& layer) { return layer.kind; }
}  // namespace

std::string kindOf(const Layer& layer) {
  return std::visit([](const auto& l) { return kind(l); }, layer);
}

}  // namespace vernier
