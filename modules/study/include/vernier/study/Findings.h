// SPDX-License-Identifier: GPL-3.0-or-later
// A finding: something about the data that a reader should know, with its numbers. Never an error: the rest
// goes on.
#pragma once
#include <map>
#include <string>
#include <variant>
#include <vector>

namespace vernier {

// Info stays in the browser; Notice changes a number; Warning changes what is seen and speaks in the
// viewport; Refusal: 3-D (or the pixels) are refused and the sentence says why.
enum class Severity { Info, Notice, Warning, Refusal };

using FindingValue = std::variant<double, std::string, std::vector<double>, std::vector<std::string>>;

struct Finding {
  std::string
      code;  // kebab-case, as in the docs: "tilt", "gap", "uneven-spacing", "repeated-sop-instance-uid"...
  Severity severity = Severity::Info;
  std::string sentence;                         // for people; no patient value
  std::map<std::string, FindingValue> numbers;  // "shear_deg", "step_mm", "files" (as given by the user)...
};

}  // namespace vernier
