// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/Vti.h"

#include <expat.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <memory>

#include "files/Affine.h"
#include "files/Channels.h"
#include "files/TextParts.h"
#include "vernier/base/Checked.h"

namespace vernier {
namespace {

constexpr std::size_t kPiece = 64 << 10;
constexpr XML_Index kLongestTag = 1 << 20;
constexpr int kDeepest = 64;

Error damaged(const std::string& sentence) {
  return makeError(ErrorCode::FileDamaged, "The VTK image file cannot be used: " + sentence);
}
Error notRead(const std::string& sentence) { return makeError(ErrorCode::NotBuiltYet, sentence); }

using Attributes = std::map<std::string, std::string>;

// What of the XML matters, in the order in which it comes.
struct Document {
  bool isVti = false, hasAppended = false;
  Attributes file, image, piece, point, cell, array, appended;
  bool arrayIsCell = false;
  bool hasArray = false;
  XML_Index inlineAt = 0, appendedAt = 0;  // behind the start tags
  std::string trouble;
};

// Walks the XML up to the data: an inline array ends the walk at its start tag, an appended one at
// AppendedData, behind which no XML may follow.
class Walk {
 public:
  Walk() : parser_(XML_ParserCreate(nullptr), &XML_ParserFree) {
    XML_SetUserData(parser_.get(), this);
    XML_SetElementHandler(parser_.get(), &Walk::begin, &Walk::end);
    XML_SetStartDoctypeDeclHandler(
        parser_.get(), [](void* self, const XML_Char*, const XML_Char*, const XML_Char*, int) {
          static_cast<Walk*>(self)->stop("it declares a document type, which no VTK file does.");
        });
  }

  Result<Document> run(const InputFilePtr& input) {
    const auto stream = rawStream(input, 0);
    std::vector<std::byte> piece(kPiece);
    for (XML_Index fed = 0; !stopped_;) {
      const auto n = stream->read(piece);
      if (!n) return n.error();
      const auto state = XML_Parse(parser_.get(), reinterpret_cast<const char*>(piece.data()),
                                   static_cast<int>(*n), *n == 0);
      if (stopped_) break;
      if (state != XML_STATUS_OK) return damaged("its XML is not well formed.");
      fed += static_cast<XML_Index>(*n);
      if (fed - XML_GetCurrentByteIndex(parser_.get()) > kLongestTag)
        return damaged("a tag of its XML is too long.");
      if (*n == 0) break;
    }
    if (!d_.trouble.empty()) return damaged(d_.trouble);
    return std::move(d_);
  }

 private:
  static void begin(void* self, const XML_Char* name, const XML_Char** attributes) {
    static_cast<Walk*>(self)->element(name, attributes);
  }
  static void end(void* self, const XML_Char* name) { static_cast<Walk*>(self)->close(name); }

  void stop(const char* trouble) {
    if (trouble) d_.trouble = trouble;
    stopped_ = true;
    XML_StopParser(parser_.get(), XML_FALSE);
  }

  void element(const std::string& name, const XML_Char** attributes) {
    if (++depth_ > kDeepest) return stop("its XML is nested too deep.");
    Attributes a;
    for (; attributes[0]; attributes += 2) a[attributes[0]] = attributes[1];
    if (name == "VTKFile") d_.file = std::move(a), d_.isVti = d_.file["type"] == "ImageData";
    if (name == "VTKFile" && !d_.isVti) return stop(nullptr);
    if (name == "ImageData") d_.image = std::move(a);
    if (name == "Piece" && d_.piece.empty()) d_.piece = std::move(a);
    if (name == "PointData") d_.point = a, inPoint_ = true;
    if (name == "CellData") d_.cell = a, inCell_ = true;
    if (name == "DataArray" && (inPoint_ || inCell_)) offer(a);
    if (name == "AppendedData") {
      d_.appended = std::move(a);
      d_.appendedAt = behindTag();
      d_.hasAppended = true;
      stop(nullptr);
    }
  }
  void close(const std::string& name) {
    --depth_;
    if (name == "PointData") inPoint_ = false;
    if (name == "CellData") inCell_ = false;
    if (name == "ImageData" && d_.hasArray && d_.array["format"] != "appended") stop(nullptr);
  }
  XML_Index behindTag() const {
    return XML_GetCurrentByteIndex(parser_.get()) + XML_GetCurrentByteCount(parser_.get());
  }
  // The named scalars rule, else the first array; point data before cell data.
  void offer(const Attributes& a) {
    const Attributes& of = inPoint_ ? d_.point : d_.cell;
    const auto scalars = of.find("Scalars");
    const auto name = a.find("Name");
    const bool named = scalars != of.end() && name != a.end() && scalars->second == name->second;
    const bool better = !d_.hasArray || (d_.arrayIsCell && inPoint_) || (named && d_.arrayIsCell == inCell_);
    if (!better) return;
    d_.array = a;
    d_.arrayIsCell = inCell_;
    d_.hasArray = true;
    d_.inlineAt = behindTag();
  }

