// SPDX-License-Identifier: GPL-3.0-or-later
#include "SceneReader.h"

#include <limits>

#include "vernier/plan/CurvedGeometry.h"

namespace vernier {
namespace {

constexpr Name<VoiFunction> kFunctions[] = {{VoiFunction::Linear, "linear"},
                                            {VoiFunction::LinearExact, "linear_exact"},
                                            {VoiFunction::Sigmoid, "sigmoid"}};
constexpr Name<Interpolation> kInterpolations[] = {
    {Interpolation::Nearest, "nearest"}, {Interpolation::Linear, "linear"}, {Interpolation::Cubic, "cubic"}};
constexpr Name<CurvedForm> kCurvedForms[] = {{CurvedForm::Straightened, "straightened"},
                                             {CurvedForm::Stretched, "stretched"}};
constexpr Name<SlabMode> kSlabModes[] = {
    {SlabMode::Max, "max"}, {SlabMode::Min, "min"}, {SlabMode::Mean, "mean"}};
constexpr Name<Projection> kProjections[] = {{Projection::Orthographic, "orthographic"},
                                             {Projection::Perspective, "perspective"}};

Plane readPlane(const nlohmann::json& value, const std::string& path) {
  const ObjectReader o(value, path);
  const auto vec = [&](const char* key) {
    const std::array<double, 3> v = o.numbers<3>(key);
    return glm::dvec3(v[0], v[1], v[2]);
  };
  const Plane plane{PatientPoint(vec("point")), PatientVec(vec("normal")), PatientVec(vec("up"))};
  o.refuseOthers();
  return plane;
}

Slab readSlab(const nlohmann::json& value, const std::string& path) {
  const ObjectReader o(value, path);
  Slab slab;
  slab.thickness_mm = o.number("thickness_mm");
  if (slab.thickness_mm < 0) throw JsonFault{"A slab cannot be thinner than 0 mm.", o.pathOf("thickness_mm")};
  if (o.has("mode")) slab.mode = choice(o, "mode", kSlabModes);
  o.refuseOthers();
  return slab;
}

}  // namespace

const char* nameOf(VoiFunction v) { return nameIn(kFunctions, v); }
const char* nameOf(Interpolation v) { return nameIn(kInterpolations, v); }
const char* nameOf(CurvedForm v) { return nameIn(kCurvedForms, v); }
const char* nameOf(SlabMode v) { return nameIn(kSlabModes, v); }
const char* nameOf(Projection v) { return nameIn(kProjections, v); }

ObjectReader::ObjectReader(const nlohmann::json& object, std::string path)
    : object_(object), path_(std::move(path)) {
  if (!object.is_object())
    throw JsonFault{std::string("An object is expected here, not ") + object.type_name() + ".", path_};
}

const nlohmann::json& ObjectReader::child(const std::string& key) const {
  read_.insert(key);
  const auto found = object_.find(key);
  if (found == object_.end()) throw JsonFault{"The key '" + key + "' is missing here.", path_};
  return *found;
}

const nlohmann::json& ObjectReader::array(const std::string& key) const {
  const nlohmann::json& v = child(key);
  if (!v.is_array())
    throw JsonFault{std::string("A list is expected here, not ") + v.type_name() + ".", pathOf(key)};
  return v;
}

double ObjectReader::number(const std::string& key) const {
  const nlohmann::json& v = child(key);
  if (!v.is_number())
    throw JsonFault{std::string("A number is expected here, not ") + v.type_name() + ".", pathOf(key)};
  return v.get<double>();
}

std::int64_t ObjectReader::integer(const std::string& key, std::int64_t least, std::int64_t most) const {
  const nlohmann::json& v = child(key);
  const bool tooLarge =
      v.is_number_unsigned() &&
      v.get<std::uint64_t>() > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  if (!v.is_number_integer() || tooLarge || v.get<std::int64_t>() < least || v.get<std::int64_t>() > most)
    throw JsonFault{
        "A whole number from " + std::to_string(least) + " to " + std::to_string(most) + " is expected here.",
        pathOf(key)};
  return v.get<std::int64_t>();
}

bool ObjectReader::flag(const std::string& key) const {
  const nlohmann::json& v = child(key);
  if (!v.is_boolean())
    throw JsonFault{std::string("true or false is expected here, not ") + v.type_name() + ".", pathOf(key)};
  return v.get<bool>();
}

std::string ObjectReader::text(const std::string& key) const {
  const nlohmann::json& v = child(key);
  if (!v.is_string())
    throw JsonFault{std::string("Text is expected here, not ") + v.type_name() + ".", pathOf(key)};
  return v.get<std::string>();
}

void ObjectReader::readNumbers(const std::string& key, double* out, std::size_t n) const {
  const nlohmann::json& v = array(key);
  if (v.size() != n)
    throw JsonFault{"A list of " + std::to_string(n) + " numbers is expected here, not of " +
                        std::to_string(v.size()) + ".",
                    pathOf(key)};
  for (std::size_t i = 0; i < n; ++i) {
    if (!v[i].is_number())
      throw JsonFault{std::string("A number is expected here, not ") + v[i].type_name() + ".",
                      pointerTo(pathOf(key), i)};
    out[i] = v[i].get<double>();
  }
}

void ObjectReader::refuseOthers() const {
  for (const auto& item : object_.items())
    if (!read_.contains(item.key()))
      throw JsonFault{
          "The key '" + item.key() + "' is not known here; see docs/scene.md for the keys there are.",
          pathOf(item.key())};
}

std::string kindAt(const nlohmann::json& layer, const std::string& path) {
  const std::string kind = ObjectReader(layer, path).text("kind");
  if (kind.empty()) throw JsonFault{"The kind of a layer cannot be empty.", pointerTo(path, "kind")};
  return kind;
}

void checkSchema(const ObjectReader& top) {
  const std::int64_t schema = top.integer("schema", 1, std::numeric_limits<std::int64_t>::max());
  if (schema > kSceneSchema)
    throw JsonFault{"The scene has schema " + std::to_string(schema) + ", this program reads up to " +
                        std::to_string(kSceneSchema) + "; open it with a newer Vernier.",
                    "/schema"};
}

Camera readCamera(const nlohmann::json& value, const std::string& path) {
  const ObjectReader o(value, path);
  Camera c;
  if (o.has("azimuth_deg")) c.azimuth_deg = o.number("azimuth_deg");
  if (o.has("elevation_deg")) c.elevation_deg = o.number("elevation_deg");
  if (o.has("roll_deg")) c.roll_deg = o.number("roll_deg");
  if (o.has("projection")) c.projection = choice(o, "projection", kProjections);
  if (o.has("fov_deg")) c.fov_deg = above0(o, "fov_deg");
  if (c.fov_deg >= 180) throw JsonFault{"The field of view must be below 180 degrees.", o.pathOf("fov_deg")};
  if (o.has("zoom")) c.zoom = above0(o, "zoom");
  if (o.has("height_mm")) c.height_mm = above0(o, "height_mm");
  if (o.has("pan_mm")) {
    const std::array<double, 2> pan = o.numbers<2>("pan_mm");
    c.pan_mm = {pan[0], pan[1]};
  }
  if (o.has("target_mm")) {
    const std::array<double, 3> target = o.numbers<3>("target_mm");
    c.target = PatientPoint(target[0], target[1], target[2]);
  }
  if (o.has("distance_mm")) c.distance_mm = o.number("distance_mm");
  if (o.has("near_mm")) c.near_mm = o.number("near_mm");
  if (c.near_mm < 0) throw JsonFault{"The near distance cannot be below 0.", o.pathOf("near_mm")};
  o.refuseOthers();
  return c;
}

Interpolation readInterpolation(const ObjectReader& object, const std::string& key) {
  return choice(object, key, kInterpolations);
}

double above0(const ObjectReader& object, const std::string& key) {
  const double x = object.number(key);
  if (!(x > 0)) throw JsonFault{"The number must be above 0.", object.pathOf(key)};
  return x;
}

VoiWindow readWindow(const nlohmann::json& value, const std::string& path) {
  const ObjectReader o(value, path);
  VoiWindow w;
  w.center = o.number("center");
  w.width = above0(o, "width");
  if (o.has("function")) w.function = choice(o, "function", kFunctions);
  if (o.has("explanation")) w.explanation = o.text("explanation");
  o.refuseOthers();
  return w;
}

Rgb readRgb(const ObjectReader& object, const std::string& key) {
  const std::array<double, 3> v = object.numbers<3>(key);
  for (std::size_t i = 0; i < 3; ++i)
    if (v[i] < 0 || v[i] > 1)
      throw JsonFault{"A colour lies between 0 and 1.", pointerTo(object.pathOf(key), i)};
  return {v[0], v[1], v[2]};
}

ImageLayer readImage(const nlohmann::json& value, const std::string& path) {
  const ObjectReader o(value, path);
  ImageLayer l;
  o.text("kind");
  l.source = o.text("source");
  if (o.has("index")) l.index = o.integer("index", 0, std::numeric_limits<std::int64_t>::max());
  if (o.has("window")) l.window = readWindow(o.child("window"), o.pathOf("window"));
  if (o.has("voi_lut")) l.voiLut = static_cast<int>(o.integer("voi_lut", 0, std::numeric_limits<int>::max()));
  if (o.has("interpolation")) l.interpolation = choice(o, "interpolation", kInterpolations);
  if (l.interpolation == Interpolation::Cubic)
    throw JsonFault{"Stored frames are shown with nearest or linear; cubic is for slices of a volume.",
                    o.pathOf("interpolation")};
  if (o.has("invert")) l.invert = o.flag("invert");
  if (o.has("flip_horizontal")) l.flipHorizontal = o.flag("flip_horizontal");
  if (o.has("flip_vertical")) l.flipVertical = o.flag("flip_vertical");
  if (o.has("presentation")) l.presentation = o.text("presentation");
  o.refuseOthers();
  return l;
}

// Sixteen numbers, row by row, the last row 0 0 0 1.
PatientFromMesh readPose(const ObjectReader& o, const std::string& key) {
  const std::array<double, 16> m = o.numbers<16>(key);
  if (m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] != 1)
    throw JsonFault{"The last row of a pose is 0 0 0 1; the numbers stand row by row.", o.pathOf(key)};
  PatientFromMesh pose;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      pose.linear[column][row] = m[static_cast<std::size_t>(4 * row + column)];
    pose.translation[row] = m[static_cast<std::size_t>(4 * row + 3)];
  }
  if (const Result<void> ok = checkPose(pose); !ok) throw JsonFault{ok.error().sentence, o.pathOf(key)};
  return pose;
}

