// SPDX-License-Identifier: GPL-3.0-or-later
#include "FrameWindows.h"

#include <set>
#include <string>
#include <utility>

namespace vernier {
namespace {

constexpr Tag kShared = 0x52009229, kPerFrame = 0x52009230, kFrameVoi = 0x00289132;
constexpr Tag kCenter = 0x00281050, kWidth = 0x00281051;
using WindowText = std::pair<std::string, std::string>;

// Center and width of one frame's functional groups as text; both empty when there are none.
WindowText windowIn(const Header& h, const std::vector<Element>& groups) {
  const Element* voi = findIn(groups, kFrameVoi);
  if (!voi) return {};
  const auto items = itemsOf(h, *voi);
  if (items.empty()) return {};
  const auto text = [&](Tag t) {
    const Element* e = findIn(items[0], t);
    return e ? std::string(rawText(h, *e)) : std::string();
  };
  return {text(kCenter), text(kWidth)};
}

}  // namespace

std::size_t differentFrameWindows(const Header& h) {
  WindowText shared;
  if (const Element* e = h.find(kShared))
    if (const auto items = itemsOf(h, *e); !items.empty()) shared = windowIn(h, items[0]);
  const WindowText none;
  std::set<WindowText> seen;
  if (const Element* e = h.find(kPerFrame))
    for (const auto& groups : itemsOf(h, *e)) {
      const WindowText own = windowIn(h, groups);
      const WindowText& window = own == none ? shared : own;
      if (window != none) seen.insert(window);
    }
  if (seen.empty() && shared != none) seen.insert(shared);
  return seen.size();
}

}  // namespace vernier
