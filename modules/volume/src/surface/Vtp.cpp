// SPDX-License-Identifier: GPL-3.0-or-later
// VTK XML PolyData by VTK's own reader, for its compressions and encodings. What the file declares is held
// against its size before VTK sees it.
#include <algorithm>

#include "Readers.h"
#include "TextTokens.h"
#include "VtkPolyData.h"

namespace vernier::surface {
namespace {

// zlib, LZ4 and LZMA may shrink a constant array by this much and no more.
constexpr std::uint64_t kMaxRatio = 1100;

// Every attribute NumberOf...="n" must be a number that the file's size can justify.
Result<void> checkCounts(std::string_view bytes) {
  constexpr std::string_view key = "NumberOf";
  for (std::size_t at = bytes.find(key); at != std::string_view::npos; at = bytes.find(key, at + 1)) {
    const std::size_t equals = bytes.find_first_of("=<>", at);
    if (equals == std::string_view::npos || bytes[equals] != '=') continue;
    const std::size_t quote = bytes.find_first_of("\"'", equals);
    if (quote == std::string_view::npos || quote > equals + 8) continue;
    const std::size_t end = bytes.find(bytes[quote], quote + 1);
    if (end == std::string_view::npos || end > quote + 40) continue;
    const auto n = asInteger(bytes.substr(quote + 1, end - quote - 1));
    if (n && *n >= 0 && static_cast<std::uint64_t>(*n) <= kMaxRatio * bytes.size()) continue;
    return makeError(ErrorCode::FileDamaged,
                     "The file declares " + shown(bytes.substr(at, end + 1 - at)) +
                         ", more than its bytes can hold; it is cut short or damaged.");
  }
  return {};
}

// A strip's triangles turn left and right by turns.
Result<void> addStrip(std::span<const std::uint32_t> strip, Polygons& out) {
  for (std::size_t i = 2; i < strip.size(); ++i) {
    const bool odd = i % 2 == 1;
    const std::uint32_t t[3] = {strip[i - 2], strip[odd ? i : i - 1], strip[odd ? i - 1 : i]};
    if (Result<void> ok = out.polygon(t); !ok) return ok;
  }
  return {};
}

}  // namespace

Result<void> readVtp(std::string_view bytes, Polygons& out, SurfaceFile& file) {
  file.format = "VTP";
  const std::string_view head = bytes.substr(0, 4096);
  if (head.find("<VTKFile") == std::string_view::npos || head.find("PolyData") == std::string_view::npos)
    return makeError(ErrorCode::FormatUnknown, "This is no VTK XML file of type PolyData.");
  if (Result<void> ok = checkCounts(bytes); !ok) return ok;
  const Result<VtkPolyData> read = readVtpBytes(bytes);
  if (!read) return read.error();
  const VtkPolyData& data = *read;
  if (!data.error.empty())
    return makeError(ErrorCode::FileDamaged, "VTK cannot read the file; it is cut short or damaged.");
  for (std::size_t i = 0; i + 2 < data.xyz.size(); i += 3)
    out.point({data.xyz[i], data.xyz[i + 1], data.xyz[i + 2]});
  const std::span<const std::uint32_t> corners(data.corners);
  std::uint64_t begin = 0;
  for (const std::uint64_t end : data.polygonEnds) {
    if (Result<void> ok = out.polygon(corners.subspan(begin, end - begin)); !ok) return ok;
    begin = end;
  }
  for (const std::uint64_t end : data.stripEnds) {
    if (Result<void> ok = addStrip(corners.subspan(begin, end - begin), out); !ok) return ok;
    begin = end;
  }
  return {};
}

}  // namespace vernier::surface
