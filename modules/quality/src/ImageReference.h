// SPDX-License-Identifier: GPL-3.0-or-later
// One image layer in double: a stored frame, fitted into the picture with the file's pixel aspect.
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "vernier/quality/Reference.h"

namespace vernier::quality {

class ImageReference {
 public:
  static Result<ImageReference> make(const Scene&, const ImageLayer&, const View&, const Sources&);

  // Column and row at a pixel; pixel centres of the frame at integers.
  glm::dvec2 frameAt(glm::dvec2 pixel) const;
  // The frame's outline in pixels, as its least and greatest corner.
  std::array<glm::dvec2, 2> outline() const;
  bool isColour() const { return frame_->isColour(); }
  std::optional<double> value(glm::dvec2 pixel) const;  // modality; nullopt: outside, padding or shuttered
  // What a shutter shows at a pixel that it covers.
  std::optional<double> shutterGrey(glm::dvec2 pixel) const;
  double grey(double modality) const;
  // What the picture shows, and its modality value where it has one; nullopt: nothing of the frame.
  std::optional<glm::dvec3> shown(glm::dvec2 pixel, double* valueOut) const;
  bool covers(glm::dvec2 pixel) const;

 private:
  ImageReference() = default;
  Result<void> takeVoi();
  Result<void> place(const Camera&, const View&);
  bool greyState() const;  // whether a presentation state has taken over the grey transformations
  std::optional<glm::dvec3> colour(glm::dvec2 pixel) const;  // of a colour frame
  // The frame's samples around a pixel and their weights; none outside.
  struct Corner {
    std::int64_t column = 0, row = 0;
    double weight = 0;
  };
  std::vector<Corner> corners(glm::dvec2 pixel) const;
  glm::dvec3 storedColour(std::int64_t column, std::int64_t row) const;
  std::shared_ptr<const ImageFrame> frame_;
  ImageLayer layer_;
  VoiWindow window_;
  std::optional<FramePresentation> state_;
  std::optional<LutTable> voiLut_;
  // frame = middle_ + turn_ (pixel - centre_px_); turn_ has one entry other than 0 in each row and column.
  glm::dvec2 centre_px_{0}, middle_{0};
  glm::dmat2 turn_{1};
  double rowsPerColumn_ = 1;  // distance between rows in columns
};

}  // namespace vernier::quality
