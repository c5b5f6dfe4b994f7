// SPDX-License-Identifier: GPL-3.0-or-later
// Presentation states as they are read: which images, which transformations, and what is said of the rest.
#include "vernier/study/Presentation.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "MakeDicom.h"
#include "MakePresentation.h"
#include "TestData.h"
#include "vernier/study/Load.h"

namespace vernier {
namespace {

using test::PresentationFile;
using test::TempDir;

PresentationState read(const PresentationFile& p) {
  const TempDir dir;
  writePresentation(dir.path() / "pr.dcm", p);
  const auto set = scanStudy({dir.path().string()});
  EXPECT_TRUE(set.ok());
  EXPECT_EQ(set->presentations.size(), 1u);
  return set->presentations.at(0);
}

PresentationState readWith(std::vector<std::string> set) {
  PresentationFile p;
  p.set = std::move(set);
  return read(p);
}

bool notApplied(const PresentationState& p, const std::string& what) {
  return std::find(p.notApplied.begin(), p.notApplied.end(), what) != p.notApplied.end();
}

TEST(Presentation, NamesItsImages) {
  PresentationFile f;
  f.imageUids = {"2.25.1", "2.25.2"};
  f.set = {"ReferencedSeriesSequence[0].ReferencedImageSequence[1].ReferencedFrameNumber=2\\5",
           "ContentDescription=for the ward"};
  const PresentationState p = read(f);
  EXPECT_EQ(p.label, "TEST");
  EXPECT_EQ(p.description, "for the ward");
  EXPECT_TRUE(p.greyscale);
  EXPECT_TRUE(p.whyNot.empty());
  EXPECT_TRUE(presentationFor(p, "2.25.1", 7).ok());
  EXPECT_TRUE(presentationFor(p, "2.25.2", 5).ok());
  EXPECT_EQ(presentationFor(p, "2.25.2", 4).error().code, ErrorCode::SceneInvalid);
  EXPECT_EQ(presentationFor(p, "2.25.3", 1).error().code, ErrorCode::SceneInvalid);
  const FramePresentation plain = *presentationFor(p, "2.25.1", 1);
  EXPECT_FALSE(plain.window || plain.voiLut || plain.presentationLut || plain.inverse || plain.shutter ||
               plain.area);
  EXPECT_EQ(plain.rescale, ModalityRescale{});
}

TEST(Presentation, OtherKindsAreListedWithTheReason) {
  PresentationFile f;
  f.sopClassUid = "1.2.840.10008.5.1.4.1.1.11.3";
  const PresentationState p = read(f);
  EXPECT_FALSE(p.whyNot.empty());
  EXPECT_EQ(presentationFor(p, "2.25.1002.1", 1).error().code, ErrorCode::NotBuiltYet);
  f.sopClassUid = "1.2.840.10008.5.1.4.1.1.11.2";
  EXPECT_FALSE(read(f).greyscale);
  EXPECT_TRUE(read(f).whyNot.empty());
}

TEST(Presentation, GreyTransformations) {
  const PresentationState p =
      readWith({"RescaleSlope=2", "RescaleIntercept=-100", "SoftcopyVOILUTSequence[0].WindowCenter=40\\50",
                "SoftcopyVOILUTSequence[0].WindowWidth=400\\60",
                "SoftcopyVOILUTSequence[0].ReferencedImageSequence[0].ReferencedSOPInstanceUID=2.25.1002.2",
                "SoftcopyVOILUTSequence[1].VOILUTSequence[0].LUTDescriptor=4\\0\\12",
                "SoftcopyVOILUTSequence[1].VOILUTSequence[0].LUTData=" + test::lutWords({0, 5, 4095, 7}),
                "SoftcopyVOILUTSequence[1].ReferencedImageSequence[0].ReferencedSOPInstanceUID=2.25.1002.1",
                "PresentationLUTShape=INVERSE"});
  EXPECT_EQ(p.rescale, (ModalityRescale{2, -100}));
  EXPECT_TRUE(p.inverse);
  EXPECT_TRUE(p.notApplied.empty());
  const FramePresentation f = *presentationFor(p, "2.25.1002.1", 1);
  ASSERT_TRUE(f.voiLut);
  EXPECT_FALSE(f.window);
  EXPECT_EQ(f.voiLut->bits, 12u);
  EXPECT_EQ(f.voiLut->data, (std::vector<std::uint16_t>{0, 5, 4095, 7}));
}

TEST(Presentation, LutsThatContradictThemselvesAreSaid) {
  EXPECT_TRUE(notApplied(readWith({"ModalityLUTSequence[0].LUTDescriptor=4\\0\\8",
                                   "ModalityLUTSequence[0].LUTData=" + test::lutWords({1})}),
                         "a modality LUT that contradicts itself"));
  EXPECT_TRUE(notApplied(readWith({"PresentationLUTSequence[0].LUTDescriptor=0\\0\\12",
                                   "PresentationLUTSequence[0].LUTData=" + test::lutWords({1, 2})}),
                         "a presentation LUT that contradicts itself"));
  EXPECT_TRUE(notApplied(
      readWith({"SoftcopyVOILUTSequence[0].WindowCenter=40", "SoftcopyVOILUTSequence[0].WindowWidth=0"}),
      "a window without a usable width"));
  EXPECT_TRUE(notApplied(readWith({"RescaleSlope=0", "RescaleIntercept=1"}),
                         "a rescale slope of zero or that is no number"));
}

TEST(Presentation, ShutterRotationArea) {
  const PresentationState p =
      readWith({"ShutterShape=RECTANGULAR\\CIRCULAR\\POLYGONAL", "ShutterLeftVerticalEdge=2",
                "ShutterRightVerticalEdge=9", "ShutterUpperHorizontalEdge=3", "ShutterLowerHorizontalEdge=8",
                "CenterOfCircularShutter=4\\5", "RadiusOfCircularShutter=6",
                "VerticesOfThePolygonalShutter=1\\2\\3\\4\\5\\6", "ShutterPresentationValue=65535",
                "ImageRotation=270", "ImageHorizontalFlip=Y",
                "DisplayedAreaSelectionSequence[0].DisplayedAreaTopLeftHandCorner=3\\4",
                "DisplayedAreaSelectionSequence[0].DisplayedAreaBottomRightHandCorner=-5\\6",
                "DisplayedAreaSelectionSequence[0].PresentationSizeMode=MAGNIFY",
                "DisplayedAreaSelectionSequence[0].PresentationPixelMagnificationRatio=2.5",
                "DisplayedAreaSelectionSequence[0].PresentationPixelAspectRatio=2\\1"});
  ASSERT_TRUE(p.shutter && p.shutter->rectangle && p.shutter->circle);
  EXPECT_EQ(p.shutter->rectangle->left, 2);
  EXPECT_EQ(p.shutter->rectangle->right, 9);
  EXPECT_EQ(p.shutter->rectangle->upper, 3);
  EXPECT_EQ(p.shutter->rectangle->lower, 8);
  EXPECT_EQ(p.shutter->circle->centre, glm::dvec2(5, 4));  // the file lists rows first
  EXPECT_EQ(p.shutter->circle->radius, 6);
  EXPECT_EQ(p.shutter->polygon, (std::vector<glm::dvec2>{{2, 1}, {4, 3}, {6, 5}}));
  EXPECT_EQ(p.shutter->grey, 1);
  EXPECT_EQ(p.rotation_deg, 270);
  EXPECT_TRUE(p.flipHorizontal);
  ASSERT_EQ(p.areas.size(), 1u);
  EXPECT_EQ(p.areas[0].topLeft, glm::dvec2(3, 4));
  EXPECT_EQ(p.areas[0].bottomRight, glm::dvec2(-5, 6));
  EXPECT_EQ(p.areas[0].mode, AreaMode::Magnify);
  EXPECT_EQ(p.areas[0].magnification, 2.5);
  EXPECT_EQ(*p.areas[0].pixelAspect, glm::dvec2(2, 1));
  EXPECT_TRUE(p.notApplied.empty());
}

TEST(Presentation, WhatIsNotFullyDescribedIsSaid) {
  EXPECT_TRUE(notApplied(readWith({"ShutterShape=CIRCULAR", "CenterOfCircularShutter=4\\5"}),
                         "a shutter that is not fully described"));
  EXPECT_TRUE(notApplied(readWith({"ShutterShape=BITMAP"}), "a bitmap shutter"));
  EXPECT_TRUE(notApplied(readWith({"ImageRotation=45"}), "a rotation that is not by right angles"));
  EXPECT_TRUE(notApplied(readWith({"(6000,1001)=LAYER"}), "overlays"));
  EXPECT_TRUE(notApplied(
      readWith({"GraphicAnnotationSequence[0].CompoundGraphicSequence[0].CompoundGraphicType=ARROW"}),
      "compound graphics"));
  const PresentationState p =
      readWith({"DisplayedAreaSelectionSequence[0].DisplayedAreaTopLeftHandCorner=1\\1",
                "DisplayedAreaSelectionSequence[0].DisplayedAreaBottomRightHandCorner=4\\4",
                "DisplayedAreaSelectionSequence[0].PresentationSizeMode=TRUE SIZE"});
  EXPECT_NE(presentationFor(p, "2.25.1002.1", 1)->notApplied.at(0).find("true size"), std::string::npos);
}

TEST(Presentation, GraphicsInTheOrderOfTheirLayers) {
  const PresentationState p =
      readWith({"GraphicLayerSequence[0].GraphicLayer=UPPER", "GraphicLayerSequence[0].GraphicLayerOrder=2",
                "GraphicLayerSequence[0].GraphicLayerRecommendedDisplayGrayscaleValue=32768",
                "GraphicLayerSequence[1].GraphicLayer=LOWER", "GraphicLayerSequence[1].GraphicLayerOrder=1",
                "GraphicAnnotationSequence[0].GraphicLayer=UPPER",
                "GraphicAnnotationSequence[0].GraphicObjectSequence[0].GraphicAnnotationUnits=PIXEL",
                "GraphicAnnotationSequence[0].GraphicObjectSequence[0].GraphicType=POLYLINE",
                "GraphicAnnotationSequence[0].GraphicObjectSequence[0].GraphicData=1\\2\\3\\4.5\\5\\6",
                "GraphicAnnotationSequence[0].GraphicObjectSequence[0].GraphicFilled=N",
                "GraphicAnnotationSequence[1].GraphicLayer=LOWER",
                "GraphicAnnotationSequence[1].TextObjectSequence[0].UnformattedTextValue=look\r\nhere",
                "GraphicAnnotationSequence[1].TextObjectSequence[0].AnchorPointAnnotationUnits=DISPLAY",
                "GraphicAnnotationSequence[1].TextObjectSequence[0].AnchorPoint=0.25\\0.75",
                "GraphicAnnotationSequence[1].TextObjectSequence[0].AnchorPointVisibility=Y"});
  EXPECT_TRUE(p.notApplied.empty());
  const FramePresentation f = *presentationFor(p, "2.25.1002.1", 1);
  ASSERT_EQ(f.annotations.size(), 2u);
  ASSERT_EQ(f.annotations[0].texts.size(), 1u);
  EXPECT_EQ(f.annotations[0].texts[0].text, "look\nhere");
  EXPECT_EQ(*f.annotations[0].texts[0].anchor, glm::dvec2(0.25, 0.75));
  EXPECT_EQ(f.annotations[0].texts[0].anchorUnits, GraphicUnits::Display);
  ASSERT_EQ(f.annotations[1].graphics.size(), 1u);
  EXPECT_EQ(f.annotations[1].graphics[0].points[1], glm::dvec2(3, 4.5));
  EXPECT_NEAR(f.annotations[1].grey, 0.5, 1e-4);
}

TEST(Presentation, RealOne) {
  VERNIER_NEEDS_DATA("gsps_luts");
  const auto set = scanStudy({(test::dataDir() / "gsps_luts").string()});
  ASSERT_TRUE(set.ok());
  ASSERT_EQ(set->presentations.size(), 1u);
  const PresentationState& p = set->presentations[0];
  EXPECT_EQ(p.label, "XLUT_P03");
  ASSERT_EQ(p.images.size(), 1u);
  EXPECT_EQ(p.images[0].sopInstanceUid, "1.2.276.0.7230010.3.200.6.3.1");
  EXPECT_TRUE(p.modalityLut && p.presentationLut);
  EXPECT_EQ(p.presentationLut->data.size(), 256u);
  EXPECT_TRUE(p.notApplied.empty());
  EXPECT_EQ(set->instances[p.instance].notShown, "applied on request: presentation state");
}

}  // namespace
}  // namespace vernier
