// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/picture/Mutants.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <vector>

namespace vernier {
namespace {

struct Names {
  const char* name;
  const char* saying;
};
constexpr std::array<Names, kMutants.size()> kNames = {{{"shifted-right", "shifted right by a pixel"},
                                                        {"shifted-down", "shifted down by a pixel"},
                                                        {"mirrored", "with left and right swapped"},
                                                        {"gamma", "with a gamma of 1.1"},
                                                        {"blank", "blank"},
                                                        {"object-missing", "with an object missing"}}};

std::uint32_t key(const Picture& p, std::size_t pixel) {
  std::uint32_t k = 0;
  for (int c = 0; c < p.channels; ++c)
    k = k << 8 | p.pixels[pixel * static_cast<std::size_t>(p.channels) + static_cast<std::size_t>(c)];
  return k;
}

std::size_t pixelCount(const Picture& p) {
  return static_cast<std::size_t>(p.width) * static_cast<std::size_t>(p.height);
}

// The commonest colour; of several the smallest number, so that the answer does not depend on chance.
std::uint32_t commonest(const Picture& p, std::map<std::uint32_t, std::size_t>& counts) {
  for (std::size_t i = 0; i < pixelCount(p); ++i) ++counts[key(p, i)];
  std::uint32_t best = 0;
  std::size_t most = 0;
  for (const auto& [k, n] : counts)
    if (n > most) best = k, most = n;
  return best;
}

void paint(Picture& p, std::size_t pixel, std::uint32_t colour) {
  for (int c = p.channels - 1; c >= 0; --c, colour >>= 8)
    p.pixels[pixel * static_cast<std::size_t>(p.channels) + static_cast<std::size_t>(c)] =
        static_cast<std::uint8_t>(colour);
}

bool stands_out(std::uint32_t a, std::uint32_t b) {
  for (int c = 0; c < 4; ++c, a >>= 8, b >>= 8)
    if (std::abs(static_cast<int>(a & 255) - static_cast<int>(b & 255)) > kObjectContrast) return true;
  return false;
}

// The pixels of every thing, in order of their first pixel.
std::vector<std::vector<std::size_t>> thingsOf(const Picture& p, std::uint32_t background) {
  const std::size_t w = static_cast<std::size_t>(p.width), n = pixelCount(p);
  std::vector<bool> open(n);
  for (std::size_t i = 0; i < n; ++i) open[i] = stands_out(key(p, i), background);
  std::vector<std::vector<std::size_t>> things;
  for (std::size_t first = 0; first < n; ++first) {
    if (!open[first]) continue;
    std::vector<std::size_t>& thing = things.emplace_back(1, first);
    open[first] = false;
    const auto take = [&](std::size_t i) {
      if (open[i]) open[i] = false, thing.push_back(i);
    };
    for (std::size_t at = 0; at < thing.size(); ++at) {
      const std::size_t i = thing[at];
      if (i % w > 0) take(i - 1);
      if (i % w + 1 < w) take(i + 1);
      if (i >= w) take(i - w);
      if (i + w < n) take(i + w);
    }
  }
  return things;
}

void removeThing(Picture& p) {
  std::map<std::uint32_t, std::size_t> counts;
  const std::uint32_t background = commonest(p, counts);
  const auto things = thingsOf(p, background);
  const std::vector<std::size_t>* gone = nullptr;
  for (const auto& t : things) {
    const bool big = t.size() >= kLeastObject_px;
    const bool goneIsBig = gone && gone->size() >= kLeastObject_px;
    if (!gone || (big && (!goneIsBig || t.size() < gone->size())) ||
        (!big && !goneIsBig && t.size() > gone->size()))
      gone = &t;
  }
  if (gone)
    for (std::size_t i : *gone) paint(p, i, background);
}

Picture rearranged(const Picture& from, auto&& sourceOf) {
  Picture to = from;
  for (int y = 0; y < from.height; ++y)
    for (int x = 0; x < from.width; ++x) {
      const auto [sx, sy] = sourceOf(x, y);
      std::copy_n(from.at(sx, sy), from.channels, to.at(x, y));
    }
  return to;
}

}  // namespace

const char* nameOf(Mutant m) { return kNames[static_cast<std::size_t>(m)].name; }
const char* saying(Mutant m) { return kNames[static_cast<std::size_t>(m)].saying; }
std::optional<Mutant> mutantNamed(std::string_view name) {
  for (const Mutant m : kMutants)
    if (name == nameOf(m)) return m;
  return {};
}

PictureFacts factsOf(const Picture& p) {
  PictureFacts f;
  if (p.pixels.empty()) return f;
  std::map<std::uint32_t, std::size_t> counts;
  const std::uint32_t background = commonest(p, counts);
  f.colours = static_cast<int>(std::min<std::size_t>(counts.size(), 65536));
  f.covered = 1 - static_cast<double>(counts[background]) / static_cast<double>(pixelCount(p));
  const double n = static_cast<double>(p.pixels.size());
  double mean = 0, squares = 0;
  for (const std::uint8_t v : p.pixels) mean += v;
  mean /= n;
  for (const std::uint8_t v : p.pixels) squares += (v - mean) * (v - mean);
  f.sd = std::sqrt(squares / n);
  return f;
}

Picture mutantOf(const Picture& p, Mutant m) {
  using At = std::pair<int, int>;
  Picture out = p;
  switch (m) {
    case Mutant::ShiftedRight:
      return rearranged(p, [](int x, int y) { return At{std::max(x - 1, 0), y}; });
    case Mutant::ShiftedDown:
      return rearranged(p, [](int x, int y) { return At{x, std::max(y - 1, 0)}; });
    case Mutant::Mirrored:
      return rearranged(p, [&](int x, int y) { return At{p.width - 1 - x, y}; });
    case Mutant::Gamma:
      for (std::uint8_t& v : out.pixels)
        v = static_cast<std::uint8_t>(std::lround(255 * std::pow(v / 255.0, 1 / 1.1)));
      return out;
    case Mutant::Blank: {
      std::map<std::uint32_t, std::size_t> counts;
      const std::uint32_t background = commonest(p, counts);
      for (std::size_t i = 0; i < pixelCount(p); ++i) paint(out, i, background);
      return out;
    }
    case Mutant::ObjectMissing:
      removeThing(out);
      return out;
  }
  return out;
}

}  // namespace vernier
