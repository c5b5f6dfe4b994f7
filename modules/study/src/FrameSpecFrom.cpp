// SPDX-License-Identifier: GPL-3.0-or-later
#include "FrameSpecFrom.h"

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>

#include <charconv>
#include <optional>

#include "vernier/base/Guarded.h"
#include "vernier/study/Limits.h"

namespace vernier {
namespace {

Error invalid(std::string what, const char* tag) {
  return makeError(ErrorCode::PixelDescriptionInvalid, std::move(what) + " The pixels cannot be shown.", tag);
}

struct Attribute {
  DcmTagKey key;
  const char* name;
};

DcmElement* find(DcmItem& dataset, const DcmTagKey& key) {
  DcmElement* element = nullptr;
  return dataset.findAndGetElement(key, element).good() ? element : nullptr;
}

// An absent or empty attribute gives nullopt; one of another VR or with another number of values is an error.
Result<std::optional<std::uint16_t>> readUS(DcmItem& dataset, const Attribute& a) {
  DcmElement* element = find(dataset, a.key);
  if (!element || element->getLength() == 0) return std::optional<std::uint16_t>{};
  const DcmEVR vr = element->ident();
  if (element->getLength() != 2 || (vr != EVR_US && vr != EVR_UN))
    return invalid(std::string(a.name) + " must be one value of VR US, but is " + DcmVR(vr).getVRName() +
                       " of " + std::to_string(element->getLength()) + " bytes.",
                   a.name);
  Uint16 value = 0;
  if (vr == EVR_US && element->getUint16(value, 0).good()) return std::optional<std::uint16_t>{value};
  Uint8* bytes = nullptr;
  if (vr == EVR_UN && element->getUint8Array(bytes).good() && bytes)
    return std::optional<std::uint16_t>{static_cast<std::uint16_t>(bytes[0] | bytes[1] << 8)};
  return invalid(std::string(a.name) + " cannot be read.", a.name);
}

Result<std::optional<std::string>> readText(DcmItem& dataset, const Attribute& a, DcmEVR wanted) {
  DcmElement* element = find(dataset, a.key);
  if (!element || element->getLength() == 0) return std::optional<std::string>{};
  const DcmEVR vr = element->ident();
  std::string text;
  if (vr == wanted) {
    OFString value;
    if (element->getOFString(value, 0).bad())
      return invalid(std::string(a.name) + " cannot be read.", a.name);
    text = value.c_str();
  } else if (vr == EVR_UN) {
    Uint8* bytes = nullptr;
    if (element->getUint8Array(bytes).good() && bytes) text.assign(bytes, bytes + element->getLength());
  } else {
    return invalid(std::string(a.name) + " must be of VR " + DcmVR(wanted).getVRName() + ", but is " +
                       DcmVR(vr).getVRName() + ".",
                   a.name);
  }
  const auto first = text.find_first_not_of(' ');
  if (first == std::string::npos) return std::optional<std::string>{};
  const auto last = text.find_last_not_of(std::string_view(" \0", 2));
  return std::optional<std::string>{text.substr(first, last - first + 1)};
}

const Attribute kRows{DCM_Rows, "Rows (0028,0010)"};
const Attribute kColumns{DCM_Columns, "Columns (0028,0011)"};
const Attribute kSamples{DCM_SamplesPerPixel, "Samples per Pixel (0028,0002)"};
const Attribute kAllocated{DCM_BitsAllocated, "Bits Allocated (0028,0100)"};
const Attribute kStored{DCM_BitsStored, "Bits Stored (0028,0101)"};
const Attribute kHighBit{DCM_HighBit, "High Bit (0028,0102)"};
const Attribute kSign{DCM_PixelRepresentation, "Pixel Representation (0028,0103)"};
const Attribute kPlanar{DCM_PlanarConfiguration, "Planar Configuration (0028,0006)"};
const Attribute kFrames{DCM_NumberOfFrames, "Number of Frames (0028,0008)"};
const Attribute kPhotometric{DCM_PhotometricInterpretation, "Photometric Interpretation (0028,0004)"};
const Attribute kSopClass{DCM_SOPClassUID, "SOP Class UID (0008,0016)"};

// Reads `a` into `out`; `fallback` where it is absent, and an error where there is no fallback.
template <class Target>
Result<void> take(DcmItem& dataset, const Attribute& a, std::optional<std::uint16_t> fallback, Target& out) {
  const auto value = readUS(dataset, a);
  if (!value) return value.error();
  if (!*value && !fallback) return invalid(std::string(a.name) + " is missing.", a.name);
  out = *value ? **value : *fallback;
  return {};
}

Result<void> readSize(DcmItem& dataset, FrameSpec& spec) {
  if (auto r = take(dataset, kRows, {}, spec.rows); !r) return r;
  if (auto r = take(dataset, kColumns, {}, spec.columns); !r) return r;
  if (spec.rows == 0) return invalid("Rows is 0: the image has no pixels.", kRows.name);
  if (spec.columns == 0) return invalid("Columns is 0: the image has no pixels.", kColumns.name);
  if (spec.rows > limits::kMaxRows || spec.columns > limits::kMaxColumns)
    return makeError(ErrorCode::LimitExceeded, "The image has more rows or columns than the limit.",
                     kRows.name);
  if (auto r = take(dataset, kSamples, 1, spec.samplesPerPixel); !r) return r;
  if (spec.samplesPerPixel != 1 && spec.samplesPerPixel != 3 && spec.samplesPerPixel != 4)
    return invalid(
        "Samples per Pixel is " + std::to_string(spec.samplesPerPixel) + ", where 1, 3 or 4 can be.",
        kSamples.name);
  std::uint16_t planar = 0;
  if (auto r = take(dataset, kPlanar, 0, planar); !r) return r;
  spec.planar = planar == 1 && spec.samplesPerPixel > 1;

  const auto frames = readText(dataset, kFrames, EVR_IS);
  if (!frames) return frames.error();
  if (!*frames) return {};
  std::int64_t n = 0;
  const char* begin = (*frames)->data();
  const char* end = begin + (*frames)->size();
  if (begin != end && *begin == '+') ++begin;
  const auto [stop, wrong] = std::from_chars(begin, end, n);
  if (wrong != std::errc{} || stop != end || n < 0)
    return invalid("Number of Frames is not a whole number of at least 1.", kFrames.name);
  if (n == 0) {
    n = 1;
    spec.corrected += "Number of Frames is 0; one frame is read. ";
  }
  if (static_cast<std::uint64_t>(n) > limits::kMaxFrames)
    return makeError(ErrorCode::LimitExceeded,
                     "The object declares " + std::to_string(n) + " frames, more than the limit of " +
                         std::to_string(limits::kMaxFrames) + ".",
                     kFrames.name);
  spec.framesDeclared = static_cast<std::uint64_t>(n);
  return {};
}

Result<void> readBits(DcmItem& dataset, FrameSpec& spec) {
  const std::uint32_t allocated = spec.bitsAllocated;
  if (allocated != 1 && allocated != 8 && allocated != 16 && allocated != 32)
    return invalid("Bits Allocated is " + std::to_string(allocated) + ", where 1, 8, 16 or 32 can be read.",
                   kAllocated.name);
  if (auto r = take(dataset, kStored, static_cast<std::uint16_t>(allocated), spec.bitsStored); !r) return r;
  if (spec.bitsStored == 0 || spec.bitsStored > allocated) {
    spec.corrected += "Bits Stored is " + std::to_string(spec.bitsStored) + " with Bits Allocated " +
                      std::to_string(allocated) + "; all bits allocated are read. ";
    spec.bitsStored = allocated;
  }
  const auto top = static_cast<std::uint16_t>(spec.bitsStored - 1);
  if (auto r = take(dataset, kHighBit, top, spec.highBit); !r) return r;
  if (spec.highBit < top || spec.highBit >= allocated) {
    spec.corrected += "High Bit is " + std::to_string(spec.highBit) + " with Bits Stored " +
                      std::to_string(spec.bitsStored) + "; " + std::to_string(top) + " is taken. ";
    spec.highBit = top;
  }
  std::uint16_t sign = 0;
  if (auto r = take(dataset, kSign, 0, sign); !r) return r;
  if (sign > 1) return invalid("Pixel Representation is neither 0 nor 1.", kSign.name);
  if (sign == 1 && spec.samplesPerPixel > 1)
    spec.corrected += "Pixel Representation says signed samples of a colour; they are read as unsigned. ";
  spec.isSigned = sign == 1 && allocated > 1 && spec.samplesPerPixel == 1;
  switch (allocated) {
    case 1:
    case 8:
      spec.sample = spec.isSigned ? SampleType::I8 : SampleType::U8;
      break;
    case 16:
      spec.sample = spec.isSigned ? SampleType::I16 : SampleType::U16;
      break;
    default:
      spec.sample = spec.isSigned ? SampleType::I32 : SampleType::U32;
      break;
  }
  return {};
}

// Parametric maps may hold IEEE floats (PS3.3 C.7.6.3.4, C.7.6.3.5), which have neither Bits Stored nor a
// sign.
Result<bool> readFloat(DcmItem& dataset, FrameSpec& spec) {
  const bool hasFloat = dataset.tagExists(DCM_FloatPixelData),
             hasDouble = dataset.tagExists(DCM_DoubleFloatPixelData);
  const auto sopClass = readText(dataset, kSopClass, EVR_UI);
  const bool map = sopClass && *sopClass && **sopClass == UID_ParametricMapStorage;
  const bool noBits = !find(dataset, DCM_BitsStored) && !find(dataset, DCM_PixelRepresentation);
  if (!hasFloat && !hasDouble && !(map && noBits)) return false;
  const std::uint32_t wanted = hasFloat ? 32 : hasDouble ? 64 : spec.bitsAllocated;
  if (spec.bitsAllocated != wanted || (wanted != 32 && wanted != 64))
    return invalid("Bits Allocated is " + std::to_string(spec.bitsAllocated) + " for floating-point pixels.",
                   kAllocated.name);
  spec.bitsStored = wanted;
  spec.highBit = wanted - 1;
  spec.isSigned = true;
  spec.sample = wanted == 32 ? SampleType::F32 : SampleType::F64;
  return true;
}

// Whether three or four samples are colours that can be shown; what one sample is taken for.
Result<void> checkColour(FrameSpec& spec) {
  const std::string& name = spec.photometric;
  const bool three = name == "RGB" || name.starts_with("YBR_");
  if (spec.samplesPerPixel == 1) {
    if (!name.empty() && !name.starts_with("MONOCHROME") && name != "PALETTE COLOR")
      spec.corrected +=
          "Photometric Interpretation names no grey image for one sample per pixel; MONOCHROME2 is taken. ";
    return {};
  }
  if (spec.samplesPerPixel == 3 && three) return {};
  return invalid("Photometric Interpretation (0028,0004) with " + std::to_string(spec.samplesPerPixel) +
                     " samples per pixel is none of RGB and YBR_*; retired colour models are not shown.",
                 kPhotometric.name);
}

Result<FrameSpec> read(DcmItem& dataset, const std::string& transferSyntaxUid) {
  FrameSpec spec;
  spec.transferSyntaxUid = transferSyntaxUid;
  if (auto r = readSize(dataset, spec); !r) return r.error();
  const auto photometric = readText(dataset, kPhotometric, EVR_CS);
  if (!photometric) return photometric.error();
  spec.photometric = photometric->value_or("");
  const bool oneSample = spec.photometric.starts_with("MONOCHROME") || spec.photometric == "PALETTE COLOR";
  if (oneSample && spec.samplesPerPixel != 1)
    return invalid("Samples per Pixel is " + std::to_string(spec.samplesPerPixel) +
                       ", but the photometric interpretation has one.",
                   kSamples.name);
  if (auto r = checkColour(spec); !r) return r.error();
  if (auto r = take(dataset, kAllocated, {}, spec.bitsAllocated); !r) return r.error();
  const auto isFloat = readFloat(dataset, spec);
  if (!isFloat) return isFloat.error();
  if (!*isFloat)
    if (auto r = readBits(dataset, spec); !r) return r.error();
  if (syntaxKind(transferSyntaxUid) == SyntaxKind::Unknown)
    return makeError(
        ErrorCode::CodecUnsupported,
        "The transfer syntax is not one that Vernier reads; convert the file to Explicit VR Little "
        "Endian, for instance with dcmconv or gdcmconv.",
        "Transfer Syntax UID (0002,0010)");
  // The size of the decoded frames must be countable and within the limits before anyone sets memory aside.
  spec.frameCount = spec.framesDeclared;
  if (auto r = spec.outputBytes(); !r) return r.error();
  spec.frameCount = 1;
  return spec;
}

}  // namespace

Result<FrameSpec> frameSpecFrom(DcmItem& dataset, const std::string& transferSyntaxUid) {
  return guarded("frameSpecFrom", [&] { return read(dataset, transferSyntaxUid); });
}

}  // namespace vernier
