// SPDX-License-Identifier: GPL-3.0-or-later
// Enhanced CT (PS3.3 A.38) and Enhanced MR (A.36): every functional group macro that the IOD demands of an
// original image, shared where it holds for all frames.
#include <algorithm>

#include "DicomParts.h"
#include "MultiFrame.h"
#include "Sample.h"

namespace vernier::phantoms {
namespace {

constexpr const char* kWhen = "20260101120000";

void putFloat64(const Data& d, const DcmTagKey& tag, const std::vector<double>& v) {
  check(d.item.putAndInsertFloat64Array(tag, v.data(), static_cast<unsigned long>(v.size())), "attribute");
}
using Texts = std::initializer_list<std::pair<DcmTagKey, const char*>>;
void putTexts(const Data& d, Texts texts) {
  for (const auto& [tag, value] : texts) d.text(tag, value);
}

void putFrameType(const Data& d, bool mr) {
  putTexts(d, {{DCM_PixelPresentation, "MONOCHROME"},
               {DCM_VolumetricProperties, "VOLUME"},
               {DCM_VolumeBasedCalculationTechnique, "NONE"}});
  if (mr) putTexts(d, {{DCM_ComplexImageComponent, "MAGNITUDE"}, {DCM_AcquisitionContrast, "T2"}});
}

void putRoot(const Data& d, const StudyPlan& study, const SeriesPlan& s, const ObjectPlan& o,
             std::size_t object) {
  const bool mr = s.storage == Storage::EnhancedMr;
  putPatientAndStudy(d, study);
  putSeriesCommon(d, study, modalityOf(s.storage), s.seriesUid, s.number, s.description);
  putTexts(d, {{DCM_SOPClassUID, mr ? UID_EnhancedMRImageStorage : UID_EnhancedCTImageStorage},
               {DCM_ImageType, "ORIGINAL\\PRIMARY\\VOLUME\\NONE"},
               {DCM_ContentDate, "20260101"},
               {DCM_ContentTime, "120000"},
               {DCM_AcquisitionNumber, "1"},
               {DCM_AcquisitionDateTime, kWhen},
               {DCM_ContentQualification, "PRODUCT"},
               {DCM_PatientPosition, "HFS"},
               {DCM_PresentationLUTShape, "IDENTITY"},
               {DCM_BurnedInAnnotation, "NO"},
               {DCM_LossyImageCompression, "00"},
               {DCM_DeviceSerialNumber, "1"},
               {DCM_SoftwareVersions, "1"}});
  putFloat64(d, DCM_AcquisitionDuration, {1});
  putFrameType(d, mr);
  d.text(DCM_SOPInstanceUID, o.sopUid);
  d.text(DCM_InstanceNumber, std::to_string(s.objects.size() - object));
  check(d.item.insertEmptyElement(DCM_AcquisitionContextSequence), "sequence");
  if (!s.concatenationUid.empty()) {
    d.text(DCM_ConcatenationUID, s.concatenationUid);
    d.text(DCM_SOPInstanceUIDOfConcatenationSource, uidOf(study.name, study.seed, "concatenation source"));
    d.number(DCM_InConcatenationNumber, static_cast<int>(object) + 1);
    d.number(DCM_InConcatenationTotalNumber, static_cast<int>(s.objects.size()));
    putUl(d, DCM_ConcatenationFrameOffsetNumber, {static_cast<std::uint32_t>(o.firstFrame)});
  }
  if (!mr) return;
  putTexts(d, {{DCM_ResonantNucleus, "1H"},
               {DCM_KSpaceFiltering, "NONE"},
               {DCM_ApplicableSafetyStandardAgency, "IEC"},
               {DCM_EchoPulseSequence, "SPIN"},
               {DCM_MultipleSpinEcho, "NO"},
               {DCM_MultiPlanarExcitation, "NO"},
               {DCM_SteadyStatePulseSequence, "NONE"},
               {DCM_EchoPlanarPulseSequence, "NO"},
               {DCM_SaturationRecovery, "NO"},
               {DCM_SpectrallySelectedSuppression, "NONE"},
               {DCM_OversamplingPhase, "NONE"},
               {DCM_GeometryOfKSpaceTraversal, "RECTILINEAR"},
               {DCM_RectilinearPhaseEncodeReordering, "LINEAR"},
               {DCM_SegmentedKSpaceTraversal, "SINGLE"},
               {DCM_PulseSequenceName, "SE"},
               {DCM_MRAcquisitionType, "2D"},
               {DCM_PhaseContrast, "NO"},
               {DCM_TimeOfFlightContrast, "NO"}});
  d.number(DCM_NumberOfKSpaceTrajectories, 1);
  d.text(DCM_MagneticFieldStrength, "1.5");
}

void putCtShared(const Data& g, const SeriesPlan& s, const StudyPlan& study) {
  const Data value = g.in(DCM_PixelValueTransformationSequence);
  value.text(DCM_RescaleIntercept, dsOf(s.intercept));
  value.text(DCM_RescaleSlope, dsOf(s.slope));
  value.text(DCM_RescaleType, "HU");
  putTexts(g.in(DCM_CTAcquisitionTypeSequence),
           {{DCM_AcquisitionType, "SPIRAL"}, {DCM_ConstantVolumeFlag, "NO"}, {DCM_FluoroscopyFlag, "NO"}});
  const Data details = g.in(DCM_CTAcquisitionDetailsSequence);
  details.text(DCM_RotationDirection, "CW");
  details.text(DCM_TableHeight, "0");
  details.text(DCM_GantryDetectorTilt, "0");
  details.text(DCM_DataCollectionDiameter, "500");
  putFloat64(details, DCM_RevolutionTime, {1});
  putFloat64(details, DCM_SingleCollimationWidth, {1});
  putFloat64(details, DCM_TotalCollimationWidth, {16});
  const Data table = g.in(DCM_CTTableDynamicsSequence);
  putFloat64(table, DCM_TableSpeed, {16});
  putFloat64(table, DCM_TableFeedPerRotation, {16});
  putFloat64(table, DCM_SpiralPitchFactor, {1});
  const Data geometry = g.in(DCM_CTGeometrySequence);
  geometry.text(DCM_DistanceSourceToDetector, "1000");
  putFloat64(geometry, DCM_DistanceSourceToDataCollectionCenter, {500});
  const Data reconstruction = g.in(DCM_CTReconstructionSequence);
  putTexts(reconstruction, {{DCM_ReconstructionAlgorithm, "FILTER_BACK_PROJ"},
                            {DCM_ImageFilter, "NONE"},
                            {DCM_ConvolutionKernel, "B30"},
                            {DCM_ConvolutionKernelGroup, "SOFT_TISSUE"}});
  reconstruction.text(DCM_ReconstructionDiameter, dsOf(static_cast<double>(s.columns) * s.columnSpacing_mm));
  putFloat64(reconstruction, DCM_ReconstructionAngle, {360});
  putFloat64(reconstruction, DCM_ReconstructionPixelSpacing, {s.rowSpacing_mm, s.columnSpacing_mm});
  const Data exposure = g.in(DCM_CTExposureSequence);
  exposure.text(DCM_ExposureModulationType, "NONE");
  putFloat64(exposure, DCM_ExposureTimeInms, {100});
  putFloat64(exposure, DCM_XRayTubeCurrentInmA, {100});
  putFloat64(exposure, DCM_ExposureInmAs, {10});
  const Data xray = g.in(DCM_CTXRayDetailsSequence);
  putTexts(
      xray,
      {{DCM_KVP, "120"}, {DCM_FocalSpots, "1"}, {DCM_FilterType, "STRIP"}, {DCM_FilterMaterial, "ALUMINUM"}});
  g.in(DCM_IrradiationEventIdentificationSequence)
      .text(DCM_IrradiationEventUID, uidOf(study.name, study.seed, "irradiation"));
}

void putMrShared(const Data& g) {
  const Data timing = g.in(DCM_MRTimingAndRelatedParametersSequence);
  putTexts(timing, {{DCM_RepetitionTime, "2000"},
                    {DCM_FlipAngle, "90"},
                    {DCM_EchoTrainLength, "1"},
                    {DCM_GradientOutputType, "DB_DT"}});
  timing.number(DCM_RFEchoTrainLength, 1);
  timing.number(DCM_GradientEchoTrainLength, 0);
  putFloat64(timing, DCM_GradientOutput, {0});
  const Data sar = timing.in(DCM_SpecificAbsorptionRateSequence);
  sar.text(DCM_SpecificAbsorptionRateDefinition, "IEC_WHOLE_BODY");
  putFloat64(sar, DCM_SpecificAbsorptionRateValue, {0.1});
  putTexts(timing.in(DCM_OperatingModeSequence),
           {{DCM_OperatingModeType, "STATIC FIELD"}, {DCM_OperatingMode, "IEC_NORMAL"}});
  const Data view = g.in(DCM_MRFOVGeometrySequence);
  putTexts(view, {{DCM_PercentSampling, "100"},
                  {DCM_PercentPhaseFieldOfView, "100"},
                  {DCM_InPlanePhaseEncodingDirection, "ROW"}});
  view.number(DCM_MRAcquisitionFrequencyEncodingSteps, 48);
  view.number(DCM_MRAcquisitionPhaseEncodingStepsInPlane, 48);
  view.number(DCM_MRAcquisitionPhaseEncodingStepsOutOfPlane, 1);
  putTexts(g.in(DCM_MRModifierSequence), {{DCM_InversionRecovery, "NO"},
                                          {DCM_FlowCompensation, "NONE"},
                                          {DCM_Spoiling, "NONE"},
                                          {DCM_T2Preparation, "NO"},
                                          {DCM_SpectrallySelectedExcitation, "NONE"},
                                          {DCM_SpatialPresaturation, "NONE"},
                                          {DCM_PartialFourier, "NO"},
                                          {DCM_ParallelAcquisition, "NO"}});
  const Data imaging = g.in(DCM_MRImagingModifierSequence);
  putTexts(imaging, {{DCM_MagnetizationTransfer, "NONE"},
                     {DCM_BloodSignalNulling, "NO"},
                     {DCM_Tagging, "NONE"},
                     {DCM_PixelBandwidth, "100"}});
  putFloat64(imaging, DCM_TransmitterFrequency, {63.87});
  putTexts(g.in(DCM_MRReceiveCoilSequence), {{DCM_ReceiveCoilName, "BODY"},
                                             {DCM_ReceiveCoilManufacturerName, ""},
                                             {DCM_ReceiveCoilType, "BODY"},
                                             {DCM_QuadratureReceiveCoil, "NO"}});
  putTexts(g.in(DCM_MRTransmitCoilSequence), {{DCM_TransmitCoilName, "BODY"},
                                              {DCM_TransmitCoilManufacturerName, ""},
                                              {DCM_TransmitCoilType, "BODY"}});
  g.in(DCM_MRAveragesSequence).text(DCM_NumberOfAverages, "1");
}

void putShared(const Data& d, const StudyPlan& study, const SeriesPlan& s) {
  const bool mr = s.storage == Storage::EnhancedMr;
  const SlicePlan& first = s.slices.front();
  const Data g = d.in(DCM_SharedFunctionalGroupsSequence);
  const Data type = g.in(mr ? DCM_MRImageFrameTypeSequence : DCM_CTImageFrameTypeSequence);
  type.text(DCM_FrameType, "ORIGINAL\\PRIMARY\\VOLUME\\NONE");
  putFrameType(type, mr);
  g.in(DCM_PlaneOrientationSequence)
      .text(DCM_ImageOrientationPatient,
            vectorDs(first.rowDirection) + "\\" + vectorDs(first.columnDirection));
  const Data measures = g.in(DCM_PixelMeasuresSequence);
  measures.text(DCM_PixelSpacing, dsOf(s.rowSpacing_mm) + "\\" + dsOf(s.columnSpacing_mm));
  measures.text(DCM_SliceThickness, dsOf(s.thickness_mm));
  const Data anatomy = g.in(DCM_FrameAnatomySequence);
  anatomy.text(DCM_FrameLaterality, "U");
  anatomy.code(DCM_AnatomicRegionSequence, "51185008", "SCT", "Chest");
  if (!first.windows.empty()) {
    const Data voi = g.in(DCM_FrameVOILUTSequence);
    voi.text(DCM_WindowCenter, first.windows.front().center);
    voi.text(DCM_WindowWidth, first.windows.front().width);
  }
  if (mr)
    putMrShared(g);
  else
    putCtShared(g, s, study);
}

void putFrame(const Data& g, const SeriesPlan& s, const SlicePlan& slice, bool diffusion) {
  const Data content = g.in(DCM_FrameContentSequence);
  content.number(DCM_FrameAcquisitionNumber, 1);
  content.text(DCM_FrameReferenceDateTime, kWhen);
  content.text(DCM_FrameAcquisitionDateTime, kWhen);
  putFloat64(content, DCM_FrameAcquisitionDuration, {1});
  content.text(DCM_StackID, "1");
  const auto place = static_cast<std::uint32_t>(slice.position) + 1;
  putUl(content, DCM_InStackPositionNumber, {place});
  g.in(DCM_PlanePositionSequence).text(DCM_ImagePositionPatient, vectorDs(slice.origin_mm));
  if (s.storage == Storage::EnhancedCt) {
    putUl(content, DCM_DimensionIndexValues, {1, place});
    const Data position = g.in(DCM_CTPositionSequence);
    putFloat64(position, DCM_TablePosition, {0});
    putFloat64(position, DCM_ReconstructionTargetCenterPatient, {0, 0, 0});
    putFloat64(position, DCM_DataCollectionCenterPatient, {0, 0, 0});
    return;
  }
  const bool second = slice.factor != 1;
  putUl(content, DCM_DimensionIndexValues, {1, place, second ? 2u : 1u});
  putFloat64(g.in(DCM_MREchoSequence), DCM_EffectiveEchoTime, {slice.echoTime_ms});
  const Data value = g.in(DCM_PixelValueTransformationSequence);
  value.text(DCM_RescaleIntercept, dsOf(s.intercept));
  value.text(DCM_RescaleSlope, dsOf(slopeOf(s, slice)));
  value.text(DCM_RescaleType, "US");
  if (!diffusion) return;
  const Data weighting = g.in(DCM_MRDiffusionSequence);
  weighting.text(DCM_DiffusionDirectionality, slice.bValue_s_mm2 > 0 ? "ISOTROPIC" : "NONE");
  putFloat64(weighting, DCM_DiffusionBValue, {slice.bValue_s_mm2});
}

void putPixels(const Data& d, const SeriesPlan& s, const ObjectPlan& o,
               const std::vector<std::vector<std::int32_t>>& stored) {
  d.number(DCM_SamplesPerPixel, 1);
  d.text(DCM_PhotometricInterpretation, "MONOCHROME2");
  d.text(DCM_NumberOfFrames, std::to_string(o.slices.size()));
  d.number(DCM_Rows, static_cast<int>(s.rows));
  d.number(DCM_Columns, static_cast<int>(s.columns));
  d.number(DCM_BitsAllocated, 16);
  d.number(DCM_BitsStored, s.bitsStored);
  d.number(DCM_HighBit, s.bitsStored - 1);
  d.number(DCM_PixelRepresentation, s.isSigned ? 1 : 0);
  const std::uint32_t mask = (1u << s.bitsStored) - 1;
  std::vector<Uint16> words;
  for (const std::size_t k : o.slices)
    for (const std::int32_t v : stored[k])
      words.push_back(static_cast<Uint16>(static_cast<std::uint32_t>(v) & mask));
  check(d.item.putAndInsertUint16Array(DCM_PixelData, words.data(), static_cast<unsigned long>(words.size())),
        "pixels");
}

}  // namespace

Result<void> writeEnhanced(const StudyPlan& study, const SeriesPlan& s, std::size_t object,
                           const std::vector<std::vector<std::int32_t>>& stored,
                           const std::filesystem::path& folder) {
  const ObjectPlan& o = s.objects[object];
  DcmFileFormat format;
  const Data d{*format.getDataset()};
  putRoot(d, study, s, o, object);
  std::vector<DimensionPlan> dimensions{
      {DCM_StackID, DCM_FrameContentSequence, "Stack ID"},
      {DCM_InStackPositionNumber, DCM_FrameContentSequence, "In-Stack Position"}};
  const bool diffusion =
      std::any_of(s.slices.begin(), s.slices.end(), [](const SlicePlan& p) { return p.bValue_s_mm2 >= 0; });
  if (s.storage == Storage::EnhancedMr) {
    if (diffusion)
      dimensions.push_back({DCM_DiffusionBValue, DCM_MRDiffusionSequence, "b-value"});
    else
      dimensions.push_back({DCM_EffectiveEchoTime, DCM_MREchoSequence, "Echo Time"});
  }
  putDimensions(d, uidOf(study.name, study.seed, "dimensions"), dimensions);
  putShared(d, study, s);
  for (const std::size_t k : o.slices)
    putFrame(d.add(DCM_PerFrameFunctionalGroupsSequence), s, s.slices[k], diffusion);
  putPixels(d, s, o, stored);
  putMeta(*format.getMetaInfo(),
          s.storage == Storage::EnhancedMr ? UID_EnhancedMRImageStorage : UID_EnhancedCTImageStorage,
          o.sopUid, s.transferSyntaxUid);
  return saved(format, DcmXfer(s.transferSyntaxUid.c_str()).getXfer(), folder / o.fileName);
}

}  // namespace vernier::phantoms
