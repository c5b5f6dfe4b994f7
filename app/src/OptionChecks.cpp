// SPDX-License-Identifier: GPL-3.0-or-later
#include "OptionChecks.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>

namespace vernier::app {
namespace {

template <class T>
std::optional<T> numberIn(const std::string& text) {
  T x{};
  const char* const end = text.data() + text.size();
  const auto [p, ec] = std::from_chars(text.data(), end, x);
  if (ec != std::errc() || p != end) return std::nullopt;
  return x;
}

std::string shortNumber(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", x);
  return text;
}

}  // namespace

CLI::Validator finiteFrom(double least, double most) {
  return {[least, most](std::string& text) -> std::string {
            const auto x = numberIn<double>(text);
            if (x && std::isfinite(*x) && *x >= least && *x <= most) return {};
            return "'" + text + "' is not a number from " + shortNumber(least) + " to " + shortNumber(most);
          },
          shortNumber(least) + " to " + shortNumber(most), "finiteFrom"};
}

CLI::Validator finiteAboveZero() {
  return {[](std::string& text) -> std::string {
            const auto x = numberIn<double>(text);
            return x && std::isfinite(*x) && *x > 0 ? "" : "'" + text + "' is not a number above 0";
          },
          "above 0", "finiteAboveZero"};
}

CLI::Validator wholeNumber64() {
  return {[](std::string& text) -> std::string {
            return numberIn<std::uint64_t>(text) ? ""
                                                 : "'" + text + "' is not a whole number from 0 to 2^64 - 1";
          },
          "0 to 2^64 - 1", "wholeNumber64"};
}

Result<void> noEmptyValues(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_positional() || option->count() == 0) continue;
    const std::vector<std::string>& values = option->results();
    if (std::any_of(values.begin(), values.end(), [](const std::string& v) { return v.empty(); }))
      return makeError(ErrorCode::OptionInvalid, "The value is empty; give one or leave the option out.",
                       option->get_name());
  }
  return {};
}

Result<void> keepSources(const Session* session, const std::vector<std::string>& inputs,
                         const std::string& output, const char* option) {
  std::error_code ec;
  if (output.empty() || !std::filesystem::exists(output, ec)) return {};
  const auto same = [&](const std::string& p) { return std::filesystem::equivalent(p, output, ec) && !ec; };
  bool hit = std::any_of(inputs.begin(), inputs.end(), same);
  if (session) {
    for (const FileRecord& f : session->study().files) hit = hit || same(f.path);
    for (const VolumeFile& v : session->volumeFiles()) hit = hit || (v.facts && same(v.facts->dataFile.path));
    for (const std::string& file : session->surfaceFiles()) hit = hit || same(file);
  }
  if (hit)
    return makeError(ErrorCode::WouldOverwriteSource,
                     "The output would overwrite a file of the input; name another.", option);
  return {};
}

}  // namespace vernier::app
