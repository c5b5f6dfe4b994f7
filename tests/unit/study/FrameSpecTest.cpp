// SPDX-License-Identifier: GPL-3.0-or-later
// Attributes -> FrameSpec: each attribute missing, of a wrong VR, out of range, and at the limits.
#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>
#include <gtest/gtest.h>

#include <functional>

#include "FrameSpecFrom.h"
#include "vernier/study/Limits.h"

namespace vernier::test {
namespace {

constexpr const char* kExplicit = "1.2.840.10008.1.2.1";

void put(DcmDataset& d, const DcmTagKey& key, unsigned v) {
  d.putAndInsertUint16(key, static_cast<Uint16>(v));
}

Result<FrameSpec> specWith(const std::function<void(DcmDataset&)>& change, const char* syntax = kExplicit) {
  DcmDataset d;
  d.putAndInsertString(DCM_SOPClassUID, UID_CTImageStorage);
  put(d, DCM_Rows, 4);
  put(d, DCM_Columns, 6);
  put(d, DCM_SamplesPerPixel, 1);
  d.putAndInsertString(DCM_PhotometricInterpretation, "MONOCHROME2");
  put(d, DCM_BitsAllocated, 16);
  put(d, DCM_BitsStored, 12);
  put(d, DCM_HighBit, 11);
  put(d, DCM_PixelRepresentation, 1);
  change(d);
  return frameSpecFrom(d, syntax);
}
ErrorCode refusal(const std::function<void(DcmDataset&)>& change, const char* syntax = kExplicit) {
  const auto r = specWith(change, syntax);
  if (r.ok()) return ErrorCode::OutOfTolerance;
  EXPECT_FALSE(r.error().sentence.empty());
  EXPECT_FALSE(r.error().where.empty() && r.error().code == ErrorCode::PixelDescriptionInvalid);
  return r.error().code;
}

TEST(FrameSpecFrom, PlainObject) {
  const auto s = specWith([](DcmDataset&) {});
  ASSERT_TRUE(s.ok()) << s.error().text();
  EXPECT_EQ(s->rows, 4u);
  EXPECT_EQ(s->columns, 6u);
  EXPECT_EQ(s->framesDeclared, 1u);
  EXPECT_EQ(s->frameCount, 1u);
  EXPECT_EQ(s->bitsAllocated, 16u);
  EXPECT_EQ(s->bitsStored, 12u);
  EXPECT_EQ(s->highBit, 11u);
  EXPECT_TRUE(s->isSigned);
  EXPECT_EQ(s->sample, SampleType::I16);
  EXPECT_EQ(s->photometric, "MONOCHROME2");
  EXPECT_TRUE(s->corrected.empty());
  EXPECT_EQ(*s->outputBytes(), 48u);
}

TEST(FrameSpecFrom, WhatCannotBeMissing) {
  for (const DcmTagKey& key : {DCM_Rows, DCM_Columns, DCM_BitsAllocated})
    EXPECT_EQ(refusal([&](DcmDataset& d) { d.findAndDeleteElement(key); }),
              ErrorCode::PixelDescriptionInvalid);
  for (const DcmTagKey& key : {DCM_SamplesPerPixel, DCM_PhotometricInterpretation, DCM_BitsStored,
                               DCM_HighBit, DCM_PixelRepresentation})
    EXPECT_EQ(refusal([&](DcmDataset& d) { d.findAndDeleteElement(key); }), ErrorCode::OutOfTolerance);
}

TEST(FrameSpecFrom, ZeroAndLargestSizes) {
  EXPECT_EQ(refusal([](DcmDataset& d) { put(d, DCM_Rows, 0); }), ErrorCode::PixelDescriptionInvalid);
  EXPECT_EQ(refusal([](DcmDataset& d) { put(d, DCM_Columns, 0); }), ErrorCode::PixelDescriptionInvalid);
  // 65535 x 16384 x 2 bytes is just below 2 GiB; 65535 x 16385 is above.
  EXPECT_EQ(refusal([](DcmDataset& d) { put(d, DCM_Rows, 65535), put(d, DCM_Columns, 16384); }),
            ErrorCode::OutOfTolerance);
  EXPECT_EQ(refusal([](DcmDataset& d) { put(d, DCM_Rows, 65535), put(d, DCM_Columns, 16385); }),
            ErrorCode::LimitExceeded);
}

TEST(FrameSpecFrom, EveryVrIsChecked) {
  const auto wrongVr = [](const DcmTagKey& key) {
    return refusal([&](DcmDataset& d) {
      d.findAndDeleteElement(key);
      auto* e = new DcmUnsignedLong(DcmTag(key, EVR_UL));
      e->putUint32(4, 0);
      d.insert(e, OFTrue);
    });
  };
  for (const DcmTagKey& key : {DCM_Rows, DCM_Columns, DCM_SamplesPerPixel, DCM_BitsAllocated, DCM_BitsStored,
                               DCM_HighBit, DCM_PixelRepresentation, DCM_PlanarConfiguration})
    EXPECT_EQ(wrongVr(key), ErrorCode::PixelDescriptionInvalid) << key.toString().c_str();
  EXPECT_EQ(refusal([](DcmDataset& d) {
              auto* e = new DcmSignedShort(DcmTag(DCM_BitsAllocated, EVR_SS));
              e->putSint16(16, 0);
              d.insert(e, OFTrue);
            }),
            ErrorCode::PixelDescriptionInvalid);
  EXPECT_EQ(refusal([](DcmDataset& d) {
              d.insert(new DcmUnsignedLong(DcmTag(DCM_NumberOfFrames, EVR_UL)), OFTrue);
            }),
            ErrorCode::OutOfTolerance);  // empty: as if absent
  EXPECT_EQ(refusal([](DcmDataset& d) {
              auto* e = new DcmUnsignedLong(DcmTag(DCM_NumberOfFrames, EVR_UL));
              e->putUint32(2, 0);
              d.insert(e, OFTrue);
            }),
            ErrorCode::PixelDescriptionInvalid);
  // Two values where one belongs.
  EXPECT_EQ(refusal([](DcmDataset& d) {
              const Uint16 two[2] = {4, 4};
              d.putAndInsertUint16Array(DCM_Rows, two, 2);
            }),
            ErrorCode::PixelDescriptionInvalid);
}

TEST(FrameSpecFrom, UnknownVrIsReadAsLittleEndian) {
  const auto s = specWith([](DcmDataset& d) {
    d.findAndDeleteElement(DCM_Rows);
    auto* e = new DcmOtherByteOtherWord(DcmTag(DCM_Rows, EVR_UN));
    const Uint8 bytes[2] = {0x02, 0x01};
    e->putUint8Array(bytes, 2);
    d.insert(e, OFTrue);
  });
  ASSERT_TRUE(s.ok()) << s.error().text();
  EXPECT_EQ(s->rows, 0x0102u);
}

TEST(FrameSpecFrom, BitsThatContradictEachOther) {
  const auto bits = [](unsigned allocated, unsigned stored, unsigned high) {
    return [=](DcmDataset& d) {
      put(d, DCM_BitsAllocated, allocated);
      put(d, DCM_BitsStored, stored);
      put(d, DCM_HighBit, high);
    };
  };
  for (unsigned allocated : {0u, 3u, 9u, 12u, 24u, 48u, 64u, 128u, 65535u})
    EXPECT_EQ(refusal(bits(allocated, allocated, allocated - 1)), ErrorCode::PixelDescriptionInvalid)
        << allocated;
  // All readers read these alike; the description says what was taken instead.
  for (const auto& [change, stored, high] : {std::tuple{bits(16, 17, 11), 16u, 15u},
                                             {bits(16, 0, 0), 16u, 15u},
                                             {bits(16, 12, 16), 12u, 11u},
                                             {bits(16, 12, 20), 12u, 11u},
                                             {bits(16, 12, 3), 12u, 11u}}) {
    const auto s = specWith(change);
    ASSERT_TRUE(s.ok()) << s.error().text();
    EXPECT_EQ(s->bitsStored, stored);
    EXPECT_EQ(s->highBit, high);
    EXPECT_FALSE(s->corrected.empty());
  }
  // High Bit above the bits stored is legal, and kept.
  const auto top = specWith(bits(16, 12, 15));
  ASSERT_TRUE(top.ok());
  EXPECT_EQ(top->highBit, 15u);
  EXPECT_TRUE(top->corrected.empty());
  EXPECT_EQ(refusal([](DcmDataset& d) { put(d, DCM_PixelRepresentation, 2); }),
            ErrorCode::PixelDescriptionInvalid);
}

TEST(FrameSpecFrom, NumberOfFrames) {
  const auto frames = [](const char* text) {
    return [=](DcmDataset& d) { d.putAndInsertString(DCM_NumberOfFrames, text); };
  };
  EXPECT_EQ(refusal(frames("999999")), ErrorCode::LimitExceeded);
  EXPECT_EQ(refusal(frames("99999999999999999999")), ErrorCode::PixelDescriptionInvalid);
  EXPECT_EQ(refusal(frames("-1")), ErrorCode::PixelDescriptionInvalid);
  EXPECT_EQ(refusal(frames("2.5")), ErrorCode::PixelDescriptionInvalid);
  EXPECT_EQ(refusal(frames("many")), ErrorCode::PixelDescriptionInvalid);
  ASSERT_TRUE(specWith(frames("100000")).ok());
  EXPECT_EQ(specWith(frames(" 12 "))->framesDeclared, 12u);
  const auto none = specWith(frames("0"));
  ASSERT_TRUE(none.ok());
  EXPECT_EQ(none->framesDeclared, 1u);
  EXPECT_FALSE(none->corrected.empty());
}

TEST(FrameSpecFrom, SamplesAndSyntax) {
  EXPECT_EQ(refusal([](DcmDataset& d) { put(d, DCM_SamplesPerPixel, 3); }),
            ErrorCode::PixelDescriptionInvalid);
  EXPECT_EQ(refusal([](DcmDataset& d) {
              put(d, DCM_SamplesPerPixel, 3);
              d.putAndInsertString(DCM_PhotometricInterpretation, "RGB");
            }),
            ErrorCode::OutOfTolerance);
  EXPECT_EQ(refusal([](DcmDataset& d) { put(d, DCM_SamplesPerPixel, 0); }),
            ErrorCode::PixelDescriptionInvalid);
  EXPECT_EQ(refusal([](DcmDataset& d) { put(d, DCM_SamplesPerPixel, 60000); }),
            ErrorCode::PixelDescriptionInvalid);
  EXPECT_EQ(refusal([](DcmDataset&) {}, "999.888.777.INVALID"), ErrorCode::CodecUnsupported);
}

TEST(FrameSpecFrom, FloatsOfAParametricMap) {
  const auto s = specWith([](DcmDataset& d) {
    d.putAndInsertString(DCM_SOPClassUID, UID_ParametricMapStorage);
    put(d, DCM_BitsAllocated, 32);
    for (const DcmTagKey& key : {DCM_BitsStored, DCM_HighBit, DCM_PixelRepresentation})
      d.findAndDeleteElement(key);
  });
  ASSERT_TRUE(s.ok()) << s.error().text();
  EXPECT_EQ(s->sample, SampleType::F32);
  EXPECT_EQ(refusal([](DcmDataset& d) {
              const Float32 v[1] = {1};
              d.putAndInsertFloat32Array(DCM_FloatPixelData, v, 1);
            }),
            ErrorCode::PixelDescriptionInvalid);  // 16 bits allocated
}

TEST(FrameSpec, AFileMustBeAbleToHoldItsFrames) {
  auto s = *specWith([](DcmDataset& d) { d.putAndInsertString(DCM_NumberOfFrames, "1000"); });
  EXPECT_TRUE(s.checkFileCanHold(48'000).ok());
  EXPECT_EQ(s.checkFileCanHold(47'999).error().code, ErrorCode::PixelDataShort);
  s.transferSyntaxUid = "1.2.840.10008.1.2.5";
  EXPECT_TRUE(s.checkFileCanHold(48'000 / 64).ok());
  EXPECT_EQ(s.checkFileCanHold(48'000 / 64 - 1).error().code, ErrorCode::PixelDataShort);
  s.transferSyntaxUid = "1.2.840.10008.1.2.4.70";
  EXPECT_EQ(s.checkFileCanHold(1000).error().code, ErrorCode::PixelDataShort);
  // A few bytes of JPEG cannot ask for two gigabytes, but for what a blank image may take.
  s.framesDeclared = 1;
  s.rows = 65535;
  s.columns = 16000;
  EXPECT_EQ(s.checkFileCanHold(3000).error().code, ErrorCode::LimitExceeded);
  s.rows = 4096;
  s.columns = 8192;
  EXPECT_TRUE(s.checkFileCanHold(3000).ok());
}

TEST(FrameSpec, SizesAreCountedWithoutOverflow) {
  FrameSpec s;
  s.rows = s.columns = std::uint64_t{1} << 33;
  EXPECT_EQ(s.frameBytes().error().code, ErrorCode::LimitExceeded);
  EXPECT_EQ(s.nativeFrameBytes().error().code, ErrorCode::LimitExceeded);
  s.rows = s.columns = 32768;
  s.sample = SampleType::U16;
  s.bitsAllocated = 16;
  EXPECT_EQ(*s.frameBytes(), limits::kMaxDecodedFrameBytes);  // at the limit
  s.frameCount = std::uint64_t{1} << 40;
  EXPECT_EQ(s.outputBytes().error().code, ErrorCode::LimitExceeded);
  s.columns = 32769;
  EXPECT_EQ(s.frameBytes().error().code, ErrorCode::LimitExceeded);
}

}  // namespace
}  // namespace vernier::test
