// SPDX-License-Identifier: GPL-3.0-or-later
// Writes a file whole or not at all: into a new file of the same folder, which then takes the name.
// WriteFailed with the system's reason; nothing is left behind. A link is followed; what is no regular file
// is never replaced.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "vernier/base/Result.h"

namespace vernier {

VERNIER_API Result<void> writeFileWhole(const std::string& path, std::span<const std::byte> bytes);
inline Result<void> writeFileWhole(const std::string& path, std::string_view text) {
  return writeFileWhole(path, std::as_bytes(std::span(text.data(), text.size())));
}

}  // namespace vernier
