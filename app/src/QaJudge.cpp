// SPDX-License-Identifier: GPL-3.0-or-later
// Judging pictures: bounds, and whether a baseline is worth anything.
#include <cmath>
#include <cstdio>
#include <functional>

#include "QaRun.h"
#include "vernier/measure/ImageMetrics.h"
#include "vernier/picture/Compare.h"

namespace vernier::app {
namespace {

measure::ImageView viewOf(const Picture& p) {
  return {p.width, p.height, p.channels, measure::SampleType::U8, std::as_bytes(std::span(p.pixels))};
}

QaRow atMost(const char* quantity, const char* unit, double measured, double most, const std::string& why) {
  QaRow row;
  row.quantity = quantity, row.unit = unit, row.why = why;
  row.measured = measured, row.expected = 0, row.tolerance = most;
  row.pass = measured <= most;
  return row;
}

QaRow refused(const Error& e) {
  QaRow row;
  row.quantity = "picture", row.measured = e.sentence, row.expected = "comparable";
  return row;
}

// Samples of less than this SD are as good as blank.
constexpr double kLeastSd = 2;

Error weak(const QaCase& c, const std::string& sentence) {
  return makeError(ErrorCode::FileDamaged, sentence, c.name + "/expected.png");
}

}  // namespace

std::vector<QaRow> judgePicture(const Picture& expected, const Picture& actual, const QaTolerance& t) {
  const Result<Difference> d = comparePictures(expected, actual);
  if (!d) return {refused(d.error())};
  std::vector<QaRow> rows;
  constexpr const char* kLevel = "level/255";
  if (t.max) rows.push_back(atMost("largest difference", kLevel, d->max, *t.max, t.why));
  if (t.mean) rows.push_back(atMost("mean difference", kLevel, d->mean, *t.mean, t.why));
  if (t.rmse) rows.push_back(atMost("RMS difference", kLevel, d->rmse, *t.rmse, t.why));
  if (t.above) {
    const auto histogram = differenceHistogram(expected, actual);
    if (!histogram) return {refused(histogram.error())};
    std::uint64_t n = 0, all = 0;
    for (std::size_t i = 0; i < histogram->size(); ++i) {
      all += (*histogram)[i];
      if (static_cast<double>(i) > t.above->level) n += (*histogram)[i];
    }
    char name[64];
    std::snprintf(name, sizeof name, "share of pixels above %g", t.above->level);
    rows.push_back(
        atMost(name, "share", static_cast<double>(n) / static_cast<double>(all), t.above->share, t.why));
  }
  if (t.ssim) {
    const Result<measure::ImageMetrics> m = measure::compareImages(viewOf(expected), viewOf(actual));
    if (!m) return {refused(m.error())};
    QaRow row;
    row.quantity = "SSIM", row.unit = "1", row.why = t.why;
    row.expected = 1, row.tolerance = "at least " + nlohmann::ordered_json(*t.ssim).dump();
    row.measured = m->ssim ? nlohmann::ordered_json(*m->ssim) : nlohmann::ordered_json("picture too small");
    row.pass = m->ssim && *m->ssim >= *t.ssim;
    rows.push_back(row);
  }
  return rows;
}

Result<void> guardBaseline(const QaCase& c, const Picture& expected, const QaTolerance& t,
                           std::vector<std::string>* caught) {
  const PictureFacts facts = factsOf(expected);
  if (facts.colours < c.leastLevels)
    return weak(c, "The baseline has only " + std::to_string(facts.colours) +
                       " different colours, fewer than " + std::to_string(c.leastLevels) +
                       "; show more, or lower guard/least_levels if that is what the case is about.");
  if (facts.sd < kLeastSd || facts.covered < 0.005)
    return weak(c, "The baseline is all but blank, so comparing with it proves nothing; show more.");
  for (const Mutant m : kMutants) {
    bool told = false;
    for (const QaRow& row : judgePicture(expected, mutantOf(expected, m), t)) told = told || !row.pass;
    if (told && caught) caught->push_back(nameOf(m));
    if (!told && !c.exempt.contains(m))
      return weak(c, std::string("The tolerance would let pass a picture that is ") + saying(m) +
                         "; tighten it, or say under guard/exempt/" + nameOf(m) +
                         " why this cannot be told here.");
    // An exemption that is not needed would hide a weak tolerance later.
    if (told && c.exempt.contains(m))
      return weak(c, std::string("guard/exempt/") + nameOf(m) +
                         " is not needed: the tolerance tells such a picture; remove it.");
  }
  return {};
}

}  // namespace vernier::app
