// SPDX-License-Identifier: GPL-3.0-or-later
// Which of the two affines holds: the sform when its code is above 0, else the qform when its code is above
// 0, else only the spacing is known (the standard's methods 3, 2 and 1). nibabel and FSL choose alike.
#include "files/Nifti.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "files/Affine.h"
#include "files/Channels.h"

namespace vernier {
namespace {

// Fields in file order of bytes, widened.
struct Fields {
  int version = 1;
  bool bigEndian = false;
  std::array<std::int64_t, 8> dim{};
  std::int64_t datatype = 0, bitpix = 0, qformCode = 0, sformCode = 0, units = 0;
  std::array<double, 8> pixdim{};
  double voxOffset = 0, slope = 0, inter = 0, calMax = 0, calMin = 0;
  std::array<double, 6> quatern{};  // b c d, offsets x y z
  std::array<double, 12> srow{};
  bool pair = false;
};

class Bytes {
 public:
  Bytes(std::span<const std::byte> b, bool bigEndian) : b_(b), big_(bigEndian) {}
  template <class T>
  T at(std::size_t offset) const {
    std::array<std::byte, sizeof(T)> raw;
    std::memcpy(raw.data(), b_.data() + offset, sizeof(T));
    if (big_ == (std::endian::native == std::endian::little)) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<T>(raw);
  }
  template <class T, class To, std::size_t N>
  void fill(std::size_t offset, std::array<To, N>& out) const {
    for (std::size_t i = 0; i < N; ++i) out[i] = static_cast<To>(at<T>(offset + i * sizeof(T)));
  }

