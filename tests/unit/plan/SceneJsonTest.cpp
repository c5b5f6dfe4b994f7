// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/plan/SceneJson.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <clocale>
#include <cmath>
#include <limits>

#include "vernier/base/Random.h"

namespace vernier {
namespace {

using ::testing::HasSubstr;

// "/where" of the error, or "ok".
std::string whereOf(const std::string& json) {
  const auto scene = parseScene(json);
  if (scene) return "ok";
  EXPECT_EQ(scene.error().code, ErrorCode::SceneInvalid) << scene.error().text();
  EXPECT_FALSE(scene.error().sentence.empty());
  return scene.error().where;
}
std::string withLayer(const std::string& layer) { return R"({"schema": 1, "layers": [)" + layer + "]}"; }
std::string withCamera(const std::string& camera) {
  return R"({"schema": 1, "camera": )" + camera + R"(, "layers": []})";
}
const std::string kPlane = R"("plane": {"point": [1, 2, 3], "normal": [0, 0, -1], "up": [0, -1, 0]})";

// Any finite double, from its bits: denormals, huge, tiny, -0.
double anyDouble(std::uint64_t& counter) {
  for (;;) {
    const double x = std::bit_cast<double>(randomBits(7, counter++));
    if (std::isfinite(x)) return x;
  }
}
double positive(std::uint64_t& c) {
  return std::abs(anyDouble(c)) + std::numeric_limits<double>::denorm_min();
}

Scene randomScene(std::uint64_t& c) {
  const auto bit = [&] { return (randomBits(9, c++) & 1) != 0; };
  const auto window = [&]() -> std::optional<VoiWindow> {
    if (bit()) return std::nullopt;
    const VoiFunction f[] = {VoiFunction::Linear, VoiFunction::LinearExact, VoiFunction::Sigmoid};
    return VoiWindow{anyDouble(c), positive(c), f[randomBits(9, c++) % 3],
                     bit() ? "" : "Knochen \"\\\n\x01 \xC3\xA4/~"};
  };
  const auto vec = [&] { return glm::dvec3(anyDouble(c), anyDouble(c), anyDouble(c)); };
  Scene s;
  s.camera = {anyDouble(c),
              anyDouble(c),
              anyDouble(c),
              bit() ? Projection::Perspective : Projection::Orthographic,
              1 + 178 * randomUnit(9, c++),
              positive(c),
              std::nullopt,
              {anyDouble(c), anyDouble(c)},
              std::nullopt,
              std::nullopt,
              0};
  if (bit()) s.camera.height_mm = positive(c);
  if (bit()) s.camera.target = PatientPoint(vec());
  if (bit()) s.camera.distance_mm = anyDouble(c);
  if (bit()) s.camera.near_mm = positive(c);
  s.background = {randomUnit(9, c++), randomUnit(9, c++), randomUnit(9, c++)};
  ImageLayer image;
  image.source = "1.2.840\t\xE6\x97\xA5";
  image.index = static_cast<std::int64_t>(randomBits(9, c++) >> 1);
  image.window = window();
  if (bit()) image.voiLut = 3;
  image.interpolation = bit() ? Interpolation::Nearest : Interpolation::Linear;
  image.invert = bit(), image.flipHorizontal = bit(), image.flipVertical = bit();
  SliceLayer slice;
  slice.source = "b";
  slice.plane = {PatientPoint(vec()), PatientVec(vec()), PatientVec(vec())};
  slice.slab = {positive(c), bit() ? SlabMode::Mean : SlabMode::Min};
  slice.window = window();
  slice.invert = bit();
  SurfaceLayer surface;
  surface.source = "screw #2.stl";
  // Determinants of any doubles overflow: a turn with a scale, and any place.
  surface.pose.linear =
      positive(c) > 1 ? glm::dmat3({0, 2.5, 0}, {-1.0 / 3, 0, 0}, {0.1, 0, -1e-7}) : glm::dmat3(1.0);
  surface.pose.translation = vec();
  surface.colour = {randomUnit(9, c++), randomUnit(9, c++), randomUnit(9, c++)};
  surface.opacity = randomUnit(9, c++);
  CurvedLayer curved;
  curved.source = "c";
  for (std::uint64_t n = 0; n < 2 + randomBits(9, c) % 5; ++n) curved.path.push_back(PatientPoint(vec()));
  curved.form = bit() ? CurvedForm::Stretched : CurvedForm::Straightened;
  if (bit()) curved.up = PatientVec(vec());
  curved.width_mm = positive(c);
  curved.slab = {positive(c), SlabMode::Max};
  curved.interpolation = bit() ? Interpolation::Cubic : Interpolation::Nearest;
  curved.window = window();
  curved.invert = bit();
  slice.interpolation = bit() ? Interpolation::Cubic : Interpolation::Linear;
  ProjectionLayer projection;
  projection.source = "d";
  projection.mode = static_cast<ProjectionMode>(randomBits(9, c++) % 5);
  projection.interpolation = bit() ? Interpolation::Nearest : Interpolation::Linear;
  projection.window = window();
  projection.invert = bit();
  projection.cue = projection.mode == ProjectionMode::Max ? randomUnit(9, c++) : 0;
  if (bit()) projection.gain_perMm = positive(c);
  ShellsLayer shells;
  shells.source = "e";
  shells.mode = static_cast<ShellsMode>(randomBits(9, c++) % 3);
  if (bit())
    shells.levels = {-1e300, -0.1, 0.1 + 0.2, positive(c) + 1};
  else
    shells.count = 1 + static_cast<int>(randomBits(9, c++) % kMostLevels);
  shells.spread = bit() ? LevelSpread::Histogram : LevelSpread::Even;
  if (bit()) shells.disabled = {3, 0, 1023};
  shells.window = window();
  shells.beta0 = positive(c), shells.betaM = positive(c);
  shells.a = positive(c), shells.b = positive(c), shells.phi0 = randomUnit(9, c++);
  shells.cueByDistance = bit();
  shells.colour = {randomUnit(9, c++), randomUnit(9, c++), randomUnit(9, c++)};
  if (shells.mode == ShellsMode::Max && bit()) shells.surfaceBlend = SurfaceBlend::Max;
  if (bit()) s.crop = CropBox{VoxelPoint(-0.1, 1.0 / 3, -7), VoxelPoint(1e9, 0.5, 5e-324)};
  if (bit()) s.clip = {{PatientVec(1, 2, -3), anyDouble(c)}, {PatientVec(0, 1e-3, 0), -0.0}};
  s.layers = {image,      slice,
              curved,     *customLayer(R"({"kind": "acme.iso", "version": 2, "levels": [0.10, 1e5, -0]})"),
              slice,      surface,
              projection, shells};
  return s;
}

bool sameBits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

TEST(SceneJson, ParseOfWriteIsTheSameBitForBit) {
  std::uint64_t c = 0;
  for (int n = 0; n < 200; ++n) {
    const Scene scene = randomScene(c);
    const std::string text = writeScene(scene);
    const auto back = parseScene(text);
    ASSERT_TRUE(back.ok()) << back.error().text() << "\n" << text;
    ASSERT_EQ(*back, scene) << text;
    ASSERT_EQ(writeScene(*back), text);
    const glm::dvec3 a = std::get<SliceLayer>(scene.layers[1]).plane.normal.v;
    const glm::dvec3 b = std::get<SliceLayer>(back->layers[1]).plane.normal.v;
    for (int k = 0; k < 3; ++k) ASSERT_TRUE(sameBits(a[k], b[k])) << a[k];
  }
}

TEST(SceneJson, SurfacesAreCheckedWithTheirPath) {
  const auto surface = [](const std::string& keys) {
    return whereOf(withLayer(R"({"kind": "surface", "source": "a.stl")" + keys + "}"));
  };
  EXPECT_EQ(surface(""), "ok");
  EXPECT_EQ(surface(R"(, "pose": [1,0,0,5, 0,1,0,6, 0,0,1,7, 0,0,0,1])"), "ok");
  EXPECT_EQ(surface(R"(, "pose": [1,0,0,5, 0,1,0,6, 0,0,1,7])"), "/layers/0/pose");
  EXPECT_EQ(surface(R"(, "pose": [1,0,0,0, 0,1,0,0, 0,0,1,0, 5,6,7,1])"),
            "/layers/0/pose");  // column by column
  EXPECT_EQ(surface(R"(, "pose": [1,0,0,5, 0,1,0,6, 1,1,0,7, 0,0,0,1])"), "/layers/0/pose");  // flat
  EXPECT_EQ(surface(R"(, "pose": [1,0,0,5, 0,1,0,6, 0,0,"1",7, 0,0,0,1])"), "/layers/0/pose/10");
  EXPECT_EQ(surface(R"(, "opacity": 1.5)"), "/layers/0/opacity");
  EXPECT_EQ(surface(R"(, "opacity": -0.1)"), "/layers/0/opacity");
  EXPECT_EQ(surface(R"(, "colour": [1, 0, 2])"), "/layers/0/colour/2");
  EXPECT_EQ(surface(R"(, "color": [1, 0, 0])"), "/layers/0/color");
  EXPECT_EQ(whereOf(withLayer(R"({"kind": "surface"})")), "/layers/0");
  EXPECT_EQ(whereOf(withCamera(R"({"near_mm": -1})")), "/camera/near_mm");
  EXPECT_EQ(whereOf(withCamera(R"({"target_mm": [1, 2]})")), "/camera/target_mm");
  const auto scene = parseScene(
      withLayer(R"({"kind": "surface", "source": "a.stl", "pose": [1,2,3,5, 0,1,4,6, 0,0,1,7, 0,0,0,1]})"));
  ASSERT_TRUE(scene.ok());
  EXPECT_EQ(std::get<SurfaceLayer>(scene->layers[0]).pose * MeshPoint(1, 10, 100),
            PatientPoint(326, 416, 107));
}

TEST(SceneJson, MinusZeroAndExtremesSurvive) {
  const double odd[] = {-0.0,
                        0.1,
                        5e-324,
                        std::numeric_limits<double>::max(),
                        1e22,
                        123456789012345678.0,
                        -1e21,
                        1e15,
                        9007199254740993.0};
  for (double x : odd) {
    Scene s;
    s.camera.azimuth_deg = x;
    const auto back = parseScene(writeScene(s));
    ASSERT_TRUE(back.ok());
    EXPECT_TRUE(sameBits(back->camera.azimuth_deg, x)) << writeScene(s);
  }
}

TEST(SceneJson, SmallestSceneHasDefaults) {
  const auto s = parseScene(withLayer(R"({"kind": "image", "source": "a"})"));
  ASSERT_TRUE(s.ok()) << s.error().text();
  Scene expected;
  ImageLayer layer;
  layer.source = "a";
  expected.layers.emplace_back(layer);
  EXPECT_EQ(*s, expected);
}

TEST(SceneJson, UnknownAndRepeatedKeysAreRefusedWithTheirPath) {
  EXPECT_EQ(whereOf(R"({"schema": 1, "layers": [], "extra": 1})"), "/extra");
  EXPECT_EQ(whereOf(withCamera(R"({"zoon": 2})")), "/camera/zoon");
  EXPECT_EQ(whereOf(withLayer(R"({"kind": "image", "source": "a", "a/b~c": 1})")), "/layers/0/a~1b~0c");
  EXPECT_EQ(
      whereOf(withLayer(
          R"({"kind": "slice", "source": "a", "plane": {"point": [1,2,3], "normal": [0,0,1], "up": [0,1,0], "x": 0}})")),
      "/layers/0/plane/x");
  EXPECT_EQ(whereOf(withLayer(R"({"kind": "slice", "source": "a", )" + kPlane +
                              R"(, "slab": {"thickness_mm": 1, "n": 2}})")),
            "/layers/0/slab/n");
  EXPECT_EQ(
      whereOf(withLayer(R"({"kind": "image", "source": "a", "window": {"center": 1, "width": 2, "w": 3}})")),
      "/layers/0/window/w");
  EXPECT_EQ(whereOf(withLayer(R"({"kind": "image", "source": "a", "source": "b"})")), "/layers/0/source");
  EXPECT_EQ(whereOf(withLayer(R"({"kind": "x", "deep": [0, {"k": 1, "k": 1}]})")), "/layers/0/deep/1/k");
}

TEST(SceneJson, WrongTypesAndValuesAreRefusedWithTheirPath) {
  EXPECT_EQ(whereOf("[]"), "");
  EXPECT_EQ(whereOf("7"), "");
  EXPECT_EQ(whereOf(R"({"layers": []})"), "");
  EXPECT_EQ(whereOf(R"({"schema": 1})"), "");
  EXPECT_EQ(whereOf(R"({"schema": 1, "layers": {}})"), "/layers");
  EXPECT_EQ(whereOf(R"({"schema": 1, "background": [0, 0, 1.5], "layers": []})"), "/background/2");
  EXPECT_EQ(whereOf(withCamera("[]")), "/camera");
  EXPECT_EQ(whereOf(withCamera(R"({"zoom": "2"})")), "/camera/zoom");
  EXPECT_EQ(whereOf(withCamera(R"({"zoom": null})")), "/camera/zoom");
  EXPECT_EQ(whereOf(withCamera(R"({"zoom": 0})")), "/camera/zoom");
  EXPECT_EQ(whereOf(withCamera(R"({"height_mm": -1})")), "/camera/height_mm");
  EXPECT_EQ(whereOf(withCamera(R"({"fov_deg": 180})")), "/camera/fov_deg");
  EXPECT_EQ(whereOf(withCamera(R"({"pan_mm": [1]})")), "/camera/pan_mm");
  EXPECT_EQ(whereOf(withCamera(R"({"pan_mm": [1, "x"]})")), "/camera/pan_mm/1");
  EXPECT_EQ(whereOf(withCamera(R"({"projection": "fisheye"})")), "/camera/projection");
  EXPECT_EQ(whereOf(withLayer("3")), "/layers/0");
  EXPECT_EQ(whereOf(withLayer(R"({"kind": 3})")), "/layers/0/kind");
  EXPECT_EQ(whereOf(withLayer(R"({"kind": ""})")), "/layers/0/kind");
  EXPECT_EQ(whereOf(withLayer(R"({"kind": "image"})")), "/layers/0");
  EXPECT_EQ(whereOf(withLayer(R"({"kind": "image", "source": "a", "index": -1})")), "/layers/0/index");
  EXPECT_EQ(whereOf(withLayer(R"({"kind": "image", "source": "a", "index": 1.5})")), "/layers/0/index");
  EXPECT_EQ(whereOf(withLayer(R"({"kind": "image", "source": "a", "index": 18446744073709551615})")),
            "/layers/0/index");
  EXPECT_EQ(whereOf(withLayer(R"({"kind": "image", "source": "a", "invert": 1})")), "/layers/0/invert");
  EXPECT_EQ(whereOf(withLayer(R"({"kind": "image", "source": "a", "window": {"center": 1, "width": 0}})")),
            "/layers/0/window/width");
  EXPECT_EQ(
      whereOf(withLayer(
          R"({"kind": "slice", "source": "a", "plane": {"point": [1,2,3], "normal": [0,1], "up": [0,1,0]}})")),
      "/layers/0/plane/normal");
  EXPECT_EQ(whereOf(withLayer(R"({"kind": "slice", "source": "a", )" + kPlane +
                              R"(, "slab": {"thickness_mm": -1}})")),
            "/layers/0/slab/thickness_mm");
  EXPECT_EQ(whereOf(withLayer(R"({"kind": "x", "version": "new"})")), "/layers/0/version");
  EXPECT_EQ(whereOf(withLayer(R"({"kind": "image", "source": "a", "interpolation": "cubic"})")),
            "/layers/0/interpolation");  // stored frames are not resampled
  EXPECT_EQ(
      whereOf(withLayer(R"({"kind": "slice", "source": "a", )" + kPlane + R"(, "interpolation": "cubic"})")),
      "ok");
}

TEST(SceneJson, CurvedLayersAreReadAndRefusedWithTheirPath) {
  const auto curved = [](const std::string& rest) {
    return whereOf(withLayer(R"({"kind": "curved", "source": "a", )" + rest + "}"));
  };
  EXPECT_EQ(curved(R"("path": [[1, 2, 3], [4, 5, 6]])"), "ok");
  EXPECT_EQ(curved(R"("width_mm": 5)"), "/layers/0");  // no path
  EXPECT_EQ(curved(R"("path": {"x": 1})"), "/layers/0/path");
  EXPECT_EQ(curved(R"("path": [[1, 2, 3], 4])"), "/layers/0/path/1");
  EXPECT_EQ(curved(R"("path": [[1, 2, 3], [4, 5]])"), "/layers/0/path/1");
  EXPECT_EQ(curved(R"("path": [[1, "2", 3], [4, 5, 6]])"), "/layers/0/path/0");
  EXPECT_EQ(curved(R"("path": [[1, 2, null], [4, 5, 6]])"), "/layers/0/path/0");
  EXPECT_EQ(curved(R"("path": [[1, 2, 3], [4, 5, 6]], "form": "bent")"), "/layers/0/form");
  EXPECT_EQ(curved(R"("path": [[1, 2, 3], [4, 5, 6]], "up": [1, 2])"), "/layers/0/up");
  EXPECT_EQ(curved(R"("path": [[1, 2, 3], [4, 5, 6]], "width_mm": 0)"), "/layers/0/width_mm");
  EXPECT_EQ(curved(R"("path": [[1, 2, 3], [4, 5, 6]], "plane": {})"), "/layers/0/plane");
  std::string many;
  for (int n = 0; n < 65537; ++n) many += n > 0 ? ",[0,0,0]" : "[0,0,0]";
  EXPECT_EQ(curved("\"path\": [" + many + "]"), "/layers/0/path");
  EXPECT_FALSE(customLayer(R"({"kind": "curved"})").ok());

  const auto points = parsePath("[[1, 2, 3], [4, 5.5, -6e1]]");
  ASSERT_TRUE(points.ok());
  EXPECT_EQ(*points, (std::vector<PatientPoint>{{1, 2, 3}, {4, 5.5, -60}}));
  for (const char* bad : {"", "{}", "7", "[1, 2, 3]", "[[1, 2, 3], [4, 5, 1e999]]", "[[1,2,3]"})
    EXPECT_FALSE(parsePath(bad).ok()) << bad;
}

TEST(SceneJson, NotANumberAndInfinityAreRefused) {
  EXPECT_EQ(whereOf(withCamera(R"({"zoom": NaN})")), "/camera/zoom");
  EXPECT_EQ(whereOf(withCamera(R"({"zoom": Infinity})")), "/camera/zoom");
  EXPECT_EQ(whereOf(withCamera(R"({"zoom": 1e999})")), "/camera/zoom");
  for (double x : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    Scene s;
    s.camera.pan_mm.y = x;
    EXPECT_EQ(whereOf(writeScene(s)), "/camera/pan_mm/1");
  }
}

TEST(SceneJson, SyntaxErrorsSayWhere) {
  for (const char* bad :
       {"", "{", "nonsense", R"({"schema": 1,})", R"({"schema": 1, "layers": [] } x)", "{\"a\": \"\xFF\"}"})
    EXPECT_NE(whereOf(bad), "ok") << bad;
  const auto e = parseScene(R"({"schema": 1, "camera": {"zoom" 3}, "layers": []})");
  ASSERT_FALSE(e.ok());
  EXPECT_EQ(e.error().where, "/camera/zoom");
  EXPECT_THAT(e.error().sentence, HasSubstr("byte"));
  EXPECT_EQ(whereOf("\xEF\xBB\xBF" + withLayer(R"({"kind": "x"})")), "ok") << "a byte order mark is skipped";
}

TEST(SceneJson, NewerSchemaIsSaidBeforeItsKeys) {
  const auto e = parseScene(R"({"schema": 2, "novel": true, "layers": []})");
  ASSERT_FALSE(e.ok());
  EXPECT_EQ(e.error().where, "/schema");
  EXPECT_THAT(e.error().sentence, HasSubstr("newer"));
  EXPECT_EQ(whereOf(R"({"schema": 0, "layers": []})"), "/schema");
  EXPECT_EQ(whereOf(R"({"schema": "1", "layers": []})"), "/schema");
}

TEST(SceneJson, LimitsHoldBeforeAnythingIsBuilt) {
  const std::string deep = std::string(1000000, '[') + std::string(1000000, ']');
  EXPECT_EQ(whereOf(deep), "");
  EXPECT_EQ(whereOf(withLayer(R"({"kind": "x", "a": )" + std::string(29, '[') + std::string(29, ']') + "}")),
            "ok");
  EXPECT_EQ(whereOf(withLayer(R"({"kind": "x", "a": )" + std::string(30, '[') + std::string(30, ']') + "}")),
            "");
  EXPECT_EQ(whereOf(withLayer(R"({"kind": "x", "a": "[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[\"[["})")), "ok");
  const auto huge = parseScene(std::string(kMaxSceneBytes + 1, ' '));
  ASSERT_FALSE(huge.ok());
  EXPECT_THAT(huge.error().sentence, HasSubstr("16777217"));
  std::string many = R"({"kind": "x"})";
  for (std::size_t n = 1; n < kMaxSceneLayers; ++n) many += R"(, {"kind": "x"})";
  EXPECT_EQ(whereOf(withLayer(many)), "ok");
  EXPECT_EQ(whereOf(withLayer(many + R"(, {"kind": "x"})")), "/layers");
}

TEST(SceneJson, UnknownKindsAreKeptTokenByToken) {
  const std::string layer =
      R"({"z":[0.10,1E+5,-0,12345678901234567890123],"kind":"acme.flow","version":7,"t":"a \" ] } \u00e4 b","n":null})";
  const auto s = parseScene(withLayer("\n  " + layer + " ,\n" + R"({ "kind" : "x" })"));
  ASSERT_TRUE(s.ok()) << s.error().text();
  EXPECT_EQ(std::get<CustomLayer>(s->layers[0]), (CustomLayer{"acme.flow", 7, layer}));
  EXPECT_EQ(std::get<CustomLayer>(s->layers[1]), (CustomLayer{"x", 1, R"({"kind":"x"})"}));
  EXPECT_THAT(writeScene(*s), HasSubstr(layer));
  EXPECT_EQ(*parseScene(writeScene(*s)), *s);
  // "layers" as a value or inside another object does not mislead.
  const auto odd = parseScene(R"({"layers": [{"kind": "y", "layers": [1]}], "schema": 1})");
  ASSERT_TRUE(odd.ok());
  EXPECT_EQ(std::get<CustomLayer>(odd->layers[0]).json, R"({"kind":"y","layers":[1]})");
}

TEST(SceneJson, CustomLayersAreChecked) {
  EXPECT_EQ(customLayer(R"( {"kind" : "k" , "version": 2} )")->json, R"({"kind":"k","version":2})");
  EXPECT_FALSE(customLayer(R"({"kind": "slice"})").ok());
  EXPECT_FALSE(customLayer("[1]").ok());
  EXPECT_FALSE(customLayer("{").ok());
}

TEST(SceneJson, LocaleDoesNotMatter) {
  const std::string before = std::setlocale(LC_ALL, nullptr);
  // Where no locale with a decimal comma is installed the C locale is checked.
  if (std::setlocale(LC_ALL, "de_DE.UTF-8") == nullptr) std::setlocale(LC_ALL, "C");
  Scene s;
  s.camera.zoom = 1.5;
  const auto back = parseScene(writeScene(s));
  std::setlocale(LC_ALL, before.c_str());
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(back->camera.zoom, 1.5);
}

}  // namespace
}  // namespace vernier