SurfaceLayer readSurfaceLayer(const nlohmann::json& value, const std::string& path) {
  const ObjectReader o(value, path);
  SurfaceLayer l;
  o.text("kind");
  l.source = o.text("source");
  if (o.has("pose")) l.pose = readPose(o, "pose");
  if (o.has("colour")) l.colour = readRgb(o, "colour");
  if (o.has("opacity")) l.opacity = o.number("opacity");
  if (!(l.opacity >= 0 && l.opacity <= 1))
    throw JsonFault{"The opacity lies between 0 and 1.", o.pathOf("opacity")};
  o.refuseOthers();
  return l;
}

SliceLayer readSlice(const nlohmann::json& value, const std::string& path) {
  const ObjectReader o(value, path);
  SliceLayer l;
  o.text("kind");
  l.source = o.text("source");
  l.plane = readPlane(o.child("plane"), o.pathOf("plane"));
  if (o.has("slab")) l.slab = readSlab(o.child("slab"), o.pathOf("slab"));
  if (o.has("interpolation")) l.interpolation = choice(o, "interpolation", kInterpolations);
  if (o.has("window")) l.window = readWindow(o.child("window"), o.pathOf("window"));
  if (o.has("invert")) l.invert = o.flag("invert");
  o.refuseOthers();
  return l;
}

