// SPDX-License-Identifier: GPL-3.0-or-later
#include "MetaImage.h"

#include <bit>
#include <cmath>
#include <fstream>

namespace vernier::phantoms {
namespace {

std::string triple(glm::dvec3 v) { return dsOf(v.x) + " " + dsOf(v.y) + " " + dsOf(v.z); }

}  // namespace

Result<void> canBeMetaImage(const StudyPlan& study) {
  const auto refuse = [&](const char* why) {
    return makeError(
        ErrorCode::OptionInvalid,
        std::string("The phantom cannot be written as MetaImage: ") + why + "; write it as DICOM.",
        study.name);
  };
  if (study.series.size() != 1) return refuse("it has several series");
  const SeriesPlan& s = study.series.front();
  if (!s.isSigned && s.bitsStored > 15) return refuse("its values do not fit in signed 16 bits");
  for (std::size_t k = 0; k < s.slices.size(); ++k) {
    const SlicePlan& a = s.slices.front();
    const glm::dvec3 normal = glm::cross(a.rowDirection, a.columnDirection);
    const glm::dvec3 off = s.slices[k].origin_mm - a.origin_mm - static_cast<double>(k) * s.step_mm * normal;
    if (s.slices[k].rowDirection != a.rowDirection || std::sqrt(glm::dot(off, off)) > 1e-6 * s.step_mm)
      return refuse("its slices do not lie on one even lattice");
  }
  return {};
}

namespace {

Result<void> write(const SeriesPlan& s, const std::string& element, const void* voxels, std::size_t bytes,
                   const std::filesystem::path& mhd) {
  static_assert(std::endian::native == std::endian::little, "the raw file is little endian");
  const SlicePlan& first = s.slices.front();
  const glm::dvec3 normal = glm::cross(first.rowDirection, first.columnDirection);
  std::filesystem::path raw = mhd;
  raw.replace_extension(".raw");
  std::ofstream header(mhd, std::ios::binary);
  header << "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = "
            "False\nCompressedData = False\n"
         << "TransformMatrix = " << triple(first.rowDirection) << ' ' << triple(first.columnDirection) << ' '
         << triple(normal) << "\nOffset = " << triple(first.origin_mm) << "\nCenterOfRotation = 0 0 0\n"
         << "ElementSpacing = " << dsOf(s.columnSpacing_mm) << ' ' << dsOf(s.rowSpacing_mm) << ' '
         << dsOf(s.step_mm) << "\nDimSize = " << s.columns << ' ' << s.rows << ' ' << s.slices.size() << "\n"
         << element << "ElementDataFile = " << raw.filename().string() << '\n';
  std::ofstream data(raw, std::ios::binary);
  data.write(static_cast<const char*>(voxels), static_cast<std::streamsize>(bytes));
  header.close();
  data.close();
  if (!header || !data)
    return makeError(ErrorCode::WriteFailed,
                     "The MetaImage cannot be written; check the folder and the disk.",
                     mhd.filename().string());
  return {};
}

}  // namespace

Result<void> writeMetaImage(const SeriesPlan& s, const std::vector<std::int16_t>& volume,
                            const std::filesystem::path& mhd) {
  return write(s, "ElementType = MET_SHORT\n", volume.data(), volume.size() * 2, mhd);
}

Result<void> writeMetaImage(const SeriesPlan& s, const std::vector<std::uint8_t>& interleaved,
                            const std::filesystem::path& mhd) {
  const std::size_t voxels = static_cast<std::size_t>(s.columns * s.rows) * s.slices.size();
  return write(s,
               "ElementNumberOfChannels = " + std::to_string(interleaved.size() / voxels) +
                   "\nElementType = MET_UCHAR\n",
               interleaved.data(), interleaved.size(), mhd);
}

}  // namespace vernier::phantoms
