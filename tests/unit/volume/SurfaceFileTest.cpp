// SPDX-License-Identifier: GPL-3.0-or-later
// Every surface format by hand-made text, and what is refused, with which sentence.
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

#include "TestData.h"
#include "surface/Readers.h"
#include "vernier/study/Limits.h"
#include "vernier/volume/SurfaceFile.h"

namespace vernier::test {
namespace {

class Surface : public ::testing::Test {
 protected:
  Result<SurfaceFile> read(const std::string& name, const std::string& bytes) {
    const std::string path = (dir_.path() / name).string();
    std::ofstream(path, std::ios::binary) << bytes;
    return readSurface(path);
  }
  // An error of this code, one sentence, that holds `part` and no path.
  void expectError(const std::string& name, const std::string& bytes, ErrorCode code,
                   const std::string& part) {
    SCOPED_TRACE(name + ": " + bytes.substr(0, 60));
    const Result<SurfaceFile> file = read(name, bytes);
    ASSERT_FALSE(file.ok());
    EXPECT_EQ(errorName(file.error().code), errorName(code)) << file.error().text();
    EXPECT_NE(file.error().sentence.find(part), std::string::npos) << file.error().sentence;
    EXPECT_EQ(file.error().where, name);
    EXPECT_EQ(file.error().text().find(dir_.path().string()), std::string::npos);
  }
  TempDir dir_;
};

// A tetrahedron with corners at the origin and at 1, 2, 3 on the axes: volume 1.
constexpr glm::dvec3 kCorner[4] = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
constexpr int kFace[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

std::string binaryStl(std::uint32_t declared, std::size_t facets) {
  std::string s(80, ' ');
  s.replace(0, 5, "solid");  // as many programs write it
  s.append(reinterpret_cast<const char*>(&declared), 4);
  for (std::size_t n = 0; n < facets; ++n) {
    float v[12] = {};
    for (std::size_t c = 0; c < 3; ++c)
      for (int a = 0; a < 3; ++a)
        v[3 + 3 * c + static_cast<std::size_t>(a)] = static_cast<float>(kCorner[kFace[n % 4][c]][a]);
    s.append(reinterpret_cast<const char*>(v), sizeof v).append(2, '\0');
  }
  return s;
}

std::string textStl() {
  std::string s = "SOLID a name facet\n";
  for (const auto& f : kFace) {
    s += "facet normal 0 0 0\n outer loop\n";
    for (const int c : f)
      s += "  vertex " + std::to_string(kCorner[c].x) + " " + std::to_string(kCorner[c].y) + "e0 +" +
           std::to_string(kCorner[c].z) + "\n";
    s += " endloop\nendfacet\n";
  }
  return s + "endsolid a name facet\n";
}

const std::string kPlyHeader =
    "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\nproperty float x\nproperty float "
    "y\nproperty "
    "float z\nproperty uchar red\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n";
const std::string kPlyBody = "0 0 0 255\n1 0 0 7\n0 2 0 7\n0 0 3 7\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
const std::string kObj =
    "# by hand\nmtllib x.mtl\nv 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nvt 0 0\nf 1/1 3/1 2/1\nf 1 2 \\\n 4\nf -4 "
    "-1 -2\nf "
    "2//1 3//1 4//1\n";
const std::string kIv =
    "#Inventor V2.1 ascii\nSeparator { Info { string \"a } b\" } Material { diffuseColor 1 0 0 }\n "
    "Coordinate3 { point "
    "[ 0 0 0, 1 0 0, 0 2 0, 0 0 3, ] }\n IndexedFaceSet { coordIndex [ 0,2,1,-1, 0,1,3,-1, 0,3,2,-1, 1,2,3 ] "
    "} }\n";
const std::string kVrml2 =
    "#VRML V2.0 utf8\nViewpoint { position 0 0 9 }\nTransform { children [ Shape { appearance Appearance { "
    "material "
    "Material { diffuseColor 1 1 0 } } geometry IndexedFaceSet { solid FALSE coord DEF c Coordinate { point "
    "[ 0 0 0 1 0 0 "
    "0 2 0 0 0 3 ] } coordIndex [ 0 2 1 -1 0 1 3 -1 0 3 2 -1 1 2 3 -1 ] } } ] translation 10 0 0 scale 2 2 2 "
    "rotation 0 "
    "0 1 1.5707963267948966 }\n";

TEST_F(Surface, EveryFormatGivesTheTetrahedron) {
  const std::string vrml1 = "#VRML V1.0 ascii" + kIv.substr(kIv.find('\n'));
  const std::pair<const char*, std::string> files[] = {{"a.stl", binaryStl(4, 4)},
                                                       {"b.STL", textStl()},
                                                       {"c.ply", kPlyHeader + kPlyBody},
                                                       {"d.obj", kObj},
                                                       {"e.iv", kIv},
                                                       {"f.wrl", vrml1}};
  for (const auto& [name, bytes] : files) {
    SCOPED_TRACE(name);
    const Result<SurfaceFile> file = read(name, bytes);
    ASSERT_TRUE(file.ok()) << file.error().text();
    EXPECT_EQ(file->bytes, bytes.size());
    EXPECT_EQ(file->triangles, 4u);
    EXPECT_EQ(file->mesh->vertices().size(), 4u);
    const MeshFacts f = meshFacts(*file->mesh);
    EXPECT_TRUE(f.closed);
    EXPECT_NEAR(f.signedVolume_mm3, 1, 1e-12);
    EXPECT_EQ(file->mesh->highest(), MeshPoint(1, 2, 3));
    ASSERT_EQ(file->findings.size(), 1u);
    EXPECT_EQ(file->findings[0].code, "unit-assumed");
  }
}

TEST_F(Surface, Vrml2TransformsMoveThePoints) {
  const auto file = read("a.wrl", kVrml2);
  ASSERT_TRUE(file.ok()) << file.error().text();
  const MeshFacts f = meshFacts(*file->mesh);
  EXPECT_TRUE(f.closed);
  EXPECT_NEAR(f.signedVolume_mm3, 8, 1e-12);
  // x goes to y, y to -x, twice as large, 10 to the right.
  EXPECT_NEAR(file->mesh->lowest().p.x, 10 - 4, 1e-12);
  EXPECT_NEAR(file->mesh->highest().p.y, 2, 1e-12);
  EXPECT_NEAR(file->mesh->highest().p.z, 6, 1e-12);
  // A mirroring scale keeps outside outside.
  std::string mirrored = kVrml2;
  mirrored.replace(mirrored.find("scale 2 2 2"), 11, "scale -1 1 1");
  const auto turned = read("b.wrl", mirrored);
  ASSERT_TRUE(turned.ok());
  EXPECT_NEAR(meshFacts(*turned->mesh).signedVolume_mm3, 1, 1e-12);
}

TEST_F(Surface, PlyOfBothByteOrdersAndAnyElements) {
  for (const bool big : {false, true}) {
    std::string s = std::string("ply\r\nformat binary_") + (big ? "big" : "little") +
                    "_endian 1.0\r\nelement camera 2\r\nproperty list uchar short what\r\nelement vertex "
                    "4\r\nproperty double "
                    "x\r\nproperty double y\r\nproperty double z\r\nelement face 4\r\nproperty uchar "
                    "flags\r\nproperty list ushort "
                    "uint vertex_index\r\nend_header\r\n";
    const auto put = [&](auto x) {
      std::string raw(reinterpret_cast<const char*>(&x), sizeof x);
      if (big) std::reverse(raw.begin(), raw.end());
      s += raw;
    };
    for (int n = 0; n < 2; ++n) {
      put(std::uint8_t{3});
      for (int i = 0; i < 3; ++i) put(std::int16_t{-7});
    }
    for (const glm::dvec3& c : kCorner) put(c.x + 0.1), put(c.y), put(c.z);
    for (const auto& f : kFace) {
      put(std::uint8_t{9}), put(std::uint16_t{3});
      for (const int c : f) put(static_cast<std::uint32_t>(c));
    }
    const auto file = read("a.ply", s);
    ASSERT_TRUE(file.ok()) << file.error().text();
    EXPECT_NEAR(meshFacts(*file->mesh).signedVolume_mm3, 1, 1e-12);
    EXPECT_EQ(file->mesh->lowest().p.x, 0.1);  // all digits of double
    expectError("b.ply", s.substr(0, s.size() - 1), ErrorCode::FileDamaged, "number 3 of 4");
  }
}

TEST_F(Surface, PolygonsAreCutEvenWhenTheyAreNotConvex) {
  // An L of area 3 and a star-like comb, clockwise and counter-clockwise, in a tilted plane.
  const auto l =
      read("l.obj", "v 0 0 1\nv 2 0 3\nv 2 1 3\nv 1 1 2\nv 1 2 2\nv 0 2 1\nf 1 2 3 4 5 6\nf 6 5 4 3 2 1\n");
  ASSERT_TRUE(l.ok());
  EXPECT_EQ(l->triangles, 8u);
  EXPECT_NEAR(meshFacts(*l->mesh).area_mm2, 2 * 3 * std::sqrt(2.0), 1e-12);
  std::string comb, face = "f";
  const int teeth = 50;
  for (int i = 0; i < teeth; ++i)
    comb += "v " + std::to_string(i) + " 0 0\nv " + std::to_string(i) + ".5 10 0\n";
  comb += "v " + std::to_string(teeth) + " 0 0\nv " + std::to_string(teeth) + " -1 0\nv 0 -1 0\n";
  for (int i = 2 * teeth + 3; i > 0; --i) face += " " + std::to_string(i);
  const auto c = read("c.obj", comb + face + "\n");
  ASSERT_TRUE(c.ok());
  EXPECT_NEAR(meshFacts(*c->mesh).area_mm2, teeth * 0.5 * 10 + teeth, 1e-9);
  // The bow-tie crosses itself: something is drawn, nothing loops.
  EXPECT_TRUE(read("x.obj", "v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nv 3 3 0\nf 1 2 3 4 5\n").ok());
}

TEST_F(Surface, WrongCountsOfBinaryStl) {
  expectError("cut.stl", binaryStl(4, 4).substr(0, 84 + 199), ErrorCode::FileDamaged, "cut short");
  expectError("many.stl", binaryStl(0xFFFFFFF0, 4), ErrorCode::FileDamaged, "4294967280 triangles");
  expectError("head.stl", binaryStl(4, 4).substr(0, 40) + '\x01', ErrorCode::FileDamaged, "84 bytes");
  for (const std::uint32_t declared : {0u, 0xFFFFFFFFu}) {
    const auto file = read("unsaid.stl", binaryStl(declared, 4));
    ASSERT_TRUE(file.ok()) << file.error().text();
    EXPECT_EQ(file->triangles, 4u);
    EXPECT_EQ(file->findings[0].code, "declared-count");
  }
  const auto longer = read("longer.stl", binaryStl(4, 5));
  ASSERT_TRUE(longer.ok());
  EXPECT_EQ(longer->triangles, 4u);
  EXPECT_EQ(*longer->declaredTriangles, 4u);
  EXPECT_EQ(*longer->bytesExpected, 84u + 200u);
  EXPECT_EQ(longer->findings[0].severity, Severity::Warning);
}

TEST_F(Surface, E6_NotFiniteAndZeroAreaTrianglesAreSaid) {
  std::string s = binaryStl(4, 4);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(s.data() + 84 + 16, &nan, 4);
  std::memset(s.data() + 84 + 50 + 12, 0, 36);
  const auto file = read("a.stl", s);
  ASSERT_TRUE(file.ok());
  EXPECT_EQ(file->triangles, 4u);
  EXPECT_EQ(file->dropped, (MeshDropped{1, 1}));
  EXPECT_EQ(file->mesh->triangles().size(), 2u);
  ASSERT_EQ(file->findings.size(), 2u);
  EXPECT_EQ(file->findings[1].code, "triangles-dropped");
}

TEST_F(Surface, WhatIsNotWhatItsNameSays) {
  expectError("a.stl", "This is a letter, not a surface.\n", ErrorCode::FormatUnknown, "text");
  expectError("a.stl", "", ErrorCode::FileDamaged, "empty");
  expectError("a.ply", kObj, ErrorCode::FormatUnknown, "'ply'");
  expectError("a.obj", "hello\nworld\n", ErrorCode::FormatUnknown, "Line 1");
  expectError("a.obj", "# nothing\n", ErrorCode::FormatUnknown, "no OBJ");
  expectError("a.wrl", kObj, ErrorCode::FormatUnknown, "VRML");
  expectError("a.iv", "#Inventor V2.1 binary\n", ErrorCode::NotBuiltYet, "'ascii'");
  expectError("a.vtp", "<VTKFile type=\"ImageData\"></VTKFile>", ErrorCode::FormatUnknown, "PolyData");
  expectError("a.xyz", "1 2 3", ErrorCode::FormatUnknown, ".stl");
  EXPECT_EQ(readSurface((dir_.path() / "absent.stl").string()).error().code, ErrorCode::FileNotFound);
  std::filesystem::create_directory(dir_.path() / "folder.stl");
  EXPECT_EQ(readSurface((dir_.path() / "folder.stl").string()).error().code, ErrorCode::NotAFile);
}

TEST_F(Surface, DamagedTextSaysTheLine) {
  std::string stl = textStl();
  expectError("a.stl", stl.substr(0, stl.find("endloop")), ErrorCode::FileDamaged, "Line 7");
  stl.replace(stl.find("0.000000 0.000000e0"), 8, "zero");
  expectError("a.stl", stl, ErrorCode::FileDamaged, "Line 4");
  expectError("a.stl",
              "solid x\nfacet normal 0 0 0 outer loop vertex 0 0 0 vertex 1 0 0 endloop endfacet endsolid",
              ErrorCode::FileDamaged, "vertex");
  expectError("a.ply", kPlyHeader + kPlyBody.substr(0, 40), ErrorCode::FileDamaged, "cut short");
  expectError("a.ply", kPlyHeader + "0 0 x", ErrorCode::FileDamaged, "more than its bytes");
  expectError("a.ply", kPlyHeader.substr(0, kPlyHeader.find("end_header")), ErrorCode::FileDamaged,
              "end_header");
  std::string huge = kPlyHeader;
  huge.replace(huge.find("vertex 4"), 8, "vertex 999999999999");
  expectError("a.ply", huge + kPlyBody, ErrorCode::FileDamaged, "more than its bytes");
  std::string outside = kPlyBody;
  outside.replace(outside.find("3 1 2 3"), 7, "3 1 2 4");
  expectError("a.ply", kPlyHeader + outside, ErrorCode::FileDamaged, "Face 3");
  std::string list = kPlyBody;
  list.replace(list.find("3 1 2 3"), 7, "4000000000 1 2 4");
  expectError("a.ply", kPlyHeader + list, ErrorCode::FileDamaged, "face");
  expectError("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 4\n", ErrorCode::FileDamaged, "Line 4");
  expectError("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 0\n", ErrorCode::FileDamaged, "'0'");
  expectError("a.obj", "v 0 0\n", ErrorCode::FileDamaged, "Line 1");
  expectError("a.iv", kIv.substr(0, kIv.find("IndexedFaceSet") + 30), ErrorCode::FileDamaged, "");
  std::string far = kIv;
  far.replace(far.find("1,2,3 ]"), 7, "1,2,9 ]");
  expectError("a.iv", far, ErrorCode::FileDamaged, "point 9");
  expectError("a.wrl", "#VRML V2.0 utf8\n" + std::string(5000, '{'), ErrorCode::NotBuiltYet, "'{'");
  std::string deep = "#Inventor V2.1 ascii\n";
  for (int i = 0; i < 100000; ++i) deep += "Separator {";
  expectError("a.iv", deep, ErrorCode::FileDamaged, "deeper");
}

TEST_F(Surface, OtherNodesAreRefusedByName) {
  const std::string inner[] = {"Translation { translation 1 0 0 }",
                               "Sphere { radius 2 }",
                               "USE tool",
                               "File { name \"x\" }",
                               "QuadMesh { }",
                               "IndexedTriangleStripSet { }"};
  for (const std::string& node : inner)
    expectError("a.iv", "#Inventor V2.1 ascii\nSeparator {\n" + node + " }", ErrorCode::NotBuiltYet,
                node.substr(0, node.find(' ')));
  expectError("a.wrl", "#VRML V2.0 utf8\nShape { geometry Box { size 1 1 1 } }", ErrorCode::NotBuiltYet,
              "'Box'");
  expectError("a.wrl", "#VRML V2.0 utf8\nPROTO x [] { }", ErrorCode::NotBuiltYet, "'PROTO'");
  expectError("a.obj", "v 0 0 0\nsurf 0 1 0 1 1 2 3\n", ErrorCode::NotBuiltYet, "'surf'");
}

TEST_F(Surface, EmptyMeshesHaveNothingToLoad) {
  expectError("a.stl", "solid\nendsolid\n", ErrorCode::NothingToLoad, "no triangle");
  expectError("a.stl", binaryStl(0, 0), ErrorCode::NothingToLoad, "no triangle");
  expectError("a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", ErrorCode::NothingToLoad, "1 without area");
  expectError("a.iv", "#Inventor V2.1 ascii\nSeparator { }", ErrorCode::NothingToLoad, "no triangle");
  expectError("a.ply",
              "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float "
              "z\nend_header\n0 0 0\n",
              ErrorCode::NothingToLoad, "face");
}

TEST_F(Surface, MoreTrianglesThanAllowedAreRefusedBeforeTheyAreKept) {
  // A face list that names one long row of points over and over: 4 bytes a triangle.
  std::string s =
      "ply\nformat binary_little_endian 1.0\nelement vertex 65536\nproperty uchar x\nproperty uchar "
      "y\nproperty uchar "
      "z\nelement face 400\nproperty list uint ushort vertex_indices\nend_header\n";
  for (int i = 0; i < 65536; ++i) s += {static_cast<char>(i & 255), static_cast<char>(i >> 8), 0};
  const std::uint32_t n = 60000;
  for (int f = 0; f < 400; ++f) {
    s.append(reinterpret_cast<const char*>(&n), 4);
    s.append(2 * n, '\0');  // one point: no area, but each counts
  }
  expectError("a.ply", s, ErrorCode::LimitExceeded, std::to_string(limits::kMaxTriangles));
}

TEST_F(Surface, ReadingStopsWhenAskedToAndWithinTheBudget) {
  const std::string path = (dir_.path() / "a.stl").string();
  std::ofstream(path, std::ios::binary) << binaryStl(4, 4);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(readSurface(path, {}, stop.get_token()).error().code, ErrorCode::Cancelled);
  MemoryBudget budget(100);
  EXPECT_EQ(readSurface(path, {&budget}).error().code, ErrorCode::OutOfMemory);
}

// Every prefix and a change of one bit in every byte of every format: an error with a sentence, or a surface;
// never a crash. Straight from memory, since thousands of files would take a minute.
TEST(SurfaceReaders, CutAndChangedFilesNeverCrash) {
  using Reader = Result<void> (*)(std::string_view, surface::Polygons&, SurfaceFile&);
  const std::pair<Reader, std::string> files[] = {{surface::readStl, binaryStl(4, 4)},
                                                  {surface::readStl, textStl()},
                                                  {surface::readPly, kPlyHeader + kPlyBody},
                                                  {surface::readObj, kObj},
                                                  {surface::readSceneGraph, kIv},
                                                  {surface::readSceneGraph, kVrml2}};
  for (const auto& [reader, bytes] : files) {
    std::size_t read = 0;
    const auto tryOne = [&](const std::string& text) {
      MeshBuilder builder;
      surface::Polygons polygons(builder, {});
      SurfaceFile file;
      const Result<void> ok = reader(text, polygons, file);
      if (!ok) {
        EXPECT_FALSE(ok.error().sentence.empty());
        EXPECT_NE(ok.error().code, ErrorCode::Internal) << ok.error().sentence;
      }
      read += ok && builder.finish();
    };
    for (std::size_t n = 0; n < bytes.size(); ++n) {
      tryOne(bytes.substr(0, n));
      std::string changed = bytes;
      changed[n] = static_cast<char>(changed[n] ^ (1 << (n % 8)));
      tryOne(changed);
    }
    EXPECT_GT(read, 20u);  // not all damage is seen, and what is left is a surface
  }
}

}  // namespace
}  // namespace vernier::test