 private:
  std::span<const std::byte> b_;
  bool big_;
};

bool startsWith(std::span<const std::byte> b, std::size_t offset, std::string_view text) {
  return b.size() >= offset + text.size() && std::memcmp(b.data() + offset, text.data(), text.size()) == 0;
}

Fields readFirst(std::span<const std::byte> head, bool bigEndian) {
  const Bytes b(head, bigEndian);
  Fields f;
  f.bigEndian = bigEndian;
  b.fill<std::int16_t>(40, f.dim);
  f.datatype = b.at<std::int16_t>(70);
  f.bitpix = b.at<std::int16_t>(72);
  b.fill<float>(76, f.pixdim);
  f.voxOffset = b.at<float>(108);
  f.slope = b.at<float>(112);
  f.inter = b.at<float>(116);
  f.units = b.at<std::uint8_t>(123);
  f.calMax = b.at<float>(124);
  f.calMin = b.at<float>(128);
  f.qformCode = b.at<std::int16_t>(252);
  f.sformCode = b.at<std::int16_t>(254);
  b.fill<float>(256, f.quatern);
  b.fill<float>(280, f.srow);
  f.pair = startsWith(head, 344, "ni1");
  return f;
}

Fields readSecond(std::span<const std::byte> head, bool bigEndian) {
  const Bytes b(head, bigEndian);
  Fields f;
  f.version = 2;
  f.bigEndian = bigEndian;
  f.datatype = b.at<std::int16_t>(12);
  f.bitpix = b.at<std::int16_t>(14);
  b.fill<std::int64_t>(16, f.dim);
  b.fill<double>(104, f.pixdim);
  f.voxOffset = static_cast<double>(b.at<std::int64_t>(168));
  f.slope = b.at<double>(176);
  f.inter = b.at<double>(184);
  f.calMax = b.at<double>(192);
  f.calMin = b.at<double>(200);
  f.qformCode = b.at<std::int32_t>(344);
  f.sformCode = b.at<std::int32_t>(348);
  b.fill<double>(352, f.quatern);
  b.fill<double>(400, f.srow);
  f.units = b.at<std::int32_t>(500);
  f.pair = startsWith(head, 4, "ni2");
  return f;
}

Error damaged(const std::string& sentence) {
  return makeError(ErrorCode::FileDamaged, "The NIfTI header cannot be used: " + sentence);
}
Error notRead(const std::string& sentence) { return makeError(ErrorCode::NotBuiltYet, sentence); }

// RGB24 and RGBA32 are bytes, one after the other in each voxel.
constexpr std::int64_t kRgb24 = 128, kRgba32 = 2304;
std::int64_t channelsOf(std::int64_t code) { return code == kRgb24 ? 3 : code == kRgba32 ? 4 : 1; }

std::optional<FileType> typeOf(std::int64_t code) {
  switch (code) {
    case 2:
    case kRgb24:
    case kRgba32:
      return FileType::U8;
    case 4:
      return FileType::I16;
    case 8:
      return FileType::I32;
    case 16:
      return FileType::F32;
    case 64:
      return FileType::F64;
    case 256:
      return FileType::I8;
    case 512:
      return FileType::U16;
    case 768:
      return FileType::U32;
    case 1024:
      return FileType::I64;
    case 1280:
      return FileType::U64;
    default:
      return std::nullopt;
  }
}

Result<void> readType(const Fields& f, ParsedVolume& p) {
  const auto type = typeOf(f.datatype);
  if (!type)
    return notRead("NIfTI data type " + std::to_string(f.datatype) +
                   " is not read (complex, 128 bit or unknown); convert the file to integers or floats.");
  const std::int64_t bits = static_cast<std::int64_t>(8 * bytesOf(*type)) * channelsOf(f.datatype);
  if (f.bitpix != 0 && f.bitpix != bits)
    return damaged("its data type has " + std::to_string(bits) + " bits, but bitpix says " +
                   std::to_string(f.bitpix) + ".");
  p.place.type = *type;
  p.place.bigEndian = f.bigEndian;
  p.facts.storedType = nameOf(*type);
  p.facts.info.type = voxelTypeOf(*type);
  return setChannels(p, channelsOf(f.datatype));
}

Result<void> readSizes(const Fields& f, ParsedVolume& p) {
  const std::int64_t n = f.dim[0];
  if (n < 1 || n > 7) return damaged("dim[0] is " + std::to_string(n) + ", 1 to 7 dimensions are expected.");
  std::array<std::int64_t, 7> size{1, 1, 1, 1, 1, 1, 1};
  for (std::size_t d = 0; d < static_cast<std::size_t>(n); ++d) {
    size[d] = f.dim[d + 1];
    if (size[d] < 1)
      return damaged("dim[" + std::to_string(d + 1) + "] is " + std::to_string(size[d]) +
                     ", at least 1 is expected.");
  }
  for (std::size_t d = 4; d < 7; ++d)
    if (size[d] > 1)
      return notRead("The NIfTI file has " + std::to_string(n) +
                     " dimensions (vectors, tensors or more); files of "
                     "up to 4 dimensions are read. Save one component as a file of its own.");
  GridGeometry& g = p.facts.info.grid;
  g.columns = size[0], g.rows = size[1], g.slices = size[2];
  p.facts.frames = size[3];
  return {};
}

Result<void> readOffset(const Fields& f, ParsedVolume& p) {
  const double least = f.pair ? 0 : f.version == 1 ? 352 : 544;
  // Writers that leave the offset of a single file 0 mean its least value.
  const double offset = f.voxOffset == 0 ? least : f.voxOffset;
  if (!(offset >= (f.pair ? 0 : least - 4)) || offset > 0x1p53 || offset != std::floor(offset))
    return damaged("vox_offset is not a place behind the header.");
  p.place.skip = static_cast<std::uint64_t>(offset);
  return {};
}

// From NIfTI's units of length to mm. Unknown (0) is taken as mm, with a finding.
Result<double> mmPerUnit(const Fields& f, std::vector<Finding>& findings) {
  switch (f.units & 7) {
    case 1:
      return 1000.0;
    case 2:
      return 1.0;
    case 3:
      return 0.001;
    case 0:
      findings.push_back({"length-unit-assumed",
                          Severity::Notice,
                          "The file does not state its unit of length; millimetres are assumed.",
                          {}});
      return 1.0;
    default:
      return damaged("xyzt_units states a unit of length that is not defined.");
  }
}

PatientFromVoxel sform(const Fields& f) {
  PatientFromVoxel m;
  for (int row = 0; row < 3; ++row) {
    for (int axis = 0; axis < 3; ++axis)
      m.linear[axis][row] = f.srow[static_cast<std::size_t>(4 * row + axis)];
    m.translation[row] = f.srow[static_cast<std::size_t>(4 * row + 3)];
  }
  return m;
}

// Spacings of the three axes; that of an axis of one voxel may be missing.
Result<glm::dvec3> spacingOf(const Fields& f, const GridGeometry& g, std::vector<Finding>& findings) {
  const std::int64_t sizes[] = {g.columns, g.rows, g.slices};
  glm::dvec3 s(0);
  bool negative = false;
  for (int axis = 0; axis < 3; ++axis) {
    const double p = f.pixdim[static_cast<std::size_t>(axis + 1)];
    if (!std::isfinite(p) || (p == 0 && sizes[axis] > 1))
      return makeError(ErrorCode::GeometryRefused,
                       "pixdim[" + std::to_string(axis + 1) + "] is 0 or not a number; correct the header.");
    negative = negative || p < 0;
    s[axis] = std::abs(p);
  }
  if (negative)
    findings.push_back(
        {"negative-spacing",
         Severity::Notice,
         "A spacing is negative in the header; its absolute value is used, as other readers do.",
         {}});
  return s;
}

// The standard's quatern_to_mat44.
Result<PatientFromVoxel> qform(const Fields& f, const glm::dvec3& spacing) {
  double b = f.quatern[0], c = f.quatern[1], d = f.quatern[2];
  const double sum = b * b + c * c + d * d;
  if (!std::isfinite(sum) || sum > 1.0001)
    return makeError(ErrorCode::GeometryRefused,
                     "The quaternion of the qform is no rotation (its length is not 1); correct the header.");
  double a = 1 - sum;
  if (a < 1e-7) {
    const double scale = 1 / std::sqrt(sum);
    b *= scale, c *= scale, d *= scale, a = 0;
  } else {
    a = std::sqrt(a);
  }
  const double side = f.pixdim[0] < 0 ? -1 : 1;
  PatientFromVoxel m;
  m.linear[0] =
      spacing.x * glm::dvec3(a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c));
  m.linear[1] =
      spacing.y * glm::dvec3(2 * (b * c - a * d), a * a + c * c - b * b - d * d, 2 * (c * d + a * b));
  m.linear[2] =
      side * spacing.z * glm::dvec3(2 * (b * d + a * c), 2 * (c * d - a * b), a * a + d * d - c * c - b * b);
  m.translation = {f.quatern[3], f.quatern[4], f.quatern[5]};
  return m;
}

// Largest distance of the two places of a corner voxel.
double apart(const GridGeometry& g, const PatientFromVoxel& a, const PatientFromVoxel& b) {
  double most = 0;
  for (int n = 0; n < 8; ++n) {
    const VoxelPoint corner(n & 1 ? static_cast<double>(g.columns - 1) : 0.0,
                            n & 2 ? static_cast<double>(g.rows - 1) : 0.0,
                            n & 4 ? static_cast<double>(g.slices - 1) : 0.0);
    most = std::max(most, glm::length((a * corner).p - (b * corner).p));
  }
  return most;
}

void compareForms(const Fields& f, const GridGeometry& g, const PatientFromVoxel& s, double mm,
                  std::vector<Finding>& findings) {
  std::vector<Finding> ignored;
  const auto spacing = spacingOf(f, g, ignored);
  if (f.qformCode <= 0 || !spacing) return;
  const auto q = qform(f, *spacing);
  if (!q) return;
  const double off_mm = mm * apart(g, *q, s);
  const double least = 0.05 * mm * std::max({spacing->x, spacing->y, spacing->z});
  if (!(off_mm > least)) return;
  findings.push_back({"qform-sform-differ",
                      Severity::Notice,
                      "The file places the volume in two ways that differ by up to " +
                          std::to_string(static_cast<std::int64_t>(std::ceil(off_mm))) +
                          " mm; the sform is used, as most readers do.",
                      {{"largest_distance_mm", off_mm},
                       {"qform_code", static_cast<double>(f.qformCode)},
                       {"sform_code", static_cast<double>(f.sformCode)}}});
}

Result<void> readGeometry(const Fields& f, ParsedVolume& p) {
  std::vector<Finding>& findings = p.facts.info.findings;
  GridGeometry& g = p.facts.info.grid;
  const auto mm = mmPerUnit(f, findings);
  if (!mm) return mm.error();
  PatientFromVoxel ras;
  if (f.sformCode > 0) {
    ras = sform(f);
    compareForms(f, g, ras, *mm, findings);
  } else {
    const auto spacing = spacingOf(f, g, findings);
    if (!spacing) return spacing.error();
    if (f.qformCode > 0) {
      const auto q = qform(f, *spacing);
      if (!q) return q.error();
      ras = *q;
    } else {
      for (int axis = 0; axis < 3; ++axis) ras.linear[axis] = glm::dvec3(0);
      for (int axis = 0; axis < 3; ++axis) ras.linear[axis][axis] = (*spacing)[axis];
      findings.push_back(
          axesUnknown("The file does not say how it lies in the patient (qform and sform code are 0)."));
    }
  }
  for (int axis = 0; axis < 3; ++axis) ras.linear[axis] *= *mm;
  ras.translation *= *mm;
  g.patientFromVoxel = lpsFromRas(ras);
  return settleAxes(g);
}

// Slope 0 means "no scaling" by the standard; other values that cannot be used are shown unscaled and said.
void readValues(const Fields& f, VolumeInfo& info) {
  const bool none = f.slope == 0 || (std::isnan(f.slope) && std::isnan(f.inter));
  if (!none && std::isfinite(f.slope) && std::isfinite(f.inter)) {
    info.rescale = {{f.slope, f.inter}};
  } else if (!none) {
    info.unscaled = true;
    info.findings.push_back({"rescale-invalid",
                             Severity::Warning,
                             "scl_slope or scl_inter is not a number; stored values are shown, unscaled.",
                             {}});
  }
  if (std::isfinite(f.calMin) && std::isfinite(f.calMax) && f.calMax > f.calMin && !info.unscaled)
    info.windows.push_back(
        {(f.calMin + f.calMax) / 2, f.calMax - f.calMin, VoiFunction::LinearExact, "cal_min to cal_max"});
}

// 0: none; 1 and 2: NIfTI of that version; 3: Analyze 7.5.
struct Kind {
  int version = 0;
  bool bigEndian = false;
};
Kind kindOf(std::span<const std::byte> head) {
  if (head.size() < 348) return {};
  for (const bool big : {false, true}) {
    const std::int32_t size = Bytes(head, big).at<std::int32_t>(0);
    if (size == 540 && head.size() >= kNiftiHeaderBytes &&
        (startsWith(head, 4, std::string_view("n+2\0\r\n\x1a\n", 8)) ||
         startsWith(head, 4, std::string_view("ni2\0\r\n\x1a\n", 8))))
      return {2, big};
    if (size != 348) continue;
    if (startsWith(head, 344, std::string_view("n+1\0", 4)) ||
        startsWith(head, 344, std::string_view("ni1\0", 4)))
      return {1, big};
    const std::int16_t dims = Bytes(head, big).at<std::int16_t>(40);
    if (dims >= 1 && dims <= 7) return {3, big};
  }
  return {};
}

}  // namespace

bool looksLikeNifti(std::span<const std::byte> head) { return kindOf(head).version != 0; }

Result<NiftiHeader> parseNifti(std::span<const std::byte> head) {
  const Kind kind = kindOf(head);
  if (kind.version == 3)
    return notRead(
        "This is an Analyze 7.5 file, which does not say left from right; convert it to NIfTI with a tool "
        "that knows where it came from.");
  VERNIER_ASSERT(kind.version != 0);
  const Fields f = kind.version == 1 ? readFirst(head, kind.bigEndian) : readSecond(head, kind.bigEndian);
  NiftiHeader h;
  h.pair = f.pair;
  ParsedVolume& p = h.parsed;
  p.facts.format = kind.version == 1 ? "NIfTI-1" : "NIfTI-2";
  p.facts.info.modality = "OT";
  Result<void> ok = readType(f, p);
  if (ok) ok = readSizes(f, p);
  if (ok) ok = readOffset(f, p);
  if (ok) ok = readGeometry(f, p);
  if (!ok) return ok.error();
  if (p.place.channels == 1) readValues(f, p.facts.info);  // the standard: not of colours
  return h;
}

}  // namespace vernier
