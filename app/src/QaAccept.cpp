// SPDX-License-Identifier: GPL-3.0-or-later
#include "QaAccept.h"

#include <filesystem>

#include "OptionText.h"
#include "QaDocument.h"
#include "Sha256.h"
#include "Version.h"
#include "vernier/picture/Png.h"
#include "vernier/picture/WriteFile.h"

namespace vernier::app {
namespace {
namespace fs = std::filesystem;

// The list of acceptances so far; damaged: refused, since writing it anew would lose it.
Result<QaJson> historyOf(const std::string& file, const std::string& name) {
  std::error_code ec;
  if (!fs::exists(file, ec)) return QaJson{{"schema", "vernier-qa-history/1"}, {"accepted", QaJson::array()}};
  const Result<std::string> text = textOf(file, "The history");
  if (!text) return text.error();
  QaJson j = QaJson::parse(*text, nullptr, false);
  if (j.is_discarded() || !j.is_object() || !j.contains("accepted") || !j["accepted"].is_array())
    return makeError(ErrorCode::FileDamaged,
                     "The list of earlier acceptances is damaged; mend or move it away.",
                     name + "/history/accepted.json");
  return j;
}

std::string shaOf(std::span<const std::byte> bytes) {
  Sha256 hash;
  hash.add(bytes.data(), bytes.size());
  return hash.hex();
}

// A name in history/ that is not taken.
std::string freeName(const std::string& folder) {
  std::error_code ec;
  for (int n = 1;; ++n)
    if (const std::string name = "history/expected-" + std::to_string(n) + ".png";
        !fs::exists(folder + "/" + name, ec))
      return name;
}

}  // namespace

Result<QaAccepted> acceptQaCase(QaRunner& runner, const std::string& suite, const std::string& name,
                                const std::string& reason) {
  if (reason.find_first_not_of(" \t\r\n") == std::string::npos)
    return makeError(ErrorCode::OptionInvalid,
                     "Say why the new picture is right, in a text that others will read.", "--reason");
  const std::string folder = suite + "/" + name;
  std::error_code ec;
  if (!fs::exists(folder + "/case.json", ec))
    return makeError(ErrorCode::OptionInvalid,
                     "The suite has no case of this name; `vernier qa run` lists them.", name);
  const Result<QaCase> c = readQaCase(folder, name);
  if (!c) return c.error();
  if (!c->tolerance)
    return makeError(
        ErrorCode::OptionInvalid,
        "The case judges no picture; the values that it expects are known in advance and stand in "
        "its case.json.",
        name);
  const Result<Picture> picture = runner.draw(*c, "native");
  if (!picture) return picture.error();
  if (const Result<void> fit = guardBaseline(*c, *picture, *c->tolerance); !fit) return fit.error();
  const Result<std::vector<std::byte>> png = encodePng(*picture);
  if (!png) return png.error();
  QaAccepted accepted;
  accepted.sha256 = shaOf(*png);
  std::vector<std::byte> old;
  if (fs::exists(c->expectedFile(), ec)) {
    const Result<std::string> bytes = textOf(c->expectedFile(), "The old baseline");
    if (!bytes) return bytes.error();
    const auto view = std::as_bytes(std::span(*bytes));
    old.assign(view.begin(), view.end());
    if (const Result<Picture> before = decodePng(old); before && *before == *picture) return accepted;
  }
  Result<QaJson> history = historyOf(folder + "/history/accepted.json", name);
  if (!history) return history.error();
  fs::create_directories(folder + "/history", ec);
  if (ec)
    return makeError(ErrorCode::WriteFailed, "The case's history cannot be kept: " + ec.message() + ".",
                     name + "/history");
  if (!old.empty()) {
    accepted.kept = freeName(folder);
    if (const Result<void> r = writeFileWhole(folder + "/" + accepted.kept, old); !r) return r.error();
  }
  (*history)["accepted"].push_back({{"utc", utcNow()},
                                    {"reason", reason},
                                    {"vernier", kVersion},
                                    {"engine", "native"},
                                    {"sha256", accepted.sha256},
                                    {"replaced", accepted.kept.empty() ? QaJson() : QaJson(accepted.kept)},
                                    {"replaced_sha256", old.empty() ? QaJson() : QaJson(shaOf(old))}});
  const std::string list = history->dump(2, ' ', false, QaJson::error_handler_t::replace) + "\n";
  if (const Result<void> r = writeFileWhole(folder + "/history/accepted.json", list); !r) return r.error();
  if (const Result<void> r = writeFileWhole(c->expectedFile(), *png); !r) return r.error();
  accepted.changed = true;
  return accepted;
}

}  // namespace vernier::app