  std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser_;
  Document d_;
  bool stopped_ = false, inPoint_ = false, inCell_ = false;
  int depth_ = 0;
};

class Image {
 public:
  Image(const FileRecord& file, InputFilePtr input, Document d) : input_(std::move(input)), d_(std::move(d)) {
    p_.place.file = file;
  }

  Result<ParsedVolume> parse() {
    p_.facts.format = "VTK image";
    p_.facts.info.modality = "OT";
    Result<void> ok = readExtent();
    if (ok) ok = readGeometry();
    if (ok) ok = readType();
    if (ok) ok = readPlace();
    if (!ok) return ok.error();
    return std::move(p_);
  }

 private:
  template <class T, std::size_t N>
  static std::optional<std::array<T, N>> numbers(const Attributes& a, const char* name) {
    const auto it = a.find(name);
    const auto list = it == a.end() ? std::nullopt : numbersIn<T>(it->second);
    if (!list || list->size() != N) return std::nullopt;
    std::array<T, N> out{};
    std::copy(list->begin(), list->end(), out.begin());
    return out;
  }

  Result<void> readExtent() {
    const auto whole = numbers<std::int64_t, 6>(d_.image, "WholeExtent");
    if (!whole) return damaged("WholeExtent is not six numbers.");
    const auto piece = numbers<std::int64_t, 6>(d_.piece, "Extent");
    if (!piece) return damaged("there is no Piece with an Extent of six numbers.");
    if (*piece != *whole) return notRead("The VTK image is divided into pieces; save it as one piece.");
    extent_ = *whole;
    constexpr std::int64_t kFar = std::int64_t{1} << 40;
    for (std::size_t a = 0; a < 3; ++a)
      if (extent_[2 * a] < -kFar || extent_[2 * a + 1] > kFar || extent_[2 * a + 1] < extent_[2 * a])
        return damaged("WholeExtent holds no voxels.");
    return {};
  }

  // Point data stand at the lattice points, cell data in the middle between them.
  Result<void> readGeometry() {
    const auto origin =
        d_.image.contains("Origin") ? numbers<double, 3>(d_.image, "Origin") : std::array<double, 3>{};
    const auto spacing = d_.image.contains("Spacing") ? numbers<double, 3>(d_.image, "Spacing")
                                                      : std::array<double, 3>{1, 1, 1};
    const auto direction = d_.image.contains("Direction") ? numbers<double, 9>(d_.image, "Direction")
                                                          : std::array<double, 9>{1, 0, 0, 0, 1, 0, 0, 0, 1};
    if (!origin || !spacing || !direction)
      return damaged("Origin, Spacing or Direction is not what it should be.");
    GridGeometry& g = p_.facts.info.grid;
    glm::dvec3 first(0);
    std::array<std::int64_t, 3> size{};
    for (std::size_t a = 0; a < 3; ++a) {
      const std::int64_t steps = extent_[2 * a + 1] - extent_[2 * a];
      const bool between = d_.arrayIsCell && steps > 0;
      size[a] = d_.arrayIsCell ? std::max<std::int64_t>(steps, 1) : steps + 1;
      const auto axis = static_cast<glm::length_t>(a);
      first[axis] = static_cast<double>(extent_[2 * a]) + (between ? 0.5 : 0.0);
      // The matrix is written row by row; its columns are the directions of the axes.
      g.patientFromVoxel.linear[axis] =
          (*spacing)[a] * glm::dvec3((*direction)[a], (*direction)[3 + a], (*direction)[6 + a]);
    }
    g.columns = size[0], g.rows = size[1], g.slices = size[2];
    g.patientFromVoxel.translation =
        glm::dvec3((*origin)[0], (*origin)[1], (*origin)[2]) + g.patientFromVoxel.linear * first;
    p_.facts.info.findings.push_back(
        axesUnknown("A VTK image file does not say whether its axes are those of a patient."));
    return settleAxes(g);
  }

