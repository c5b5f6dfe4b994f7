// SPDX-License-Identifier: GPL-3.0-or-later
// Edits of a Scene by hand: scroll, window, pan, zoom, turn. Pure functions: a scene in, a scene out. Pixels
// are those of the picture, x to the right, y down. Drags are given as the whole way from where the button
// went down and applied to the scene of that moment, so that going back undoes them exactly.
#pragma once
#include <optional>

#include "vernier/plan/Scene.h"

namespace vernier::ui {

// The layer that edits speak to: the topmost image or slice.
const ImageLayer* imageOf(const Scene&);
const SliceLayer* sliceOf(const Scene&);
// The topmost layer that looks through a volume; its picture is a 3-D one, with a camera.
const Layer* lookOf(const Scene&);
// Slices and looks through a volume cannot be drawn before it has been built; single images can.
bool needsVolume(const Scene&);
// The window of an image, a slice, a projection or of shells; nullptr: the layer has none.
std::optional<VoiWindow>* windowOf(Layer&);
bool* inversionOf(Layer&);
// Every layer that reads a volume or a frame reads this one.
Scene withSource(Scene, const std::string& source);

// One notch is exactly one image of the stack; stops at its ends.
Scene scrolledImage(Scene, int notches, std::int64_t count);
// One notch goes to the next voxel slice along the view's normal (Presets.h); the plane moves along its
// normal only, so that the picture does not shift. From between two slices the first notch goes to the
// nearer one in its direction. Stops at the volume's ends.
Scene scrolledSlice(Scene, int notches, const GridGeometry&);
// The voxel slice that the plane shows, counted from 0; nullopt between slices.
std::optional<std::int64_t> sliceNumber(const SliceLayer&, const GridGeometry&);

// CLINICAL: right is wider, up is brighter; 1 unit a pixel at width 500, in proportion at others. `inverted`:
// high values are dark. `scale`: pixels of the screen for one pixel of the hand (2 at 200 %).
VoiWindow draggedWindow(const VoiWindow& from, glm::dvec2 drag_px, bool inverted, double scale = 1);
Scene withWindow(Scene, const VoiWindow&);
Scene withInversion(Scene, bool inverted);

// unit_mm: length of a pixel in the camera's unit (mm, or columns where the spacing is not known).
Scene panned(Scene, glm::dvec2 drag_px, double unit_mm);
// Up magnifies. The point that lies `fromCentre_px` from the picture's centre stays where it is.
Scene zoomed(Scene, glm::dvec2 drag_px, glm::dvec2 fromCentre_px, double unit_mm, double scale = 1);

// 3-D: the front of what is seen follows the hand, half a degree a pixel. The patient stays upright:
// elevation stops at the poles.
Scene turned(Scene, glm::dvec2 drag_px, double scale = 1);
// A transfer function dragged like a window: right spreads it, up takes it to lower values, so that more
// shows.
TransferFunction draggedTransfer(const TransferFunction& from, glm::dvec2 drag_px, double scale = 1);

// The plane moved along its normal until it holds the point.
Plane through(Plane, PatientPoint);

}  // namespace vernier::ui
