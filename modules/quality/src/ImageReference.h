// SPDX-License-Identifier: GPL-3.0-or-later
// One image layer in double: a stored frame, fitted into the picture with the file's pixel aspect.
#pragma once
#include <memory>

#include "vernier/quality/Reference.h"

namespace vernier::quality {

class ImageReference {
 public:
  static Result<ImageReference> make(const Scene&, const ImageLayer&, const View&, const Sources&);

  // Column and row at a pixel; pixel centres of the frame at integers.
  glm::dvec2 frameAt(glm::dvec2 pixel) const;
  // The frame's outline in pixels, as its least and greatest corner.
  glm::dvec2 least() const, greatest() const;
  std::optional<double> value(glm::dvec2 pixel) const;  // modality; nullopt: outside or padding
  double grey(double modality) const;

 private:
  ImageReference() = default;
  std::shared_ptr<const ImageFrame> frame_;
  ImageLayer layer_;
  VoiWindow window_;
  glm::dvec2 centre_px_{0}, pxPerSample_{1};
};

}  // namespace vernier::quality
