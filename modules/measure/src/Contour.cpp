// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/measure/Contour.h"

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>

#include "Region.h"

namespace vernier::measure {
namespace {

constexpr std::int64_t kMostPixels = 32767;
// Right, down, left, up, and the steps between them: clockwise as seen with rows going down.
constexpr std::array<std::array<int, 2>, 8> kAround{
    {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};

int directionOf(cv::Point d) {
  for (int n = 0; n < 8; ++n)
    if (kAround[static_cast<std::size_t>(n)][0] == d.x && kAround[static_cast<std::size_t>(n)][1] == d.y)
      return n;
  return -1;
}

double signedArea(const std::vector<cv::Point>& c) {
  double twice = 0;
  for (std::size_t i = 0; i < c.size(); ++i) {
    const cv::Point a = c[i], b = c[(i + 1) % c.size()];
    twice += static_cast<double>(a.x) * b.y - static_cast<double>(b.x) * a.y;
  }
  return twice / 2;
}

}  // namespace

Result<std::vector<glm::dvec2>> thresholdContour(
    std::int64_t columns, std::int64_t rows, const std::function<double(std::int64_t, std::int64_t)>& value,
    double level, std::int64_t seedColumn, std::int64_t seedRow) {
  const auto no = [](const char* s) { return makeError(ErrorCode::OptionInvalid, s); };
  if (columns > kMostPixels || rows > kMostPixels)
    return no("The image is too large for a contour (32767 pixels).");
  if (seedColumn < 0 || seedColumn >= columns || seedRow < 0 || seedRow >= rows)
    return no("The seed lies outside of the image.");
  const auto reaches = [&](std::int64_t i, std::int64_t j) {
    return i >= 0 && i < columns && j >= 0 && j < rows && value(i, j) >= level;
  };
  if (!reaches(seedColumn, seedRow))
    return no("The value at the seed is below the level; choose another place.");
  cv::Mat mask(static_cast<int>(rows), static_cast<int>(columns), CV_8U);
  for (int j = 0; j < mask.rows; ++j)
    for (int i = 0; i < mask.cols; ++i) mask.at<std::uint8_t>(j, i) = reaches(i, j) ? 255 : 0;
  cv::Mat labels;
  cv::connectedComponents(mask, labels, 8, CV_32S);
  const int mine = labels.at<int>(static_cast<int>(seedRow), static_cast<int>(seedColumn));
  std::vector<std::vector<cv::Point>> chains;
  cv::Mat only = labels == mine;
  cv::findContours(only, chains, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  if (chains.empty()) return no("The region has no outline.");
  std::vector<cv::Point> chain = chains.front();
  const bool clockwise = signedArea(chain) >= 0;  // with rows going down

  // Going round, the outside lies to the left of a clockwise walk: turn from where we came to where we go and
  // take each of the four neighbours that is outside.
  if (!clockwise) std::reverse(chain.begin(), chain.end());
  std::vector<glm::dvec2> outline;
  const auto crossing = [&](cv::Point p, int direction) {
    const auto& d = kAround[static_cast<std::size_t>(direction)];
    const std::int64_t i = p.x + d[0], j = p.y + d[1];
    double t = 0;
    if (i >= 0 && i < columns && j >= 0 && j < rows) {
      const double in = value(p.x, p.y), out = value(i, j);
      t = out < level ? std::clamp((in - level) / (in - out), 0.0, 1.0) : 0;  // no data: at the last centre
    }
    outline.emplace_back(p.x + 0.5 + t * d[0], p.y + 0.5 + t * d[1]);
  };
  const std::size_t n = chain.size();
  for (std::size_t c = 0; c < n; ++c) {
    const cv::Point p = chain[c];
    if (n == 1) {
      for (const int direction : {0, 2, 4, 6}) crossing(p, direction);
      break;
    }
    const int from = directionOf(chain[(c + n - 1) % n] - p), to = directionOf(chain[(c + 1) % n] - p);
    if (from < 0 || to < 0) return no("The outline could not be followed.");
    for (int turn = 1; turn <= 8; ++turn) {
      const int direction = (from + turn) % 8;
      if (direction == to) break;
      if (direction % 2 == 0 && !reaches(p.x + kAround[static_cast<std::size_t>(direction)][0],
                                         p.y + kAround[static_cast<std::size_t>(direction)][1]))
        crossing(p, direction);
    }
  }
  return outline;
}

Flat thresholdRegion(Work& w, const ThresholdRegion& s) {
  if (w.projected()) refuse("A threshold needs values, which a projection does not have; use a slice.");
  Flat f;
  f.origin = w.point(s.seed);
  Result<std::vector<glm::dvec2>> outline = std::vector<glm::dvec2>{};
  if (w.image) {
    if (w.image->isColour()) refuse("Colours have no values to be measured.");
    const ImageFrameInfo& i = w.image->info();
    outline = thresholdContour(
        i.columns, i.rows,
        [&](std::int64_t x, std::int64_t y) {
          const double stored = w.image->stored(x, y);
          return w.image->isNoData(stored) ? std::numeric_limits<double>::quiet_NaN()
                                           : w.image->modalityOf(stored);
        },
        s.level_val, static_cast<std::int64_t>(std::floor(s.seed.x)),
        static_cast<std::int64_t>(std::floor(s.seed.y)));
    if (!outline) throw Refused{outline.error()};
    for (const glm::dvec2& p : *outline) {
      w.out.found.emplace_back(p, 0);
      f.outline.push_back(f.toFlat(w.point({p, 0})));
    }
    return f;
  }
  if (!w.axes) refuse("A region needs the plane of its picture: axes with a normal and an up.");
  f.up = w.axes->up.v;
  f.right = screenRight(*w.axes);
  f.outline = {{0, 0}, {1, 0}, {0, 1}};
  const Volume& v = *w.volume;
  const auto k = acquiredSlice(v, f);
  if (!k || v.isColour())
    refuse("A threshold is taken on stored frames and acquired slices; go to one of the slices.");
  const GridGeometry& g = v.grid();
  const glm::dvec3 first =
      g.even() ? glm::dvec3(0, 0, static_cast<double>(*k)) : g.sliceOrigin_vox[static_cast<std::size_t>(*k)];
  const glm::dvec3 seed = (v.voxelFromPatient() * PatientPoint(s.seed)).p - first;
  outline = thresholdContour(
      g.columns, g.rows,
      [&](std::int64_t x, std::int64_t y) {
        const VoxelValue p = v.probe(x, y, *k);
        return p.noData ? std::numeric_limits<double>::quiet_NaN() : p.modality;
      },
      s.level_val, std::llround(seed.x), std::llround(seed.y));
  if (!outline) throw Refused{outline.error()};
  f.outline.clear();
  for (const glm::dvec2& p : *outline) {
    const glm::dvec3 at = (g.patientFromVoxel * VoxelPoint(first + glm::dvec3(p.x - 0.5, p.y - 0.5, 0))).p;
    w.out.found.push_back(at);
    f.outline.push_back(f.toFlat(at));
  }
  return f;
}

}  // namespace vernier::measure
