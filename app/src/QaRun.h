// SPDX-License-Identifier: GPL-3.0-or-later
// Runs cases of quality assurance through the Session. Nothing is written but the phantoms, into a folder
// that is gone afterwards.
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <stop_token>

#include "QaChecks.h"

namespace vernier::app {

enum class QaVerdict {
  Pass,
  Fail,   // out of tolerance, or a weak or missing baseline
  Error,  // nothing could be judged: damaged case, missing data, an engine that does not draw
};
const char* nameOf(QaVerdict);  // "pass", "fail", "error"

struct QaEngineResult {
  std::string engine;
  QaVerdict verdict = QaVerdict::Error;
  std::optional<Error> error;  // of Error, and of Fail where no row says it
  std::vector<QaRow> rows;
  std::string renderer, technique;
  std::optional<Picture> picture, heat;        // as drawn; what differs from expected.png
  std::array<std::uint64_t, 256> histogram{};  // pixels by their largest difference
};

struct QaCaseResult {
  std::string name;
  std::optional<QaCase> qaCase;  // absent: case.json could not be read
  std::vector<QaEngineResult> engines;
  std::optional<Picture> expected;
  std::vector<std::string> caught;  // mutants of expected.png that the tolerance tells
  std::string dataSha256, expectedSha256, caseSha256;
};

// What one phantom or one set of files needs to be opened, kept while the next case asks for the same.
class QaRunner {
 public:
  using NewSession = std::function<std::unique_ptr<Session>()>;
  QaRunner(Settings, NewSession, std::stop_token);
  ~QaRunner();

  // `engines`: "native", "gl", or both; a case that is not meant for one of them says so in its JSON and has
  // no result of it. One that is meant for none of them is an Error: nothing may be skipped unseen.
  QaCaseResult run(const std::string& folder, const std::string& name,
                   const std::vector<std::string>& engines);
  // Draws the case's picture with one engine, without judging it.
  Result<Picture> draw(const QaCase&, const std::string& engine);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// The picture's rows of a case: one for each bound of its tolerance.
std::vector<QaRow> judgePicture(const Picture& expected, const Picture& actual, const QaTolerance&);
// Is `expected` fit to be a baseline under this tolerance? FileDamaged says why not. `caught`: the mutants
// that it tells.
Result<void> guardBaseline(const QaCase&, const Picture& expected, const QaTolerance&,
                           std::vector<std::string>* caught = nullptr);
// Of names and bytes of all files below `path`, in order of their names; of one file: of its bytes.
Result<std::string> sha256OfPath(const std::string& path);

}  // namespace vernier::app
