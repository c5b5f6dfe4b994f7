// SPDX-License-Identifier: GPL-3.0-or-later
// Pieces of the page of a quality assurance run.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace vernier::app {

extern const char* const kQaStyle;  // CSS; also for paper

// <img> with the picture inside it; an empty frame that says so without bytes.
std::string imageTag(const std::vector<std::byte>& png, const std::string& caption);
// Bars (inline SVG) of how many pixels differ by how many levels, in doubling classes, heights logarithmic.
std::string histogramSvg(const std::vector<std::uint64_t>& counts);

}  // namespace vernier::app
