// SPDX-License-Identifier: GPL-3.0-or-later
// How the values of options are written, for whoever reads them.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "ViewOptions.h"

namespace vernier::app {

Error invalid(const std::string& option, const std::string& sentence);  // OptionInvalid
std::vector<std::string> split(const std::string& text, char by);
std::optional<double> number(const std::string& text);  // finite, and nothing else in the text
Result<glm::dvec3> vec3(const std::string& option, const std::string& key,
                        const std::vector<std::string>& parts);
// The text of a small file that an option names.
Result<std::string> textOf(const std::string& path, const char* what);

}  // namespace vernier::app
