// SPDX-License-Identifier: GPL-3.0-or-later
#include "Files.h"

#include <charls/charls.h>
#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dcpixseq.h>
#include <dcmtk/dcmdata/dcpxitem.h>
#include <dcmtk/dcmdata/dcrledrg.h>
#include <dcmtk/dcmdata/dctk.h>
#include <dcmtk/dcmjpeg/djdecode.h>
#include <gtest/gtest.h>
#include <openjpeg.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <memory>

namespace vernier::test {
namespace {

std::string text(DcmItem& item, const DcmTagKey& tag) {
  OFString value;
  item.findAndGetOFStringArray(tag, value);
  return value.c_str();
}
double number(DcmItem& item, const DcmTagKey& tag, unsigned long n, double otherwise) {
  Float64 value = otherwise;
  return item.findAndGetFloat64(tag, value, n).good() ? value : otherwise;
}
int word(DcmItem& item, const DcmTagKey& tag) {
  Uint16 value = 0;
  EXPECT_TRUE(item.findAndGetUint16(tag, value).good());
  return value;
}

struct Memory {
  const Uint8* data;
  std::size_t size, at;
};

// The bytes of the first fragment, which holds the whole frame.
std::pair<const Uint8*, std::size_t> fragmentOf(DcmItem& dataset, const std::string& transferSyntax) {
  DcmElement* element = nullptr;
  dataset.findAndGetElement(DCM_PixelData, element);
  auto& pixels = dynamic_cast<DcmPixelData&>(*element);
  DcmPixelSequence* sequence = nullptr;
  const E_TransferSyntax xfer = DcmXfer(transferSyntax.c_str()).getXfer();
  EXPECT_TRUE(pixels.getEncapsulatedRepresentation(xfer, nullptr, sequence).good());
  DcmPixelItem* item = nullptr;
  EXPECT_TRUE(sequence->getItem(item, 1).good());
  Uint8* bytes = nullptr;
  item->getUint8Array(bytes);
  return {bytes, item->getLength()};
}

// By CharLS itself: DCMTK's decoder brings another CharLS whose symbols clash with the one that wrote the
// files.
std::vector<int> decodeJpegLs(DcmItem& dataset, const ReadFile& f) {
  const auto [bytes, length] = fragmentOf(dataset, f.transferSyntax);
  charls::jpegls_decoder decoder;
  decoder.source(bytes, length);
  decoder.read_header();
  EXPECT_EQ(decoder.frame_info().bits_per_sample, f.bitsStored);
  std::vector<std::uint16_t> words(static_cast<std::size_t>(f.rows) * static_cast<std::size_t>(f.columns));
  EXPECT_EQ(decoder.destination_size(), words.size() * 2);
  decoder.decode(words.data(), words.size() * 2);
  return {words.begin(), words.end()};
}

std::vector<int> decodeJpeg2000(DcmItem& dataset) {
  const auto [bytes, length] = fragmentOf(dataset, UID_JPEG2000LosslessOnlyTransferSyntax);
  Memory memory{bytes, length, 0};
  opj_stream_t* stream = opj_stream_default_create(OPJ_TRUE);
  opj_stream_set_user_data(stream, &memory, nullptr);
  opj_stream_set_user_data_length(stream, memory.size);
  opj_stream_set_read_function(stream, [](void* to, OPJ_SIZE_T n, void* from) -> OPJ_SIZE_T {
    auto& m = *static_cast<Memory*>(from);
    if (m.at == m.size) return static_cast<OPJ_SIZE_T>(-1);
    n = std::min(n, m.size - m.at);
    std::memcpy(to, m.data + m.at, n);
    m.at += n;
    return n;
  });
  opj_codec_t* codec = opj_create_decompress(OPJ_CODEC_J2K);
  opj_dparameters_t parameters;
  opj_set_default_decoder_parameters(&parameters);
  opj_image_t* image = nullptr;
  EXPECT_TRUE(opj_setup_decoder(codec, &parameters) && opj_read_header(stream, codec, &image) &&
              opj_decode(codec, stream, image));
  const std::size_t count = static_cast<std::size_t>(image->comps[0].w) * image->comps[0].h;
  std::vector<int> values(image->comps[0].data, image->comps[0].data + count);
  opj_image_destroy(image);
  opj_destroy_codec(codec);
  opj_stream_destroy(stream);
  return values;
}

std::vector<int> pixelsOf(DcmDataset& dataset, const ReadFile& f) {
  if (f.transferSyntax == UID_JPEG2000LosslessOnlyTransferSyntax) return decodeJpeg2000(dataset);
  if (f.transferSyntax == UID_JPEGLSLosslessTransferSyntax ||
      f.transferSyntax == UID_JPEGLSLossyTransferSyntax)
    return decodeJpegLs(dataset, f);
  EXPECT_TRUE(dataset.chooseRepresentation(EXS_LittleEndianExplicit, nullptr).good()) << f.name;
  const std::size_t count = static_cast<std::size_t>(f.rows) * static_cast<std::size_t>(f.columns);
  std::vector<int> values(count);
  if (word(dataset, DCM_BitsAllocated) == 8) {
    const Uint8* bytes = nullptr;
    unsigned long n = 0;
    EXPECT_TRUE(dataset.findAndGetUint8Array(DCM_PixelData, bytes, &n).good());
    if (n >= count) std::copy(bytes, bytes + count, values.begin());
    return values;
  }
  const Uint16* words = nullptr;
  unsigned long n = 0;
  EXPECT_TRUE(dataset.findAndGetUint16Array(DCM_PixelData, words, &n).good());
  EXPECT_EQ(n, count);
  for (std::size_t i = 0; i < std::min<std::size_t>(n, count); ++i) {
    int v = words[i] & ((1 << f.bitsStored) - 1);
    if (f.isSigned && (v >> (f.bitsStored - 1)) & 1) v -= 1 << f.bitsStored;
    values[i] = v;
  }
  return values;
}

ReadFile readOne(const std::filesystem::path& path) {
  DcmFileFormat format;
  EXPECT_TRUE(format.loadFile(path.c_str()).good()) << path.filename();
  DcmDataset& d = *format.getDataset();
  ReadFile f;
  f.name = path.filename().string();
  f.sopClass = text(d, DCM_SOPClassUID);
  f.sopUid = text(d, DCM_SOPInstanceUID);
  f.seriesUid = text(d, DCM_SeriesInstanceUID);
  f.frameUid = text(d, DCM_FrameOfReferenceUID);
  f.transferSyntax = text(*format.getMetaInfo(), DCM_TransferSyntaxUID);
  f.modality = text(d, DCM_Modality);
  f.description = text(d, DCM_SeriesDescription);
  f.windowCenter = text(d, DCM_WindowCenter);
  f.windowWidth = text(d, DCM_WindowWidth);
  f.windowFunction = text(d, DCM_VOILUTFunction);
  Sint32 instance = -1;
  EXPECT_TRUE(d.findAndGetSint32(DCM_InstanceNumber, instance).good());
  f.instanceNumber = static_cast<int>(instance);
  f.rows = word(d, DCM_Rows);
  f.columns = word(d, DCM_Columns);
  f.bitsStored = word(d, DCM_BitsStored);
  f.isSigned = word(d, DCM_PixelRepresentation) == 1;
  Sint16 padding = 0;
  f.hasPadding = d.findAndGetSint16(DCM_PixelPaddingValue, padding).good();
  f.padding = padding;
  f.slope = number(d, DCM_RescaleSlope, 0, 1);
  f.intercept = number(d, DCM_RescaleIntercept, 0, 0);
  for (unsigned n = 0; n < 3; ++n) f.origin[n] = number(d, DCM_ImagePositionPatient, n, 1e300);
  for (unsigned n = 0; n < 6; ++n) f.orientation[n] = number(d, DCM_ImageOrientationPatient, n, 1e300);
  for (unsigned n = 0; n < 2; ++n) f.spacing[n] = number(d, DCM_PixelSpacing, n, 1e300);
  f.stored = pixelsOf(d, f);
  return f;
}

}  // namespace

double ReadFile::normal(int axis) const {
  const int a = (axis + 1) % 3, b = (axis + 2) % 3;
  return orientation[a] * orientation[3 + b] - orientation[b] * orientation[3 + a];
}
double ReadFile::positionAlongNormal() const {
  return origin[0] * normal(0) + origin[1] * normal(1) + origin[2] * normal(2);
}

std::vector<ReadFile> readFolder(const std::filesystem::path& folder) {
  static const bool registered = [] {
    DJDecoderRegistration::registerCodecs();
    DcmRLEDecoderRegistration::registerCodecs();
    return true;
  }();
  EXPECT_TRUE(registered);
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  std::vector<ReadFile> files;
  for (const auto& path : paths) files.push_back(readOne(path));
  return files;
}

Result<PhantomInfo> writeOnly(const std::filesystem::path& dir, const std::string& name,
                              const std::map<std::string, std::string>& settings) {
  PhantomOptions options;
  options.settings = settings;
  return writePhantom(name, dir, options);
}

Written writeAndRead(const std::filesystem::path& dir, const std::string& name,
                     const std::map<std::string, std::string>& settings) {
  const Result<PhantomInfo> info = writeOnly(dir, name, settings);
  EXPECT_TRUE(info.ok()) << (info.ok() ? "" : info.error().text());
  if (!info) return {};
  std::ifstream in(info->answers);
  Written w{info->data, nlohmann::json::parse(in), readFolder(info->data)};
  EXPECT_EQ(w.files.size(), info->files);
  return w;
}

}  // namespace vernier::test
