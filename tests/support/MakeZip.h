// SPDX-License-Identifier: GPL-3.0-or-later
// ZIP archives for tests, byte by byte, so that they can say what no honest program would. Link ZLIB::ZLIB.
#pragma once
#include <zlib.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

namespace vernier::test {

struct ZipEntry {
  std::string name, bytes;
  bool deflate = true;
  std::uint32_t unixMode = 0100644;
  bool encrypted = false;
  std::optional<std::uint32_t> saysBytes{}, saysCrc{};  // instead of the truth
  std::optional<std::size_t> sharesDataOf{};            // an earlier entry whose data this one points at
};

inline std::string rawDeflate(const std::string& bytes) {
  z_stream z{};
  deflateInit2(&z, 9, Z_DEFLATED, -15, 9, Z_DEFAULT_STRATEGY);
  std::string out(deflateBound(&z, bytes.size()), '\0');
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  z.avail_in = static_cast<uInt>(bytes.size());
  z.next_out = reinterpret_cast<Bytef*>(out.data());
  z.avail_out = static_cast<uInt>(out.size());
  deflate(&z, Z_FINISH);
  out.resize(z.total_out);
  deflateEnd(&z);
  return out;
}

inline std::string zipBytes(const std::vector<ZipEntry>& entries) {
  std::string out, directory;
  const auto put = [](std::string& s, std::uint64_t x, int bytes) {
    for (int i = 0; i < bytes; ++i) s += static_cast<char>(x >> 8 * i);
  };
  std::vector<std::size_t> places;
  for (const ZipEntry& e : entries) {
    const std::string& bytes = e.sharesDataOf ? entries[*e.sharesDataOf].bytes : e.bytes;
    const std::string packed = e.deflate ? rawDeflate(bytes) : bytes;
    // What local header and directory both hold, from "version needed" to "extra length".
    std::string common;
    put(common, 20, 2);
    put(common, e.encrypted ? 0x801 : 0x800, 2);
    put(common, e.deflate ? 8 : 0, 2);
    put(common, 0x5a210000, 4);
    put(common,
        e.saysCrc.value_or(static_cast<std::uint32_t>(
            crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())))),
        4);
    put(common, packed.size(), 4);
    put(common, e.saysBytes.value_or(static_cast<std::uint32_t>(bytes.size())), 4);
    put(common, e.name.size(), 2);
    put(common, 0, 2);
    places.push_back(e.sharesDataOf ? places[*e.sharesDataOf] : out.size());
    if (!e.sharesDataOf) {
      out += "PK\3\4" + common + e.name + packed;
    }
    directory += "PK\1\2";
    put(directory, 3 << 8 | 20, 2);
    directory += common;
    put(directory, 0, 6);  // comment, disk, internal attributes
    put(directory, std::uint64_t{e.unixMode} << 16, 4);
    put(directory, places.back(), 4);
    directory += e.name;
  }
  const std::size_t start = out.size();
  out += directory;
  out += "PK\5\6";
  put(out, 0, 4);
  put(out, entries.size(), 2);
  put(out, entries.size(), 2);
  put(out, directory.size(), 4);
  put(out, start, 4);
  put(out, 0, 2);
  return out;
}

inline void writeZip(const std::filesystem::path& path, const std::vector<ZipEntry>& entries) {
  std::ofstream(path, std::ios::binary) << zipBytes(entries);
}

}  // namespace vernier::test
