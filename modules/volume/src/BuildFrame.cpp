// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>

#include "LossyPadding.h"
#include "Percentile.h"
#include "Range.h"
#include "StackFacts.h"
#include "VoxelAccess.h"
#include "vernier/base/Guarded.h"
#include "vernier/base/Threads.h"
#include "vernier/base/Trace.h"
#include "vernier/volume/Build.h"
#include "vernier/volume/Voi.h"

namespace vernier {
namespace {

constexpr std::size_t kSlicesForWindow = 32;

struct Pixels {
  VoxelType type = VoxelType::I16;
  Buffer buffer;
  ColourSpace colour = ColourSpace::Grey;
};

// One slice in its own container (F64 as F32).
Result<Pixels> decodeOne(const StudySet& set, SliceRef ref) {
  const FrameSpec& spec = set.instances[ref.instance].pixels;
  const auto bytes = spec.frameBytes();
  if (!bytes) return bytes.error();
  auto made = Buffer::make(static_cast<std::size_t>(*bytes));
  if (!made) return made.error();
  Pixels p{voxelTypeOf(spec.sample), std::move(made).value()};
  if (Result<void> ok = decodeSlice(set, ref, p.buffer.bytes(), &p.colour); !ok) return ok.error();
  if (spec.sample == SampleType::F64) {
    const std::size_t n = p.buffer.size() / sizeof(double);
    auto floats = Buffer::make(n * sizeof(float));
    if (!floats) return floats.error();
    const double* const from = reinterpret_cast<const double*>(p.buffer.data());
    std::transform(from, from + n, reinterpret_cast<float*>(floats->data()),
                   [](double x) { return static_cast<float>(x); });
    p.buffer = std::move(floats).value();
  }
  cleanFloats(p.type, p.buffer.data(), p.buffer.size() / bytesOf(p.type));
  return p;
}

// The frame's own place; frames without one (empty ones of a segmentation) lie where the grid says.
std::optional<FramePlane> planeOf(const Stack& stack, std::size_t slice, const SliceFacts& s) {
  const Instance& i = *s.object;
  const bool own = i.pixels.framesDeclared <= 1 || (i.frames && stack.slices[slice].frame < i.frames->size());
  if (own || stack.shape == StackShape::NoGeometry) return s.frame->plane;
  const GridGeometry& g = stack.grid;
  const glm::dvec3 at = g.even() ? glm::dvec3(0, 0, static_cast<double>(slice)) : g.sliceOrigin_vox[slice];
  const glm::dmat3& m = g.patientFromVoxel.linear;
  return FramePlane{g.patientFromVoxel * VoxelPoint(at), normalize(PatientVec(m[0])),
                    normalize(PatientVec(m[1]))};
}

// Percentiles of one frame's modality values; a modality LUT is applied first.
std::optional<Volume::Range> percentilesOf(const ImageFrameInfo& i, const std::byte* data,
                                           const std::optional<NoDataRange>& excluded) {
  const std::size_t n = static_cast<std::size_t>(i.columns * i.rows);
  if (!i.modalityLut) return percentiles1And99(i.type, {{data, n, i.rescale}}, excluded);
  std::vector<float> values;
  for (std::size_t p = 0; p < n; ++p) {
    const double stored = storedAt(i.type, data, p);
    if (!inRange(excluded, stored)) values.push_back(static_cast<float>(lookUp(*i.modalityLut, stored)));
  }
  const std::byte* const bytes = reinterpret_cast<const std::byte*>(values.data());
  return percentiles1And99(VoxelType::F32, {{bytes, values.size(), {}}}, std::nullopt);
}

// Marks in `pixels` what lossy compression has blurred and returns the padding that counts then.
std::optional<NoDataRange> markBlur(Pixels& pixels, const SliceFacts& s) {
  const Instance& i = *s.object;
  const std::optional<NoDataRange> declared = paddingOf(s);
  if (!mayBlurPadding(i, *s.frame)) return declared;
  const NoDataRange padding = declared.value_or(blurredPaddingOf(pixels.type));
  const auto changed = markBlurredPadding(
      pixels.type, pixels.buffer.data(), static_cast<std::int64_t>(i.pixels.columns),
      static_cast<std::int64_t>(i.pixels.rows), padding, leastTissue_stored(s.frame->rescale), padding.first);
  return changed > 0 ? padding : declared;
}

// Blurred padding would widen the window; the frame itself keeps its stored pixels, so a copy is marked.
std::optional<Volume::Range> percentilesWithoutBlur(const ImageFrameInfo& info, const Pixels& pixels,
                                                    const SliceFacts& s) {
  if (!mayBlurPadding(*s.object, *s.frame)) return percentilesOf(info, pixels.buffer.data(), paddingOf(s));
  auto copy = Buffer::make(pixels.buffer.size());
  if (!copy) return std::nullopt;
  std::memcpy(copy->data(), pixels.buffer.data(), pixels.buffer.size());
  Pixels marked{pixels.type, std::move(copy).value()};
  const std::optional<NoDataRange> padding = markBlur(marked, s);
  return percentilesOf(info, marked.buffer.data(), padding);
}

ImageFrameInfo describePlace(const Series& series, const Stack& stack, std::size_t slice,
                             const SliceFacts& s) {
  const Instance& i = *s.object;
  ImageFrameInfo info;
  info.columns = static_cast<std::int64_t>(i.pixels.columns);
  info.rows = static_cast<std::int64_t>(i.pixels.rows);
  info.bitsStored = i.pixels.bitsStored;
  info.modality = i.modality.empty() ? series.modality : i.modality;
  info.plane = planeOf(stack, slice, s);
  info.patientOrientation = i.patientOrientation;
  info.pixelSpacing_mm = s.frame->pixelSpacing_mm;
  info.index = static_cast<std::int64_t>(slice);
  info.count = static_cast<std::int64_t>(stack.slices.size());
  info.sopInstanceUid = i.sopInstanceUid;
  info.frameNumber = static_cast<std::int64_t>(stack.slices[slice].frame) + 1;
  info.title = series.description;
  info.findings = stack.findings;
  return info;
}

ImageFrameInfo describe(const Series& series, const Stack& stack, std::size_t slice, const SliceFacts& s,
                        const SliceFacts& windowSource) {
  const Instance& i = *s.object;
  const FrameAttributes& f = *s.frame;
  ImageFrameInfo info = describePlace(series, stack, slice, s);
  info.unscaled = f.rescaleInvalid;
  if (!info.unscaled) {
    info.rescale = f.rescale;
    if (i.modalityLut && !i.modalityLut->data.empty()) info.modalityLut = i.modalityLut;
    info.windows = windowsOf(*windowSource.frame, info.findings);
    info.voiLuts = windowSource.object->voiLuts;
    if (!f.unit.empty()) info.unit = f.unit;
  }
  if (const auto padding = paddingOf(s); padding && !liesInTissueRange(i, *padding)) info.noData = padding;
  info.inverted = isInverted(i);
  return info;
}

// A colour has neither window nor modality value; the frame says how its samples are to be read.
ImageFrameInfo describeColour(const Series& series, const Stack& stack, std::size_t slice,
                              const SliceFacts& s, const Pixels& pixels) {
  const Instance& i = *s.object;
  ImageFrameInfo info = describePlace(series, stack, slice, s);
  info.type = pixels.type;
  info.colour = pixels.colour;
  info.palette = i.palette;
  const bool jpeg2000 = syntaxKind(i.pixels.transferSyntaxUid) == SyntaxKind::Jpeg2000;
  const bool undone = !jpeg2000 && (i.photometric == "YBR_ICT" || i.photometric == "YBR_RCT");
  if (pixels.colour != i.pixels.colourSpace() || undone)
    info.findings.push_back({"photometric-contradicted",
                             Severity::Notice,
                             "The object says " + i.photometric + ", but its pixels are coded as " +
                                 (pixels.colour == ColourSpace::Rgb ? "RGB" : "YCbCr") +
                                 ", and are shown as that.",
                             {}});
  return info;
}

// The automatic window of a stack, from at most kSlicesForWindow slices spread over it.
std::optional<VoiWindow> windowOfStack(const StudySet& set, const Stack& stack) {
  const std::size_t n = stack.slices.size(), used = std::min(n, kSlicesForWindow);
  std::vector<Result<Pixels>> decoded;
  for (std::size_t k = 0; k < used; ++k) decoded.push_back(makeError(ErrorCode::Internal, ""));
  const auto refOf = [&](std::size_t k) { return stack.slices[(2 * k + 1) * n / (2 * used)]; };
  parallelFor(used, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      decoded[k] = guarded("automatic window", [&]() -> Result<Pixels> {
        const Instance& i = set.instances[refOf(k).instance];
        if (Result<void> ok = checkSingleSample(i); !ok) return ok.error();
        return decodeOne(set, refOf(k));
      });
  });
  std::vector<SliceValues> values;
  const Instance* first = nullptr;
  VoxelType type = VoxelType::I16;
  std::optional<NoDataRange> padding;
  for (std::size_t k = 0; k < used; ++k) {
    if (!decoded[k]) continue;
    const SliceFacts facts = factsOf(set, refOf(k));
    if (facts.object->modalityLut) return std::nullopt;
    if (!first) first = facts.object, type = decoded[k]->type;
    if (decoded[k]->type != type) continue;
    const std::optional<NoDataRange> here = markBlur(*decoded[k], facts);
    if (!padding) padding = here;
    values.push_back({decoded[k]->buffer.data(), decoded[k]->buffer.size() / bytesOf(type),
                      facts.frame->rescaleInvalid ? ModalityRescale{} : facts.frame->rescale});
  }
  if (!first) return std::nullopt;
  const auto range = percentiles1And99(type, values, padding);
  if (!range) return std::nullopt;
  return windowOver(range, leastWidth(type, values.front().rescale));
}

Result<std::shared_ptr<const ImageFrame>> build(const StudySet& set, const Series& series, const Stack& stack,
                                                std::size_t slice, const std::optional<VoiWindow>& known) {
  const TraceSpan span("build frame");
  if (slice >= stack.slices.size())
    return makeError(ErrorCode::OptionInvalid, "The stack has " + std::to_string(stack.slices.size()) +
                                                   " images; number " + std::to_string(slice) +
                                                   " is not one of them.");
  for (const SliceRef& s : stack.slices)
    if (s.instance >= set.instances.size())
      return makeError(ErrorCode::Internal, "The stack names an object that is not in the study.");
  const SliceRef ref = stack.slices[slice];
  const Instance& i = set.instances[ref.instance];
  if (Result<void> ok = checkImage(i); !ok) return ok.error();
  Result<Pixels> pixels = decodeOne(set, ref);
  if (!pixels) return pixels.error();
  if (isColour(pixels->colour))
    return ImageFrame::make(describeColour(series, stack, slice, factsOf(set, ref), *pixels),
                            std::move(pixels->buffer));

  const bool perImage = windowPerImage(stack, i.modality);
  const SliceFacts facts = factsOf(set, ref), middle = factsOf(set, stack.slices[stack.slices.size() / 2]);
  ImageFrameInfo info = describe(series, stack, slice, facts, perImage ? facts : middle);
  info.type = pixels->type;
  if (known) {
    info.autoWindow = *known;
  } else {
    std::optional<VoiWindow> window;
    if (info.windows.empty() && info.voiLuts.empty() && !perImage) window = windowOfStack(set, stack);
    const std::byte* const data = pixels->buffer.data();
    auto range = percentilesWithoutBlur(info, *pixels, facts);
    if (!range) range = percentilesOf(info, data, info.noData);  // nothing but tissue-range padding
    info.autoWindow = window.value_or(windowOver(range, leastWidth(info.type, info.rescale)));
  }
  return ImageFrame::make(std::move(info), std::move(pixels->buffer));
}

}  // namespace

bool windowPerImage(const Stack& stack, const std::string& modality) {
  constexpr std::array<std::string_view, 5> kPerImage{"NM", "XA", "CR", "DX", "MG"};
  return stack.shape == StackShape::NoGeometry ||
         std::find(kPerImage.begin(), kPerImage.end(), modality) != kPerImage.end();
}

Result<std::shared_ptr<const ImageFrame>> buildImageFrame(const StudySet& set, const Series& series,
                                                          const Stack& stack, std::size_t slice,
                                                          std::optional<VoiWindow> autoWindow) {
  return guarded("buildImageFrame", [&] { return build(set, series, stack, slice, autoWindow); });
}

}  // namespace vernier
