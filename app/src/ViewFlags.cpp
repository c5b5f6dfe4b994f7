// SPDX-License-Identifier: GPL-3.0-or-later
// The options that say what to draw, as the command line has them.
#include "LensOptions.h"
#include "OptionChecks.h"
#include "RenderingOptions.h"
#include "ViewOptions.h"
#include "VolumeOptions.h"

namespace vernier::app {

void addViewOptions(CLI::App& sub, ViewOptions& o) {
  sub.add_option("INPUT", o.inputs,
                 "Files, folders or ZIP archives: DICOM, NIfTI, NRRD, MetaImage, VTI, raw, lists of images; "
                 "or surface "
                 "files alone")
      ->required();
  auto* view =
      sub.add_option("--view", o.view,
                     "stack axial coronal sagittal oblique slab curved; through the volume: mip minip sum "
                     "mean attenuation shells shells-sum shells-lit dvr dvr-shaded iso lens");
  sub.add_option("--scene", o.sceneFile, "Scene as JSON (docs/scene.md)")->excludes(view);
  sub.add_option("--surface", o.surfaces,
                 "A surface file (docs/surfaces.md), mm: an outline on slices, alone in 3-D, or as the scene "
                 "has it (repeatable)");
  sub.add_option("--series", o.series,
                 "Series Instance UID, volume file or number in `vernier info`, #2 for a second stack");
  sub.add_option("--frame", o.frame, "Of a 4-D volume file: which volume, counted from 0");
  sub.add_option("--z-span", o.zSpan,
                 "Of a list of images: length that all slices span, as of the pixel size (mm)")
      ->check(finiteAboveZero());
  sub.add_option("--size", o.size, "Picture, WxH pixels")->capture_default_str();
  sub.add_option("--camera", o.camera,
                 "azimuth=30,elevation=20,projection=orthographic,fov=30,zoom=1,roll=0,distance=400,near=0");
  sub.add_option("--plane", o.plane,
                 "point=x,y,z,normal=x,y,z,up=x,y,z or from=x,y,z,to=x,y,z,up=x,y,z in patient mm");
  sub.add_option("--slice", o.slice, "Slice, counted from 0 along the view's axis (absent: the middle)");
  sub.add_option("--slab", o.slab_mm, "Slab thickness in mm, centred on the plane")
      ->check(finiteFrom(0, 1e5));
  sub.add_option("--slab-mode", o.slabMode, "max min mean (absent: max)")
      ->check(CLI::IsMember({"max", "min", "mean"}));
  sub.add_option("--interpolation", o.interpolation, "nearest linear cubic (absent: linear)")
      ->check(CLI::IsMember({"nearest", "linear", "cubic"}));
  sub.add_option("--path", o.path,
                 "View curved: x,y,z;x,y,z;... in patient mm, or a .json file of such points");
  sub.add_option("--width", o.width_mm, "View curved: width of the sheet in mm (absent: 50)")
      ->check(finiteAboveZero());
  sub.add_option("--form", o.form, "View curved: straightened stretched (absent: straightened)")
      ->check(CLI::IsMember({"straightened", "stretched"}));
  sub.add_option("--path-up", o.pathUp,
                 "View curved: up at the path's beginning (stretched: everywhere), x,y,z");
  addVolumeFlags(sub, o.volume);
  addRenderingFlags(sub, o.rendering);
  addLensFlags(sub, o.lens);
  auto* window = sub.add_option("--window", o.window, "CENTER,WIDTH in modality values (HU for CT)");
  sub.add_option(
         "--preset", o.preset,
         "A window: brain subdural stroke lung bone abdomen mediastinum liver; views dvr..: a transfer "
         "function: ct ct-bone ct-soft ct-lung ct-angio mr mr-angio ramp")
      ->excludes(window);
  sub.add_option(
      "--presentation", o.presentation,
      "Presentation state to apply to a stored frame: SOP Instance UID or number in `vernier info`");
  sub.add_option("--engine", o.engine, "auto gl native")->check(CLI::IsMember({"auto", "gl", "native"}));
  sub.add_option("--technique", o.technique, "A technique by name, as in `vernier plugins`");
  sub.add_option("--quality", o.quality, "draft review reference")
      ->check(CLI::IsMember({"draft", "review", "reference"}))
      ->capture_default_str();
  sub.add_option("--max-error", o.maxError,
                 "Largest error wanted, in levels of 255; exit 4 when it is not reached")
      ->check(finiteAboveZero());
  sub.add_option(
         "--step", o.step,
         "First sampling step along rays, in smallest voxel spacings (absent: 1); draft keeps it, review "
         "and reference halve it until their goal is met")
      ->check(CLI::Range(1.0 / 32, 1.0));
  sub.add_option("--min-fps", o.minFps,
                 "Frames per second wanted; goes before accuracy, but at reference and with --max-error")
      ->check(finiteAboveZero());
  sub.add_option("--error-samples", o.errorSamples, "Pixels that the error is measured at")
      ->check(CLI::Range(1, 100'000'000))
      ->capture_default_str();
  sub.add_option("--seed", o.seed, "Seed of the error's sample")
      ->check(wholeNumber64())
      ->capture_default_str();
  sub.add_flag("--no-error", o.noError, "Do not measure the error")->excludes("--max-error");
  sub.add_flag("--bridge-gaps", o.bridge, "Interpolate across missing slices; the picture says so");
}

}  // namespace vernier::app
