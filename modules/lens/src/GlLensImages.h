// SPDX-License-Identifier: GPL-3.0-or-later
// The images of a lens on GL (Ropinski, Steinicke, Hinrichs 2005, sections 3 and 4): for each pixel where its
// ray enters and leaves the volume's box, the closed body (lens and box), and where the regions behind and
// beside, inside and in front of the lens begin and end.
//
// Bodies are half-spaces to the shader, which takes their faces one after the other: so each image is closed
// with the eye in the lens or in the volume too, and an edge of the lens loses no pixel. The paper draws
// meshes and compares depths; the images are the same. They hold positions in mm from a point on the view's
// axis (the paper's texture coordinates are one affine map away), to some 1e-4 mm, and alpha 0 where a region
// is empty; RGBA, row 0 on top.
//
// Render thread. The stop token is read once per band of rows. Errors: Cancelled, those of the device.
#pragma once
#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "vernier/base/ConvexRegion.h"
#include "vernier/gpu/Device.h"
#include "vernier/native/LensRays.h"

namespace vernier::lens {

struct LensImages {
  std::vector<float> boxFront, boxBack;
  std::vector<float> transition0;  // where region 0, behind or beside the lens, begins
  std::vector<float> transition1;  // where region 2, before the lens, ends
  std::vector<float> lensFront, lensBack;
};

inline constexpr std::size_t kMostGlFacets = 8192;

class GlLensImages {
 public:
  // `region`: keptRegion(), at most kMostGlFacets half-spaces.
  static Result<GlLensImages> make(gpu::Device&, const CameraPicture&, const std::vector<HalfSpace>& region,
                                   std::stop_token);
  // Of one lens; the box's images only where they are asked for.
  Result<LensImages> draw(const ConvexRegion& lens, bool withBox = false);
  // mm along the pixel's ray of a position in the images.
  double along_mm(int x, int y, const float* position) const;
  // From the images: where the lines of pixels enter and leave the lens. Where a lens reaches beyond the box
  // the line is endless: the box ends it, in double.
  native::LensSpans spans(const LensImages&) const;

 private:
  GlLensImages(gpu::Device& device, const CameraPicture& camera, std::stop_token stop)
      : device_(&device), camera_(camera), stop_(std::move(stop)) {}
  std::vector<gpu::Uniform> uniforms(std::size_t faces) const;
  Result<gpu::Texture> facesOf(const std::vector<HalfSpace>&);
  Result<void> drawBands(gpu::Draw&, const gpu::Target&, std::size_t faces, const std::optional<gpu::Rect>&);

  gpu::Device* device_;
  CameraPicture camera_;
  std::stop_token stop_;
  std::optional<gpu::VertexData> whole_;
  std::optional<gpu::Texture> boxFront_, boxBack_;
  std::vector<float> front_, back_;  // the box's images
};

}  // namespace vernier::lens
