// SPDX-License-Identifier: GPL-3.0-or-later
// The options that say what to draw, shared by render, bench and sheet; and their translation into a Scene.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "Cli.h"
#include "vernier/plan/Presets.h"

namespace vernier::app {

// Of the views that look through a volume.
struct VolumeOptions {
  std::string levels, spread;  // "" = not given
  std::optional<double> beta0, betaM, a, b, cue, gain_perMm;
};

// Of the views dvr, dvr-shaded and iso.
struct RenderingOptions {
  std::string transfer, mode, classification, opacity, gains, shading, combiner;  // "" = not given
  std::optional<double> iso;
  std::vector<std::string> lights;
};

// What is put into the scene of any view that a lens can look into.
struct LensOptions {
  std::vector<std::string> lenses;
  std::string inner;  // "" = not given
};

struct ViewOptions {
  std::vector<std::string> inputs, surfaces;
  std::string view, sceneFile, series;
  std::string sceneText;  // what sceneFile holds, where it has been read already
  std::string size = "512x512", camera, plane, slabMode, window, preset, interpolation,
              presentation;  // "" = not given
  std::optional<std::int64_t> slice, frame;
  std::optional<double> slab_mm, zSpan;
  std::string path, form, pathUp;  // of the view curved
  std::optional<double> width_mm;
  VolumeOptions volume;
  RenderingOptions rendering;
  LensOptions lens;
  std::string engine, technique, quality = "review";
  std::optional<double> maxError, minFps, step;
  int errorSamples = 1024;
  std::uint64_t seed = 1;
  bool noError = false, bridge = false;
};

void addViewOptions(CLI::App&, ViewOptions&);

struct RenderRequest {
  Scene scene;
  View view;
  Quality quality;
  RenderOptions options;
  std::string viewName;  // "" when a scene file was given
};

// The parts, each with its own OptionInvalid sentence.
Result<glm::ivec2> parseSize(const std::string&);
Result<VoiWindow> parseWindow(const std::string& centerWidth);
Result<VoiWindow> windowPreset(const std::string& name, const std::string& unit);
Result<Camera> parseCamera(const std::string&);
Result<Plane> parsePlane(const std::string&);
// "x,y,z;x,y,z;..." in patient mm, or the name of a JSON file that holds a list of such points.
Result<std::vector<PatientPoint>> parsePathOption(const std::string&);

// The session has been opened; chooses the series and builds what the presets need.
Result<RenderRequest> makeRequest(Session&, const ViewOptions&, const Settings&, const ProgressFn&,
                                  std::stop_token);

}  // namespace vernier::app
