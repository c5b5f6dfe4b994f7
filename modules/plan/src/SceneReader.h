// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the known parts of a scene from parsed JSON; throws JsonFault with the path of what is wrong.
#pragma once
#include <array>
#include <set>
#include <string>

#include "JsonText.h"
#include "vernier/base/Guarded.h"
#include "vernier/plan/Scene.h"

namespace vernier {

// Reads keys of one object and remembers which, so that others can be refused.
class ObjectReader {
 public:
  ObjectReader(const nlohmann::json& object, std::string path);

  bool has(const std::string& key) const { return object_.contains(key); }
  const nlohmann::json& child(const std::string& key) const;  // required
  const nlohmann::json& array(const std::string& key) const;
  double number(const std::string& key) const;
  std::int64_t integer(const std::string& key, std::int64_t least, std::int64_t most) const;
  bool flag(const std::string& key) const;
  std::string text(const std::string& key) const;
  template <std::size_t N>
  std::array<double, N> numbers(const std::string& key) const {
    std::array<double, N> out{};
    readNumbers(key, out.data(), N);
    return out;
  }
  std::string pathOf(const std::string& key) const { return pointerTo(path_, key); }
  void refuseOthers() const;  // call last

 private:
  void readNumbers(const std::string& key, double* out, std::size_t n) const;
  const nlohmann::json& object_;
  std::string path_;
  mutable std::set<std::string> read_;
};

template <class E>
struct Name {
  E value;
  const char* name;
};
template <class E, std::size_t N>
const char* nameIn(const Name<E> (&names)[N], E value) {
  for (const Name<E>& n : names)
    if (n.value == value) return n.name;
  return names[0].name;
}
template <class E, std::size_t N>
E choice(const ObjectReader& object, const std::string& key, const Name<E> (&names)[N]) {
  const std::string given = object.text(key);
  std::string known;
  for (const Name<E>& n : names) {
    if (given == n.name) return n.value;
    known += (known.empty() ? "" : ", ") + std::string(n.name);
  }
  throw JsonFault{"'" + given + "' is none of: " + known + ".", object.pathOf(key)};
}

std::string kindAt(const nlohmann::json& layer, const std::string& path);
void checkSchema(const ObjectReader& top);
double above0(const ObjectReader&, const std::string& key);
VoiWindow readWindow(const nlohmann::json&, const std::string& path);
Interpolation readInterpolation(const ObjectReader&, const std::string& key);
Camera readCamera(const nlohmann::json&, const std::string& path);
Rgb readRgb(const ObjectReader&, const std::string& key);
ImageLayer readImage(const nlohmann::json&, const std::string& path);
std::vector<PatientPoint> readPoints(const nlohmann::json& list, const std::string& path);
CurvedLayer readCurved(const nlohmann::json&, const std::string& path);
SliceLayer readSlice(const nlohmann::json&, const std::string& path);
SurfaceLayer readSurfaceLayer(const nlohmann::json&, const std::string& path);
// SceneVolumes.cpp: what looks through a volume.
ProjectionLayer readProjection(const nlohmann::json&, const std::string& path);
ShellsLayer readShells(const nlohmann::json&, const std::string& path);
CropBox readCrop(const nlohmann::json&, const std::string& path);
std::vector<HalfSpace> readClip(const nlohmann::json&, const std::string& path);
// SceneRendering.cpp
VolumeLayer readVolume(const nlohmann::json&, const std::string& path);
IsosurfaceLayer readIsosurface(const nlohmann::json&, const std::string& path);
std::vector<Light> readLights(const nlohmann::json&, const std::string& path);
PatientFromMesh readPose(const ObjectReader&, const std::string& key);
// SceneLens.cpp
LensLayer readLens(const nlohmann::json&, const std::string& path);

// Runs a parser and turns what it throws into an Error.
template <class T, class Fn>
Result<T> parsedScene(Fn&& fn) {
  try {
    return fn();
  } catch (const JsonFault& fault) {
    return makeError(ErrorCode::SceneInvalid, fault.sentence, fault.path);
  } catch (const std::exception&) {
    return errorFromCurrentException("scene");
  }
}

const char* nameOf(VoiFunction);
const char* nameOf(Interpolation);
const char* nameOf(CurvedForm);
const char* nameOf(SlabMode);
const char* nameOf(Projection);

}  // namespace vernier
