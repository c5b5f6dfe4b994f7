// SPDX-License-Identifier: GPL-3.0-or-later
// Lists of colour pictures, written here byte by byte.
#include <gmock/gmock.h>

#include "ColourCases.h"

namespace vernier {
namespace {
using namespace test;
using ::testing::HasSubstr;

std::string chunk(const std::string& name, const std::string& data) {
  const std::string body = name + data;
  const auto crc = crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
  return big(static_cast<std::uint32_t>(data.size())) + body + big(static_cast<std::uint32_t>(crc));
}

std::string png(int channels, int slice, int depth = 8) {
  const std::string pixels = interleaved(channels, slice);
  const auto n = static_cast<std::size_t>(kColumns * channels);
  std::string rows;
  for (std::size_t y = 0; y < kRows; ++y) {
    rows.push_back('\0');
    for (const char c : pixels.substr(y * n, n)) rows += depth == 16 ? std::string(2, c) : std::string(1, c);
  }
  return "\x89PNG\r\n\x1a\n" +
         chunk("IHDR", big(kColumns) + big(kRows) + std::string{static_cast<char>(depth)} +
                           std::string(1, channels == 3 ? '\2' : '\6') + std::string(3, '\0')) +
         chunk("IDAT", deflated(rows)) + chunk("IEND", "");
}

// `extra`: what the fourth value is: 0 not said, 1 opacity that the colours are multiplied by, 2 opacity.
std::string tiff(int channels, int slice, int extra = 2) {
  const std::string pixels = interleaved(channels, slice);
  const auto entry = [](int tag, int type, std::uint32_t count, std::uint32_t value) {
    return big(static_cast<std::uint32_t>(tag), 2) + big(static_cast<std::uint32_t>(type), 2) + big(count) +
           (type == 3 && count == 1 ? big(value, 2) + big(0, 2) : big(value));
  };
  const std::uint32_t n = channels == 4 ? 10 : 9, bits = 8 + 2 + 12 * n + 4, data = bits + 8;
  std::string s = "MM" + big(42, 2) + big(8) + big(n, 2);
  s += entry(256, 3, 1, kColumns) + entry(257, 3, 1, kRows);
  s += entry(258, 3, static_cast<std::uint32_t>(channels), bits);
  s += entry(259, 3, 1, 1) + entry(262, 3, 1, 2) + entry(273, 4, 1, data);
  s += entry(277, 3, 1, static_cast<std::uint32_t>(channels)) + entry(278, 3, 1, kRows);
  s += entry(279, 4, 1, static_cast<std::uint32_t>(pixels.size()));
  if (channels == 4) s += entry(338, 3, 1, static_cast<std::uint32_t>(extra));
  return s + big(0) + big(8, 2) + big(8, 2) + big(8, 2) + big(8, 2) + pixels;
}

// Channel by channel, the lowest row first.
std::string sgi(int channels, int slice, int bytes = 1) {
  std::string s = "\x01\xda";
  s.push_back('\0');
  s.push_back(static_cast<char>(bytes));
  s += big(3, 2) + big(kColumns, 2) + big(kRows, 2) + big(static_cast<std::uint32_t>(channels), 2);
  s += big(0) + big(255);
  s.resize(512, '\0');
  for (int c = 0; c < channels; ++c)
    for (int j = kRows - 1; j >= 0; --j)
      for (int i = 0; i < kColumns; ++i)
        s += std::string(static_cast<std::size_t>(bytes), static_cast<char>(truth(c, i, j, slice)));
  return s;
}

TEST(ColourList, EveryFormatGivesTheColoursThatWentIn) {
  for (const int channels : {3, 4}) {
    Folder f;
    for (int k = 0; k < kSlices; ++k) {
      f.write("p" + std::to_string(k) + ".png", png(channels, k));
      f.write("t" + std::to_string(k) + ".tif", tiff(channels, k));
      f.write("s" + std::to_string(k) + ".rgb", sgi(channels, k));
    }
    const std::string head = "@pixel-size 1 2\n@z-span 9\n";
    expectTruth(f.read("p.vrp", head + "p0.png\np1.png\np2.png\n"), channels);
    expectTruth(f.read("t.vrp", head + "t0.tif\nt1.tif\nt2.tif\n"), channels);
    expectTruth(f.read("s.vrp", head + "s0.rgb\ns1.rgb\ns2.rgb\n"), channels);
    expectTruth(f.read("m.vrp", head + "s0.rgb\np1.png\nt2.tif\n"), channels);
    EXPECT_EQ(f.refusal("u.vrp", "@unit HU\ns0.rgb\n").code, ErrorCode::FileDamaged);
    f.write("cut.rgb", sgi(channels, 1).substr(0, 530));
    EXPECT_EQ(f.refusal("c.vrp", "s0.rgb\ncut.rgb\n").code, ErrorCode::FileDamaged);
    f.write("other.png", png(7 - channels, 1));
    EXPECT_EQ(f.refusal("o.vrp", "p0.png\nother.png\n").code, ErrorCode::FileDamaged) << "3 beside 4";
  }
}

TEST(ColourList, PicturesWhoseColoursAreOtherwise) {
  Folder f;
  f.write("deep.png", png(3, 0, 16));
  f.write("deep.rgb", sgi(4, 0, 2));
  f.write("unsaid.tif", tiff(4, 0, 0));
  f.write("multiplied.tif", tiff(4, 0, 1));
  for (const char* deep : {"deep.png\n", "deep.rgb\n"})
    EXPECT_THAT(f.refusal("a.vrp", deep).sentence, HasSubstr("values of type uint16 per voxel")) << deep;
  EXPECT_THAT(f.refusal("a.vrp", "unsaid.tif\n").sentence, HasSubstr("not said to be opacity"));
  EXPECT_THAT(f.refusal("a.vrp", "multiplied.tif\n").sentence, HasSubstr("multiplied by their opacity"));
}

}  // namespace
}  // namespace vernier
