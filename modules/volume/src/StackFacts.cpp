// SPDX-License-Identifier: GPL-3.0-or-later
#include "StackFacts.h"

#include <algorithm>
#include <cmath>

#include "vernier/volume/Voi.h"

namespace vernier {

Result<void> checkImage(const Instance& i) {
  if (i.pixelError) return *i.pixelError;
  if (!i.isImage)
    return makeError(ErrorCode::PixelDataMissing, "The object is not an image; choose another one.");
  return {};
}

Result<void> checkSingleSample(const Instance& i) {
  if (Result<void> ok = checkImage(i); !ok) return ok;
  if (i.pixels.samplesPerPixel != 1 || i.photometric.starts_with("PALETTE"))
    return makeError(
        ErrorCode::NotBuiltYet,
        "Colour images are listed but not drawn in this version; grey images of the study can be opened.");
  return {};
}

SampleType sampleOf(VoxelType t) {
  switch (t) {
    case VoxelType::U8:
      return SampleType::U8;
    case VoxelType::I8:
      return SampleType::I8;
    case VoxelType::U16:
      return SampleType::U16;
    case VoxelType::I16:
      return SampleType::I16;
    case VoxelType::U32:
      return SampleType::U32;
    case VoxelType::I32:
      return SampleType::I32;
    case VoxelType::F32:
      break;
  }
  return SampleType::F32;
}

VoxelType voxelTypeOf(SampleType t) {
  switch (t) {
    case SampleType::U8:
      return VoxelType::U8;
    case SampleType::I8:
      return VoxelType::I8;
    case SampleType::U16:
      return VoxelType::U16;
    case SampleType::I16:
      return VoxelType::I16;
    case SampleType::U32:
      return VoxelType::U32;
    case SampleType::I32:
      return VoxelType::I32;
    case SampleType::F32:
    case SampleType::F64:
      break;
  }
  return VoxelType::F32;
}

SampleType commonSample(const std::vector<const Instance*>& instances) {
  std::optional<SampleType> first;
  bool mixed = false, anySigned = false, anyFloat = false, anyDouble = false;
  std::uint32_t signedBits = 0, unsignedBits = 0;
  for (const Instance* i : instances) {
    if (i->pixelError) continue;
    const FrameSpec& p = i->pixels;
    if (!first) first = p.sample;
    mixed |= *first != p.sample;
    anyFloat |= p.isFloat();
    anyDouble |= p.sample == SampleType::F64;
    anySigned |= p.isSigned;
    (p.isSigned ? signedBits : unsignedBits) = std::max(p.isSigned ? signedBits : unsignedBits, p.bitsStored);
  }
  if (!first) return SampleType::U16;
  if (!mixed) return *first;
  if (anyFloat) return anyDouble ? SampleType::F64 : SampleType::F32;
  const std::uint32_t bits = anySigned ? std::max(signedBits, unsignedBits + 1) : unsignedBits;
  if (bits <= 8) return anySigned ? SampleType::I8 : SampleType::U8;
  if (bits <= 16) return anySigned ? SampleType::I16 : SampleType::U16;
  return anySigned ? SampleType::I32 : SampleType::U32;
}

SliceFacts factsOf(const StudySet& set, SliceRef ref) {
  const Instance& i = set.instances[ref.instance];
  return {&i, &i.frame(ref.frame)};
}

std::optional<NoDataRange> paddingOf(const SliceFacts& facts) {
  const Instance& i = *facts.object;
  const FrameAttributes& f = *facts.frame;
  if (!f.paddingFirst) return std::nullopt;
  const double turn = std::exp2(std::clamp<double>(i.pixels.bitsAllocated, 1, 32));
  const auto asPixel = [&](double v) {
    if (i.pixels.isFloat()) return v;
    if (i.pixels.isSigned && v >= turn / 2) return v - turn;
    if (!i.pixels.isSigned && v < 0) return v + turn;
    return v;
  };
  const double a = asPixel(*f.paddingFirst), b = asPixel(f.paddingLast.value_or(*f.paddingFirst));
  if (std::isnan(a) || std::isnan(b)) return std::nullopt;
  return NoDataRange{std::min(a, b), std::max(a, b)};
}

bool liesInTissueRange(const Instance& i, const NoDataRange& padding) {
  return i.modality == "MR" && padding.first <= 0 && padding.last >= 0;
}

bool isInverted(const Instance& i) {
  return i.photometric == "MONOCHROME1" || i.presentationLutShape == "INVERSE";
}

Finding lostSlices(const Stack& stack, const std::vector<SliceFailure>& failed) {
  Finding f;
  f.code = "slices-not-decoded";
  f.severity = Severity::Warning;
  f.sentence = std::to_string(failed.size()) + " of " + std::to_string(stack.slices.size()) +
               " slices could not be decoded and are shown as missing. The first said: " +
               failed.front().error.sentence;
  std::vector<double> positions;
  for (const SliceFailure& s : failed)
    if (s.slice < stack.positions_mm.size()) positions.push_back(stack.positions_mm[s.slice]);
  f.numbers = {{"slices", static_cast<double>(failed.size())}, {"positions_mm", std::move(positions)}};
  return f;
}

std::string patientKey(const StudySet& set, const Stack& stack) {
  const Patient* p = patientOf(set, stack);
  return !p || p->id.empty() ? std::string() : p->id + '\x1f' + p->issuer;
}

std::vector<VoiWindow> windowsOf(const FrameAttributes& frame, std::vector<Finding>& findings) {
  std::vector<VoiWindow> out;
  bool narrow = false;
  for (const VoiWindow& w : frame.windows) {
    if (!usableWindow(w)) continue;
    out.push_back(normalised(w));
    narrow |= out.back().function != w.function;
  }
  if (narrow) {
    Finding f;
    f.code = "window-width-below-one";
    f.severity = Severity::Notice;
    f.sentence = "A window is narrower than 1, which LINEAR does not allow; it is applied as LINEAR_EXACT.";
    findings.push_back(std::move(f));
  }
  return out;
}

}  // namespace vernier
