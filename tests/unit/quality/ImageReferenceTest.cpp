// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "Scenes.h"

namespace vernier::quality {
namespace {

using namespace vernier::test;

// 4 x 3 pixels of value column + 10 row.
struct ImageScene {
  Scene scene;
  View view;
  Sources sources;
  ImageLayer& layer() { return std::get<ImageLayer>(scene.layers[0]); }
  ReferencePixel at(int x, int y) {
    const std::size_t p = static_cast<std::size_t>(x + view.width_px * y);
    const auto r = referencePixels(scene, view, sources, std::span(&p, 1));
    EXPECT_TRUE(r.ok()) << (r.ok() ? "" : r.error().text());
    return r.ok() ? (*r)[0] : ReferencePixel{};
  }
};

ImageScene imageScene(ImageFrameInfo info, int width, int height) {
  info.columns = 4;
  info.rows = 3;
  info.type = VoxelType::I16;
  if (info.autoWindow.width == 0) info.autoWindow = VoiWindow{16, 32, VoiFunction::LinearExact, ""};
  auto buffer = Buffer::make(24);
  for (int n = 0; n < 12; ++n) {
    const auto value = static_cast<std::int16_t>(n % 4 + 10 * (n / 4));
    std::memcpy(buffer->data() + 2 * n, &value, 2);
  }
  auto frame = ImageFrame::make(std::move(info), std::move(*buffer));
  EXPECT_TRUE(frame.ok());
  ImageScene s;
  ImageLayer layer;
  layer.source = "i";
  s.scene.layers.emplace_back(layer);
  s.sources.images[{"i", 0}] = *frame;
  s.view.width_px = width;
  s.view.height_px = height;
  return s;
}

TEST(ImageReference, OneToOneIsTheStoredPixel) {
  ImageScene s = imageScene({}, 4, 3);
  for (Interpolation i : {Interpolation::Nearest, Interpolation::Linear}) {
    s.layer().interpolation = i;
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < 4; ++x) EXPECT_EQ(s.at(x, y).value, x + 10 * y);
  }
  EXPECT_EQ(s.at(2, 1).rgba.x, 12.0 / 32);
}

TEST(ImageReference, FlipsAndInverts) {
  ImageScene s = imageScene({}, 4, 3);
  s.layer().flipHorizontal = true;
  EXPECT_EQ(s.at(0, 0).value, 3);
  s.layer().flipVertical = true;
  EXPECT_EQ(s.at(0, 0).value, 23);
  EXPECT_EQ(s.at(3, 2).value, 0);
  s.layer().invert = true;
  EXPECT_EQ(s.at(0, 0).rgba.y, 1 - 23.0 / 32);
  ImageFrameInfo monochrome1;
  monochrome1.inverted = true;
  ImageScene m = imageScene(monochrome1, 4, 3);
  EXPECT_EQ(m.at(0, 0).rgba.x, 1);
  m.layer().invert = true;
  EXPECT_EQ(m.at(0, 0).rgba.x, 0);
}

TEST(ImageReference, ZoomsNearestAndBilinear) {
  ImageScene s = imageScene({}, 8, 6);  // two pixels a sample
  EXPECT_EQ(s.at(0, 0).value, 0);       // the border is held
  EXPECT_NEAR(s.at(1, 0).value, 0.25, 1e-12);
  EXPECT_NEAR(s.at(2, 1).value, 0.75 + 2.5, 1e-12);
  s.layer().interpolation = Interpolation::Nearest;
  EXPECT_EQ(s.at(1, 0).value, 0);
  EXPECT_EQ(s.at(2, 1).value, 1);
  EXPECT_EQ(s.at(7, 5).value, 23);
}

TEST(ImageReference, KeepsThePixelAspect) {
  ImageFrameInfo info;
  info.pixelSpacing_mm = {2, 1};  // rows are 2 mm apart, columns 1 mm: the frame is 4 mm wide, 6 mm high
  ImageScene s = imageScene(info, 12, 12);
  s.layer().interpolation = Interpolation::Nearest;
  EXPECT_FALSE(s.at(1, 6).covered);  // 8 pixels wide, 2 at each side are free
  EXPECT_TRUE(s.at(2, 6).covered);
  EXPECT_EQ(s.at(2, 0).value, 0);
  EXPECT_EQ(s.at(9, 11).value, 23);
  EXPECT_EQ(s.at(2, 3).value, 0);
  EXPECT_EQ(s.at(2, 4).value, 10);
  s.scene.camera.height_mm = 3;  // twice as near
  s.scene.camera.pan_mm = {1, 0};
  EXPECT_EQ(s.at(0, 6).value, 11);  // 3 mm wide from -1.5 + 1 = -0.5 mm, that is column 1.5 of 0..4
}

TEST(ImageReference, WindowLutAndPadding) {
  ImageFrameInfo info;
  info.windows = {VoiWindow{10, 20, VoiFunction::LinearExact, ""}};
  info.noData = NoDataRange{0, 0};
  LutTable lut;
  lut.firstMapped = 1;
  lut.bits = 8;
  lut.data = {255, 0, 51};
  info.voiLuts = {lut};
  ImageScene s = imageScene(info, 4, 3);
  EXPECT_EQ(s.at(0, 1).rgba.x, 0.5);
  EXPECT_FALSE(s.at(0, 0).covered);
  s.layer().window = VoiWindow{10, 40, VoiFunction::LinearExact, ""};
  EXPECT_EQ(s.at(0, 2).rgba.x, 0.75);
  s.layer().voiLut = 0;
  EXPECT_EQ(s.at(1, 0).rgba.x, 1);
  EXPECT_EQ(s.at(2, 0).rgba.x, 0);
  EXPECT_NEAR(s.at(3, 2).rgba.x, 0.2, 1e-15);  // beyond the last entry: the last
}

}  // namespace
}  // namespace vernier::quality