std::vector<PatientPoint> readPoints(const nlohmann::json& list, const std::string& path) {
  if (!list.is_array())
    throw JsonFault{std::string("A list of points is expected here, not ") + list.type_name() + ".", path};
  if (list.size() > kMostPathPoints)
    throw JsonFault{"The path has " + std::to_string(list.size()) + " points, at most " +
                        std::to_string(kMostPathPoints) + " are read.",
                    path};
  std::vector<PatientPoint> points;
  for (std::size_t n = 0; n < list.size(); ++n) {
    const nlohmann::json& p = list[n];
    const auto number = [&](std::size_t i) { return p[i].is_number(); };
    if (!p.is_array() || p.size() != 3 || !number(0) || !number(1) || !number(2))
      throw JsonFault{"A point is a list of three numbers, mm in the patient.", pointerTo(path, n)};
    points.emplace_back(p[0].get<double>(), p[1].get<double>(), p[2].get<double>());
  }
  return points;
}

CurvedLayer readCurved(const nlohmann::json& value, const std::string& path) {
  const ObjectReader o(value, path);
  CurvedLayer l;
  o.text("kind");
  l.source = o.text("source");
  l.path = readPoints(o.child("path"), o.pathOf("path"));
  if (o.has("form")) l.form = choice(o, "form", kCurvedForms);
  if (o.has("up")) {
    const std::array<double, 3> up = o.numbers<3>("up");
    l.up = PatientVec(up[0], up[1], up[2]);
  }
  if (o.has("width_mm")) l.width_mm = above0(o, "width_mm");
  if (o.has("slab")) l.slab = readSlab(o.child("slab"), o.pathOf("slab"));
  if (o.has("interpolation")) l.interpolation = choice(o, "interpolation", kInterpolations);
  if (o.has("window")) l.window = readWindow(o.child("window"), o.pathOf("window"));
  if (o.has("invert")) l.invert = o.flag("invert");
  o.refuseOthers();
  return l;
}

}  // namespace vernier
