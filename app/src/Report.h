// SPDX-License-Identifier: GPL-3.0-or-later
// The report of a rendering as JSON (schema "vernier-report/1"), and the few figures that stand on a picture.
#pragma once
#include <string>
#include <vector>

#include "ViewOptions.h"

namespace vernier::app {

struct Timing {
  double load_ms = 0;  // scan and decode
  double first_frame_ms = 0;
  std::vector<double> frame_ms;  // later frames
};

struct ReportInput {
  Session* session = nullptr;
  const RenderRequest* request = nullptr;
  const Rendered* rendered = nullptr;
  Timing timing;
  std::string imageSha256;  // of the 8-bit picture's pixels, before letters
};

std::string reportJson(const ReportInput&);

double median(std::vector<double>);
double peakRss_mb();

}  // namespace vernier::app
