// SPDX-License-Identifier: GPL-3.0-or-later
#include "QaHtmlParts.h"

#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "QaEscape.h"

namespace vernier::app {

const char* const kQaStyle = R"css(
:root { --ink: #1b1f24; --soft: #57606a; --line: #d0d7de; --pass: #116329; --passback: #e6f4ea; --fail: #a40e26;
  --failback: #fdecea; }
* { box-sizing: border-box; }
body { font: 14px/1.45 "DejaVu Sans", Verdana, sans-serif; color: var(--ink); background: #fff; margin: 0 auto;
  padding: 24px; max-width: 1280px; }
h1 { font-size: 22px; margin: 0 0 4px; } h2 { font-size: 17px; margin: 28px 0 8px; border-bottom: 2px solid var(--line);
  padding-bottom: 4px; } h3 { font-size: 15px; margin: 0 0 4px; }
.soft { color: var(--soft); } .small { font-size: 12px; }
.verdict { display: inline-block; font-weight: bold; font-size: 18px; padding: 6px 14px; margin: 10px 0;
  border: 2px solid; border-radius: 4px; }
.pass { color: var(--pass); } .fail, .error { color: var(--fail); font-weight: bold; }
.verdict.pass { background: var(--passback); } .verdict.fail { background: var(--failback); }
.scope { border-left: 4px solid #9a6700; background: #fff8e5; padding: 8px 12px; margin: 12px 0; }
table { border-collapse: collapse; width: 100%; margin: 6px 0; }
th, td { text-align: left; vertical-align: top; padding: 3px 8px; border: 1px solid var(--line);
  overflow-wrap: break-word; }
th { background: #f6f8fa; font-weight: bold; } td.n { text-align: right; white-space: nowrap; font-variant-numeric: tabular-nums; }
tr.bad td { background: var(--failback); } .hash { font-family: "DejaVu Sans Mono", monospace; font-size: 11px;
  word-break: break-all; }
.case { border: 1px solid var(--line); border-radius: 4px; padding: 12px 14px; margin: 14px 0; break-inside: avoid; }
.case.notpassed { border: 2px solid var(--fail); }
.pictures { display: flex; flex-wrap: wrap; gap: 12px; margin-top: 8px; }
figure { margin: 0; } figcaption { font-size: 12px; color: var(--soft); margin-top: 2px; max-width: 256px; }
figure img { display: block; image-rendering: pixelated; max-width: 384px; min-width: 160px; border: 1px solid var(--line); }
.gone { width: 160px; height: 120px; border: 1px dashed var(--fail); display: flex; align-items: center;
  justify-content: center; color: var(--fail); font-size: 12px; text-align: center; }
.signed td { height: 64px; width: 33%; color: var(--soft); font-size: 12px; }
ul { margin: 4px 0 4px 20px; padding: 0; }
@media print { body { padding: 0; font-size: 11px; } a { color: inherit; text-decoration: none; } }
)css";

namespace {

std::string base64(const std::vector<std::byte>& bytes) {
  std::string out(4 * ((bytes.size() + 2) / 3) + 1, '\0');
  const int n =
      ::EVP_EncodeBlock(reinterpret_cast<unsigned char*>(out.data()),
                        reinterpret_cast<const unsigned char*>(bytes.data()), static_cast<int>(bytes.size()));
  out.resize(static_cast<std::size_t>(n));
  return out;
}

// Classes of differences: 0, 1, 2, 3..4, 5..8 ... 129..255.
constexpr std::array kLastOfClass = {0, 1, 2, 4, 8, 16, 32, 64, 128, 255};

}  // namespace

std::string imageTag(const std::vector<std::byte>& png, const std::string& caption) {
  std::string out = "<figure>";
  if (png.empty())
    out += "<div class=\"gone\">no picture</div>";
  else
    out += "<img alt=\"" + escaped(caption) + "\" src=\"data:image/png;base64," + base64(png) + "\">";
  return out + "<figcaption>" + escaped(caption) + "</figcaption></figure>\n";
}

std::string histogramSvg(const std::vector<std::uint64_t>& counts) {
  std::array<std::uint64_t, kLastOfClass.size()> n{};
  std::uint64_t all = 0;
  for (std::size_t d = 0; d < counts.size(); ++d) {
    const auto c = std::lower_bound(kLastOfClass.begin(), kLastOfClass.end(), static_cast<int>(d));
    n[static_cast<std::size_t>(std::min<std::ptrdiff_t>(c - kLastOfClass.begin(), n.size() - 1))] +=
        counts[d];
    all += counts[d];
  }
  constexpr int kBar = 26, kHigh = 90, kTop = 14;
  const int width = kBar * static_cast<int>(n.size()) + 4;
  std::string svg = "<svg width=\"" + std::to_string(width) +
                    "\" height=\"128\" role=\"img\" "
                    "aria-label=\"histogram of differences\" font-family=\"DejaVu Sans, sans-serif\" "
                    "font-size=\"9\">";
  char text[320];
  for (std::size_t i = 0; i < n.size(); ++i) {
    const double share =
        all > 0 ? std::log1p(static_cast<double>(n[i])) / std::log1p(static_cast<double>(all)) : 0;
    const double h = kHigh * share;
    const double x = 2 + static_cast<double>(i) * kBar;
    std::snprintf(text, sizeof text, "<rect x=\"%.0f\" y=\"%.1f\" width=\"%d\" height=\"%.1f\" fill=\"%s\"/>",
                  x + 1, kTop + kHigh - h, kBar - 3, h, i == 0 ? "#8c959f" : "#0969da");
    svg += text;
    if (n[i] > 0) {
      std::snprintf(text, sizeof text, "<text x=\"%.0f\" y=\"%.1f\" text-anchor=\"middle\">%llu</text>",
                    x + kBar / 2, kTop + kHigh - h - 3, static_cast<unsigned long long>(n[i]));
      svg += text;
    }
    const int first = i == 0 ? 0 : kLastOfClass[i - 1] + 1;
    const std::string label = first == kLastOfClass[i] ? std::to_string(first) : std::to_string(first) + "+";
    std::snprintf(text, sizeof text, "<text x=\"%.0f\" y=\"%d\" text-anchor=\"middle\">%s</text>",
                  x + kBar / 2, kTop + kHigh + 11, label.c_str());
    svg += text;
  }
  std::snprintf(text, sizeof text, "<line x1=\"0\" x2=\"%d\" y1=\"%d\" y2=\"%d\" stroke=\"#57606a\"/></svg>",
                width, kTop + kHigh, kTop + kHigh);
  return "<figure>" + svg + text +
         "<figcaption>pixels by difference, levels of 255; log scale</figcaption></figure>\n";
}

}  // namespace vernier::app
