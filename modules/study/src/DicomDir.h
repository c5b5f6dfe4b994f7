// SPDX-License-Identifier: GPL-3.0-or-later
// A DICOMDIR (PS3.3 F) as an index of files: used only when it is opened by itself.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "Header.h"

namespace vernier {

struct DicomDirIndex {
  std::map<std::string, std::size_t> records;  // by Directory Record Type
  std::size_t referenced = 0, present = 0;     // files it names; those that are there
  std::size_t outside = 0;                     // those that would lie outside its folder
  std::vector<std::string> files;              // paths of the latter
};
// A file name never leaves `folder` ("" = the current one): components with a slash or ".." are not resolved,
// nor are links outward. Without `resolve` files are counted only.
DicomDirIndex readDicomDir(const Header& header, const std::string& folder, bool resolve);

}  // namespace vernier
