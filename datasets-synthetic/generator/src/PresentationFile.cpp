// SPDX-License-Identifier: GPL-3.0-or-later
// A greyscale softcopy presentation state (PS3.3 A.33.1) for one slice of a study.
#include <memory>

#include "DicomFile.h"
#include "DicomParts.h"

namespace vernier::phantoms {
namespace {

void floats(const Data& d, const DcmTagKey& tag, const std::vector<Float32>& values) {
  check(d.item.putAndInsertFloat32Array(tag, values.data(), static_cast<unsigned long>(values.size())),
        "attribute");
}
void signedLongs(const Data& d, const DcmTagKey& tag, const std::vector<Sint32>& values) {
  auto element = std::make_unique<DcmSignedLong>(tag);
  check(element->putSint32Array(values.data(), static_cast<unsigned long>(values.size())), "attribute");
  check(d.item.insert(element.release(), true), "attribute");
}

void putPresentationSeries(const Data& d, const PresentationPlan& p) {
  d.text(DCM_SOPClassUID, UID_GrayscaleSoftcopyPresentationStateStorage);
  d.text(DCM_SOPInstanceUID, p.sopUid);
  d.text(DCM_Modality, "PR");
  d.text(DCM_SeriesInstanceUID, p.seriesUid);
  d.text(DCM_SeriesNumber, "2");
  d.text(DCM_SeriesDescription, "presentation state");
  d.text(DCM_Laterality, "");
  d.text(DCM_Manufacturer, "Vernier phantoms");
  d.text(DCM_InstanceNumber, "1");
  d.text(DCM_ContentLabel, p.label);
  d.text(DCM_ContentDescription, "Window, inversion, turn, flip, shutter and drawings");
  d.text(DCM_ContentCreatorName, "");
  d.text(DCM_PresentationCreationDate, "20260101");
  d.text(DCM_PresentationCreationTime, "120000");
}

void putPresentationGrey(const Data& d, const SeriesPlan& series, const PresentationPlan& p) {
  d.text(DCM_RescaleIntercept, dsOf(series.intercept));
  d.text(DCM_RescaleSlope, dsOf(series.slope));
  d.text(DCM_RescaleType, "HU");
  const Data voi = d.in(DCM_SoftcopyVOILUTSequence);
  voi.text(DCM_WindowCenter, dsOf(p.center));
  voi.text(DCM_WindowWidth, dsOf(p.width));
  d.text(DCM_PresentationLUTShape, p.inverse ? "INVERSE" : "IDENTITY");
}

void putPresentationPlace(const Data& d, const SeriesPlan& series, const PresentationPlan& p) {
  d.number(DCM_ImageRotation, p.rotation_deg);
  d.text(DCM_ImageHorizontalFlip, p.flip ? "Y" : "N");
  const Data area = d.in(DCM_DisplayedAreaSelectionSequence);
  signedLongs(area, DCM_DisplayedAreaTopLeftHandCorner, {1, 1});
  signedLongs(area, DCM_DisplayedAreaBottomRightHandCorner,
              {static_cast<Sint32>(series.columns), static_cast<Sint32>(series.rows)});
  area.text(DCM_PresentationSizeMode, "SCALE TO FIT");
  area.text(DCM_PresentationPixelSpacing, dsOf(series.rowSpacing_mm) + "\\" + dsOf(series.columnSpacing_mm));
  d.text(DCM_ShutterShape, "RECTANGULAR");
  d.text(DCM_ShutterLeftVerticalEdge, std::to_string(p.shutter[0]));
  d.text(DCM_ShutterRightVerticalEdge, std::to_string(p.shutter[1]));
  d.text(DCM_ShutterUpperHorizontalEdge, std::to_string(p.shutter[2]));
  d.text(DCM_ShutterLowerHorizontalEdge, std::to_string(p.shutter[3]));
  d.number(DCM_ShutterPresentationValue, p.shutterValue);
}

// A circle in the middle of the frame and a text beside it, in one graphic layer.
void putPresentationGraphics(const Data& d, const SeriesPlan& series, const PresentationPlan& p) {
  const Data layer = d.in(DCM_GraphicLayerSequence);
  layer.text(DCM_GraphicLayer, "NOTES");
  layer.text(DCM_GraphicLayerOrder, "1");
  const Data annotation = d.in(DCM_GraphicAnnotationSequence);
  annotation.text(DCM_GraphicLayer, "NOTES");
  const auto column = static_cast<Float32>(series.columns) / 2, row = static_cast<Float32>(series.rows) / 2;
  const Data text = annotation.in(DCM_TextObjectSequence);
  text.text(DCM_UnformattedTextValue, p.text);
  text.text(DCM_AnchorPointAnnotationUnits, "PIXEL");
  floats(text, DCM_AnchorPoint, {column, row});
  text.text(DCM_AnchorPointVisibility, "N");
  const Data graphic = annotation.in(DCM_GraphicObjectSequence);
  graphic.text(DCM_GraphicAnnotationUnits, "PIXEL");
  graphic.number(DCM_GraphicDimensions, 2);
  graphic.number(DCM_NumberOfGraphicPoints, 2);
  floats(graphic, DCM_GraphicData, {column, row, column + 8, row});
  graphic.text(DCM_GraphicType, "CIRCLE");
  graphic.text(DCM_GraphicFilled, "N");
}

}  // namespace

Result<void> writePresentation(const StudyPlan& study, const PresentationPlan& p,
                               const std::filesystem::path& file) {
  DcmFileFormat format;
  const Data d{*format.getDataset()};
  const SeriesPlan& series = study.series.front();
  const SlicePlan& slice = series.slices.at(p.slice);
  putPatientAndStudy(d, study);
  putPresentationSeries(d, p);
  const Data referenced = d.in(DCM_ReferencedSeriesSequence);
  referenced.text(DCM_SeriesInstanceUID, series.seriesUid);
  const Data image = referenced.in(DCM_ReferencedImageSequence);
  image.text(DCM_ReferencedSOPClassUID, classOf(series.storage));
  image.text(DCM_ReferencedSOPInstanceUID, slice.sopUid);
  putPresentationGrey(d, series, p);
  putPresentationPlace(d, series, p);
  putPresentationGraphics(d, series, p);
  putMeta(*format.getMetaInfo(), UID_GrayscaleSoftcopyPresentationStateStorage, p.sopUid,
          UID_LittleEndianExplicitTransferSyntax);
  return saved(format, EXS_LittleEndianExplicit, file);
}

}  // namespace vernier::phantoms
