// SPDX-License-Identifier: GPL-3.0-or-later
// The helper that all file-based tests stand on writes what it was asked for.
#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>

#include "MakeDicom.h"
#include "TestData.h"

namespace vernier::test {
namespace {

TEST(MakeDicom, WritesGeometryPixelsAndOverrides) {
  const TempDir dir;
  for (const char* syntax : {"1.2.840.10008.1.2", "1.2.840.10008.1.2.1", "1.2.840.10008.1.2.2",
                             "1.2.840.10008.1.2.1.99", "1.2.840.10008.1.2.5"}) {
    DicomSlice s;
    s.rows = 2;
    s.columns = 3;
    s.pixels = {-32768, -1, 0, 1, 2, 32767};
    s.position = {1.5, -2, 3.25};
    s.spacing = {0.5, 0.25};
    s.transferSyntaxUid = syntax;
    s.set = {{"0018,0081", "90"}, {"0028,1050", "40\\80"}};
    s.erase = {"0020,0052"};
    writeDicom(dir.path() / "a.dcm", s);

    DcmFileFormat f;
    ASSERT_TRUE(f.loadFile((dir.path() / "a.dcm").c_str()).good());
    DcmDataset& d = *f.getDataset();
    EXPECT_STREQ(DcmXfer(d.getOriginalXfer()).getXferID(), syntax);
    ASSERT_TRUE(d.chooseRepresentation(EXS_LittleEndianExplicit, nullptr).good() ||
                d.getOriginalXfer() == EXS_RLELossless);
    Float64 z = 0, distanceBetweenRows = 0, echo = 0, window = 0;
    EXPECT_TRUE(d.findAndGetFloat64(DCM_ImagePositionPatient, z, 2).good());
    EXPECT_TRUE(d.findAndGetFloat64(DCM_PixelSpacing, distanceBetweenRows, 0).good());
    EXPECT_TRUE(d.findAndGetFloat64(DCM_EchoTime, echo).good());
    EXPECT_TRUE(d.findAndGetFloat64(DCM_WindowCenter, window, 1).good());
    EXPECT_EQ(z, 3.25);
    EXPECT_EQ(distanceBetweenRows, 0.5);
    EXPECT_EQ(echo, 90);
    EXPECT_EQ(window, 80);
    EXPECT_FALSE(d.tagExists(DCM_FrameOfReferenceUID));
    if (d.getOriginalXfer() != EXS_RLELossless) {
      const Uint16* words = nullptr;
      unsigned long n = 0;
      ASSERT_TRUE(d.findAndGetUint16Array(DCM_PixelData, words, &n).good());
      ASSERT_EQ(n, 6u);
      EXPECT_EQ(words[0], 0x8000);
      EXPECT_EQ(words[5], 0x7fff);
    }
  }
}

TEST(MakeDicom, SeriesStepsAlongTheGivenVector) {
  const TempDir dir;
  writeSeries(dir.path() / "s", 3, {0, 0.5, 2});
  DcmFileFormat f;
  ASSERT_TRUE(f.loadFile((dir.path() / "s" / "002.dcm").c_str()).good());
  Float64 y = 0, z = 0;
  f.getDataset()->findAndGetFloat64(DCM_ImagePositionPatient, y, 1);
  f.getDataset()->findAndGetFloat64(DCM_ImagePositionPatient, z, 2);
  EXPECT_EQ(y, 1.0);
  EXPECT_EQ(z, 4.0);
}

}  // namespace
}  // namespace vernier::test
