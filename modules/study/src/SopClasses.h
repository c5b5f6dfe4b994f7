// SPDX-License-Identifier: GPL-3.0-or-later
// SOP Classes by UID: PS3.6 Table A-1, storage classes.
#pragma once
#include <string>
#include <string_view>

namespace vernier {

enum class ObjectKind {
  Image,          // one or more frames, drawn as slices
  EnhancedImage,  // geometry and values per frame in functional groups
  Segmentation,
  Dose,
  Document,  // listed, never drawn as pixels
  Directory,
  Unknown
};
struct SopClass {
  std::string_view uid, name;
  ObjectKind kind;
  std::string_view what;  // of a Document: "structured report"
};
const SopClass* findSopClass(std::string_view uid);
bool isImageClass(const SopClass*);

}  // namespace vernier
