// SPDX-License-Identifier: GPL-3.0-or-later
// Files written here by hand, byte by byte, in every way that the format allows and that we read.
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <zlib.h>

#include <algorithm>
#include <fstream>

#include "Grids.h"
#include "TestData.h"
#include "vernier/volume/VolumeFile.h"

namespace vernier {
namespace {
using ::testing::HasSubstr;

void write(const std::filesystem::path& p, const std::string& bytes) {
  std::ofstream(p, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

template <class T>
std::string bytesOfValues(const std::vector<T>& v, bool swapped = false) {
  std::string s(reinterpret_cast<const char*>(v.data()), v.size() * sizeof(T));
  if (swapped)
    for (std::size_t i = 0; i < s.size(); i += sizeof(T))
      std::reverse(s.begin() + std::ptrdiff_t(i), s.begin() + std::ptrdiff_t(i + sizeof(T)));
  return s;
}

std::string deflated(const std::string& raw) {
  uLongf n = compressBound(raw.size());
  std::string out(n, '\0');
  EXPECT_EQ(compress(reinterpret_cast<Bytef*>(out.data()), &n, reinterpret_cast<const Bytef*>(raw.data()),
                     raw.size()),
            Z_OK);
  out.resize(n);
  return out;
}

const char* const kHead =
    "ObjectType = Image\nNDims = 3\nDimSize = 4 3 2\nElementSpacing = 0.5 0.75 2.5\nOffset = -10 20.5 3e1\n";

struct Case {
  test::TempDir dir;
  std::string path() const { return (dir.path() / "v.mhd").string(); }
  Result<std::shared_ptr<const Volume>> read(const BuildOptions& o = {}) { return readVolumeFile(path(), o); }
  ErrorCode refusal(const std::string& header, const std::string& raw = std::string(48, '\1')) {
    write(dir.path() / "v.mhd", header);
    write(dir.path() / "v.raw", raw);
    const auto v = read();
    EXPECT_FALSE(v.ok()) << header;
    if (v.ok()) return ErrorCode::Internal;
    EXPECT_FALSE(v.error().sentence.empty());
    EXPECT_EQ(v.error().where.find('/'), std::string::npos) << "no path in an error";
    return v.error().code;
  }
};

template <class T>
class MetaImage : public ::testing::Test {};
using AllTypes = ::testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t,
                                  std::int32_t, float>;
TYPED_TEST_SUITE(MetaImage, AllTypes);

template <class T>
const char* metName() {
  switch (test::typeFor<T>()) {
    case VoxelType::U8:
      return "MET_UCHAR";
    case VoxelType::I8:
      return "MET_CHAR";
    case VoxelType::U16:
      return "MET_USHORT";
    case VoxelType::I16:
      return "MET_SHORT";
    case VoxelType::U32:
      return "MET_UINT";
    case VoxelType::I32:
      return "MET_INT";
    default:
      return "MET_FLOAT";
  }
}

TYPED_TEST(MetaImage, EveryTypeOrderAndPacking) {
  using T = TypeParam;
  std::vector<T> values(24);
  for (std::size_t i = 0; i < 24; ++i)
    values[i] = static_cast<T>(std::is_signed_v<T> ? int(i) * 5 - 60 : int(i) * 5);
  values[3] = std::numeric_limits<T>::max();
  values[4] = std::numeric_limits<T>::lowest();
  for (const bool big : {false, true})
    for (const bool packed : {false, true})
      for (const bool local : {false, true}) {
        Case c;
        const std::string raw = bytesOfValues(values, big), data = packed ? deflated(raw) : raw;
        std::string h = std::string(kHead) + "ElementType = " + metName<T>() + "\n";
        h += std::string("BinaryDataByteOrderMSB = ") + (big ? "True\n" : "False\n");
        if (packed) h += "CompressedData = True\nCompressedDataSize = " + std::to_string(data.size()) + "\n";
        h += local ? "ElementDataFile = LOCAL\n" + data : "ElementDataFile = v.raw\n";
        write(c.dir.path() / "v.mhd", h);
        if (!local) write(c.dir.path() / "v.raw", data);
        const auto v = c.read();
        ASSERT_TRUE(v.ok()) << v.error().text();
        EXPECT_EQ((*v)->type(), test::typeFor<T>());
        for (std::size_t i = 0; i < 24; ++i)
          ASSERT_EQ((*v)->stored(std::int64_t(i % 4), std::int64_t(i / 4 % 3), std::int64_t(i / 12)),
                    double(values[i]));
        EXPECT_EQ((*v)->info().unit, "stored value");
        EXPECT_EQ((*v)->grid().spacing_mm(), glm::dvec3(0.5, 0.75, 2.5));
        EXPECT_EQ((*v)->grid().corner(0), PatientPoint(-10, 20.5, 30));
      }
}

const std::string kShort = std::string(kHead) + "ElementType = MET_SHORT\n";

// ITK's convention, with the numbers of a sagittal image: columns run to posterior (0 1 0), rows to inferior
// (0 0 -1), slices to the right (-1 0 0). A reader that takes the matrix row by row would swap the last two.
TEST(MetaImageGeometry, TransformMatrixHoldsTheAxesOneAfterTheOther) {
  Case c;
  write(c.dir.path() / "v.mhd", kShort +
                                    "TransformMatrix = 0 1 0 0 0 -1 -1 0 0\nCenterOfRotation = 9 9 9\n"
                                    "AnatomicalOrientation = RAI\nElementDataFile = LOCAL\n" +
                                    std::string(48, '\0'));
  const auto v = c.read();
  ASSERT_TRUE(v.ok()) << v.error().text();
  const PatientFromVoxel& m = (*v)->grid().patientFromVoxel;
  EXPECT_EQ(m * VoxelPoint(0, 0, 0), PatientPoint(-10, 20.5, 30));
  EXPECT_EQ(m * VoxelPoint(1, 0, 0), PatientPoint(-10, 21, 30));
  EXPECT_EQ(m * VoxelPoint(0, 1, 0), PatientPoint(-10, 20.5, 29.25));
  EXPECT_EQ(m * VoxelPoint(0, 0, 1), PatientPoint(-12.5, 20.5, 30));
}

TEST(MetaImageGeometry, FlatMatrixIsRefused) {
  Case c;
  EXPECT_EQ(c.refusal(kShort + "TransformMatrix = 1 0 0 1 0 0 0 0 1\nElementDataFile = v.raw\n"),
            ErrorCode::GeometryRefused);
}

TEST(MetaImageGeometry, SpacingMustBePossible) {
  for (const char* s : {"0 1 1", "1 nan 1", "1 1 -2", "1 1 inf", "1e-5 1 1", "1 2000 1"}) {
    Case c;
    EXPECT_EQ(c.refusal("NDims = 3\nDimSize = 4 3 2\nElementType = MET_SHORT\nElementSpacing = " +
                        std::string(s) + "\nElementDataFile = v.raw\n"),
              ErrorCode::GeometryRefused)
        << s;
  }
  Case c;
  EXPECT_EQ(
      c.refusal(
          "NDims = 3\nDimSize = 4 3 2\nElementType = MET_SHORT\nOffset = 0 nan 0\nElementDataFile = v.raw\n"),
      ErrorCode::GeometryRefused);
}

TEST(MetaImageFiles, TwoDimensionsAndWindowsLineEnds) {
  Case c;
  write(c.dir.path() / "v.mhd",
        "NDims = 2\r\nDimSize = 3 2\r\nElementType = MET_UCHAR\r\nElementDataFile = LOCAL\r\nabcdef");
  const auto v = c.read();
  ASSERT_TRUE(v.ok()) << v.error().text();
  EXPECT_EQ((*v)->grid().slices, 1);
  EXPECT_EQ((*v)->stored(2, 1, 0), 'f');
}

TEST(MetaImageFiles, HeaderSizeSkips) {
  for (const char* skip : {"7", "-1"}) {
    Case c;
    write(c.dir.path() / "v.mhd", kShort + "HeaderSize = " + skip + "\nElementDataFile = v.raw\n");
    write(c.dir.path() / "v.raw", "seven b" + bytesOfValues(std::vector<std::int16_t>(24, 513)));
    const auto v = c.read();
    ASSERT_TRUE(v.ok()) << v.error().text();
    EXPECT_EQ((*v)->modalityRange()->min, 513);
    EXPECT_EQ((*v)->modalityRange()->max, 513);
  }
}

TEST(MetaImageFiles, DataOutsideTheFolderIsRefused) {
  Case c;
  std::filesystem::create_directories(c.dir.path() / "in");
  write(c.dir.path() / "v.raw", std::string(48, '\1'));
  for (const std::string& name :
       {std::string("../v.raw"), (c.dir.path() / "v.raw").string(), std::string("x/../../v.raw")}) {
    write(c.dir.path() / "in" / "v.mhd", kShort + "ElementDataFile = " + name + "\n");
    const auto v = readVolumeFile((c.dir.path() / "in" / "v.mhd").string());
    ASSERT_FALSE(v.ok());
    EXPECT_THAT(v.error().sentence, HasSubstr("outside the header's folder"));
  }
}

TEST(MetaImageFiles, WhatIsNotReadSaysSo) {
  const std::pair<const char*, const char*> lines[] = {
      {"ElementDataFile = LIST\na.raw\nb.raw\n", "list of files"},
      {"ElementDataFile = s%03d.raw 1 2 1\n", "list of files"},
      {"ElementNumberOfChannels = 3\nElementDataFile = v.raw\n", "3 values of type int16 per voxel"},
      {"ElementType = MET_SHORT_ARRAY\nElementDataFile = v.raw\n", "ElementType"},
      {"BinaryData = False\nElementDataFile = v.raw\n", "BinaryData"},
      {"NDims = 4\nElementDataFile = v.raw\n", "dimensions"},
      {"ObjectType = Tube\nElementDataFile = v.raw\n", "ObjectType"}};
  for (const auto& [line, sentence] : lines) {
    Case c;
    EXPECT_EQ(c.refusal(kShort + line), ErrorCode::NotBuiltYet);
    EXPECT_THAT(c.read().error().sentence, HasSubstr(sentence));
  }
}

TEST(MetaImageFiles, SizesAreCheckedAgainstTheFileBeforeMemoryIsTaken) {
  Case c;
  EXPECT_EQ(c.refusal(kShort + "ElementDataFile = v.raw\n", std::string(47, 'x')), ErrorCode::PixelDataShort);
  const std::string huge = "NDims = 3\nDimSize = 100000 100000 100000\nElementType = MET_SHORT\n";
  EXPECT_EQ(c.refusal(huge + "ElementDataFile = v.raw\n"), ErrorCode::PixelDataShort);
  EXPECT_EQ(c.refusal(huge + "ElementDataFile = LOCAL\nab"), ErrorCode::PixelDataShort);
  EXPECT_EQ(c.refusal(huge + "CompressedData = True\nElementDataFile = v.raw\n"), ErrorCode::PixelDataShort);
  EXPECT_EQ(
      c.refusal("NDims = 3\nDimSize = 9000000000000000000 9000000000000000000 4\nElementType = MET_SHORT\n"
                "ElementDataFile = v.raw\n"),
      ErrorCode::LimitExceeded);
  EXPECT_EQ(
      c.refusal(kShort + "CompressedData = True\nElementDataFile = v.raw\n", deflated(std::string(40, 'x'))),
      ErrorCode::PixelDataShort);
  EXPECT_EQ(c.refusal(kShort + "CompressedData = True\nElementDataFile = v.raw\n"), ErrorCode::FileDamaged);
  EXPECT_EQ(c.refusal(kShort + "HeaderSize = 999\nElementDataFile = v.raw\n"), ErrorCode::PixelDataShort);
}

TEST(MetaImageFiles, BadHeadersEndAtOnceWithASentence) {
  const std::string headers[] = {
      "",
      "\n\n",
      "hello",
      "NDims = 3\n",
      "ElementDataFile = v.raw\n",
      std::string("\x7f"
                  "ELF\2\1\1\0\0\0",
                  10),
      std::string(200000, 'A'),
      "NDims = 3\n" + std::string(100000, 'A') + " = 3\nDimSize = 2 2 2\nElementDataFile = v.raw\n"};
  for (const std::string& h : headers) {
    Case c;
    EXPECT_EQ(c.refusal(h), ErrorCode::FormatUnknown);
  }
  const std::pair<const char*, ErrorCode> lines[] = {
      {"NDims = -5\n", ErrorCode::NotBuiltYet},
      {"NDims = 3 3\n", ErrorCode::FileDamaged},
      {"NDims = three\n", ErrorCode::FileDamaged},
      {"DimSize = 4 3\n", ErrorCode::FileDamaged},
      {"DimSize = 4 -3 2\n", ErrorCode::FileDamaged},
      {"DimSize = 4 0 2\n", ErrorCode::FileDamaged},
      {"DimSize = 99999999999999999999 1 1\n", ErrorCode::FileDamaged},
      {"TransformMatrix = 1 0 0\n", ErrorCode::FileDamaged},
      {"HeaderSize = -2\n", ErrorCode::FileDamaged}};
  for (const auto& [line, code] : lines) {
    Case c;
    EXPECT_EQ(c.refusal(kShort + line + "ElementDataFile = v.raw\n"), code) << line;
  }
}

TEST(MetaImageFiles, PathsThatAreNoFiles) {
  test::TempDir dir;
  EXPECT_EQ(readVolumeFile((dir.path() / "none.mhd").string()).error().code, ErrorCode::FileNotFound);
  EXPECT_EQ(readVolumeFile(dir.path().string()).error().code, ErrorCode::NotAFile);
  EXPECT_EQ(readVolumeFile("/dev/zero").error().code, ErrorCode::NotAFile);
  const std::string pipe = (dir.path() / "pipe").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(readVolumeFile(pipe).error().code, ErrorCode::NotAFile);
  write(dir.path() / "v.mhd", kShort + "ElementDataFile = none.raw\n");
  EXPECT_EQ(readVolumeFile((dir.path() / "v.mhd").string()).error().code, ErrorCode::FileNotFound);
}

TEST(MetaImageFiles, TheBudgetIsHeldAsLongAsTheVolume) {
  Case c;
  write(c.dir.path() / "v.mhd", kShort + "ElementDataFile = LOCAL\n" + std::string(48, '\1'));
  MemoryBudget small(47), enough(48);
  BuildOptions o;
  o.budget = &small;
  EXPECT_EQ(c.read(o).error().code, ErrorCode::OutOfMemory);
  o.budget = &enough;
  {
    const auto v = c.read(o);
    ASSERT_TRUE(v.ok());
    EXPECT_EQ(enough.used(), 48u);
    const std::shared_ptr<const Volume> other = *v;
    EXPECT_EQ(enough.used(), 48u);
  }
  EXPECT_EQ(enough.used(), 0u);
}

}  // namespace
}  // namespace vernier
