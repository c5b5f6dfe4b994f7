// SPDX-License-Identifier: GPL-3.0-or-later
#include "Segments.h"

#include <algorithm>
#include <cmath>

#include "FrameReading.h"

namespace vernier {
namespace {

constexpr std::size_t kMaxSegments = 65535;  // Segment Number is 16 bits

double linearFromLab(double t) {
  constexpr double kDelta = 6.0 / 29.0;
  return t > kDelta ? t * t * t : 3 * kDelta * kDelta * (t - 4.0 / 29.0);
}
double coded(double linear) {
  linear = std::clamp(linear, 0.0, 1.0);
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

std::string meaningOf(const AttributeReader& item, Tag codeSequence) {
  auto code = item.item(codeSequence);
  return code ? shortText(*code, 0x00080104) : std::string();
}

}  // namespace

std::array<double, 3> srgbFromCieLab(const std::array<std::uint16_t, 3>& v) {
  const double l = v[0] * 100.0 / 65535.0, a = v[1] * 255.0 / 65535.0 - 128.0,
               b = v[2] * 255.0 / 65535.0 - 128.0;
  const double fy = (l + 16) / 116, fx = fy + a / 500, fz = fy - b / 200;
  // White of the profile connection space, D50.
  const double x = 0.96422 * linearFromLab(fx), y = linearFromLab(fy), z = 0.82521 * linearFromLab(fz);
  // XYZ of D50 to linear sRGB: Bradford to D65, then the primaries of BT.709, in one matrix.
  return {coded(3.1338561 * x - 1.6168667 * y - 0.4906146 * z),
          coded(-0.9787684 * x + 1.9161415 * y + 0.0334540 * z),
          coded(0.0719453 * x - 0.2289914 * y + 1.4052427 * z)};
}

void readSegments(AttributeReader& root, Record& record) {
  Instance& i = record.instance;
  const std::string type = root.code(0x00620001);
  i.segmentation = type == "FRACTIONAL" ? SegmentationKind::Fractional : SegmentationKind::Binary;
  if (i.segmentation == SegmentationKind::Fractional) {
    const auto most = root.words(0x0062000E);
    i.maxFractional = most.empty() || most[0] == 0 ? 255 : most[0];
    setRescale(1 / i.maxFractional, 0, i);
  }
  for (AttributeReader& item : root.items(0x00620002)) {
    if (i.segments.size() == kMaxSegments) break;
    Segment s;
    const auto number = item.words(0x00620004);
    s.number = number.empty() ? std::uint16_t{0} : number[0];
    s.label = shortText(item, 0x00620005);
    s.category = meaningOf(item, 0x00620003);
    s.type = meaningOf(item, 0x0062000F);
    s.algorithm = shortCode(item, 0x00620008);
    if (const auto lab = item.words(0x0062000D); lab.size() == 3)
      s.colour = srgbFromCieLab({lab[0], lab[1], lab[2]});
    i.segments.push_back(std::move(s));
  }
}

}  // namespace vernier
