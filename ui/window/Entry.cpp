// SPDX-License-Identifier: GPL-3.0-or-later
// What `vernier view` and `vernier doctor` find in the library of the window.
#include <algorithm>
#include <cstring>

#include "Host.h"
#include "UiEntry.h"
#include "vernier/AbiId.h"
#include "vernier/base/Guarded.h"
#include "vernier/picture/Png.h"

namespace vernier::ui {
namespace {

void fill(app::UiAnswer& answer, const Error& e) {
  answer.code = static_cast<int>(e.code);
  const std::size_t n = std::min(e.sentence.size(), sizeof answer.sentence - 1);
  std::memcpy(answer.sentence, e.sentence.data(), n);
  answer.sentence[n] = 0;
}

HostOptions hostOptions(const app::UiStart& start) {
  HostOptions o;
  o.session = *start.session;
  if (start.width > 0) o.width = start.width;
  if (start.height > 0) o.height = start.height;
  o.scale = start.scale;
  o.notice = start.notice;
  if (start.noticeAccepted) o.noticeAccepted = *start.noticeAccepted;
  return o;
}

Result<void> show(const app::UiStart& start) {
  HostOptions options = hostOptions(start);
  options.visible = start.screenshot.empty();
  Result<std::unique_ptr<Host>> host = Host::make(options);
  if (!host) return host.error();
  (*host)->desk().open(start.paths);
  if (start.screenshot.empty()) {
    (*host)->run();
    return {};
  }
  (*host)->settle(60);
  return writePng(start.screenshot, (*host)->screenshot());
}

}  // namespace
}  // namespace vernier::ui

extern "C" {
__attribute__((visibility("default"))) const char* vernierUiAbi() { return VERNIER_ABI_ID; }

__attribute__((visibility("default"))) void vernierUiRun(const vernier::app::UiStart* start,
                                                         vernier::app::UiAnswer* answer) {
  if (const auto r = vernier::guarded("window", [&] { return vernier::ui::show(*start); }); !r)
    vernier::ui::fill(*answer, r.error());
}
}