  Result<void> readType() {
    if (!d_.hasArray) return damaged("it has no data array.");
    static const std::map<std::string_view, FileType> kTypes{
        {"Int8", FileType::I8},    {"UInt8", FileType::U8},   {"Int16", FileType::I16},
        {"UInt16", FileType::U16}, {"Int32", FileType::I32},  {"UInt32", FileType::U32},
        {"Int64", FileType::I64},  {"UInt64", FileType::U64}, {"Float32", FileType::F32},
        {"Float64", FileType::F64}};
    const auto it = kTypes.find(d_.array["type"]);
    if (it == kTypes.end())
      return notRead("This type of VTK data array is not read; convert it to integers or floats.");
    const auto components = numberIn<std::int64_t>(
        d_.array.contains("NumberOfComponents") ? d_.array["NumberOfComponents"] : "1");
    if (!components || *components < 1) return damaged("NumberOfComponents is no number above 0.");
    p_.place.type = it->second;
    p_.facts.storedType = nameOf(it->second);
    p_.facts.info.type = voxelTypeOf(it->second);
    return setChannels(p_, *components);
  }

  Result<void> readPlace() {
    const GridGeometry& g = p_.facts.info.grid;
    const auto bytes =
        checkedProduct({static_cast<std::uint64_t>(g.columns), static_cast<std::uint64_t>(g.rows),
                        static_cast<std::uint64_t>(g.slices), bytesPerVoxel(p_.place)});
    if (!bytes) return makeError(ErrorCode::LimitExceeded, "The extent asks for more than 2^64 bytes.");
    VtkArray array;
    array.bytes = *bytes;
    const std::string order = d_.file["byte_order"];
    if (order != "LittleEndian" && order != "BigEndian") return damaged("byte_order is missing.");
    array.bigEndian = p_.place.bigEndian = order == "BigEndian";
    if (auto r = readCoding(array); !r) return r;
    if (p_.place.packing == Packing::Text) return {};
    p_.place.packing = Packing::Other;
    p_.place.offset = array.offset;
    p_.place.open = [array](const InputFilePtr& file) { return vtkStream(file, array); };
    const std::uint64_t left =
        std::min(input_->size() - std::min(array.offset, input_->size()), std::uint64_t{1} << 46);
    p_.place.mostBytes = array.compressed ? left * 1032 : left;
    return {};
  }

  Result<void> readCoding(VtkArray& array) {
    const std::string format = d_.array["format"], compressor = d_.file["compressor"],
                      words = d_.file["header_type"];
    if (format == "ascii") {
      p_.place.packing = Packing::Text;
      p_.place.offset = static_cast<std::uint64_t>(d_.inlineAt);
      p_.place.bigEndian = false;
      return {};
    }
    if (!compressor.empty() && compressor != "vtkZLibDataCompressor")
      return notRead("This VTK compressor is not read; save the file with the zlib compressor or none.");
    if (!words.empty() && words != "UInt32" && words != "UInt64") return damaged("header_type is not known.");
    array.compressed = !compressor.empty();
    array.wordBytes = words == "UInt64" ? 8 : 4;
    if (format == "binary") {
      array.base64 = true;
      array.offset = static_cast<std::uint64_t>(d_.inlineAt);
      return {};
    }
    if (format != "appended") return damaged("the data array has no format that is known.");
    if (!d_.hasAppended) return damaged("the appended data are missing.");
    array.base64 = d_.appended["encoding"] == "base64";
    if (!array.base64 && d_.appended["encoding"] != "raw")
      return damaged("the encoding of the appended data is not known.");
    const auto offset = numberIn<std::uint64_t>(d_.array["offset"]);
    const auto start = underscore();
    const auto at = offset && start ? checkedAdd(*offset, *start) : std::nullopt;
    if (!at || *at > input_->size()) return damaged("the appended data do not begin where the array says.");
    array.offset = *at;
    return {};
  }

  // The data begin behind the underscore that follows the start tag.
  std::optional<std::uint64_t> underscore() const {
    for (std::uint64_t at = static_cast<std::uint64_t>(d_.appendedAt), n = 0; n < 4096; ++at, ++n) {
      char c = 0;
      if (!input_->read(at, std::as_writable_bytes(std::span(&c, 1)))) return std::nullopt;
      if (c == '_') return at + 1;
      if (c != ' ' && (c < '\t' || c > '\r')) return std::nullopt;
    }
    return std::nullopt;
  }

  InputFilePtr input_;
  Document d_;
  ParsedVolume p_;
  std::array<std::int64_t, 6> extent_{};
};

}  // namespace

bool looksLikeVti(std::string_view text) {
  const std::string_view head = text.substr(0, 4096);
  const std::size_t first = head.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  return first != std::string_view::npos && head[first] == '<' &&
         head.find("<VTKFile") != std::string_view::npos;
}

Result<ParsedVolume> parseVti(const FileRecord& file, const InputFilePtr& input) {
  auto d = Walk().run(input);
  if (!d) return d.error();
  if (!d->isVti) return notRead("This VTK file holds no image; of VTK's XML files ImageData is read.");
  return Image(file, input, std::move(*d)).parse();
}

}  // namespace vernier
