// SPDX-License-Identifier: GPL-3.0-or-later
// Files of a temporary folder through the scan, for tests of what it makes of them.
#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "MakeDicom.h"
#include "TestData.h"
#include "vernier/study/Load.h"

namespace vernier::test {

struct Scan {
  std::unique_ptr<TempDir> dir = std::make_unique<TempDir>();
  StudySet set;
  int files = 0;

  void add(const EnhancedObject& o) { writeEnhanced(dir->path() / (std::to_string(files++) + ".dcm"), o); }
  void add(const DicomSlice& s) { writeDicom(dir->path() / (std::to_string(files++) + ".dcm"), s); }
  void run() {
    auto scanned = scanStudy({dir->path().string()});
    ASSERT_TRUE(scanned) << scanned.error().text();
    set = std::move(*scanned);
  }
  const Instance& instance(std::size_t n = 0) const { return set.instances.at(n); }
  const Series& series(std::size_t n = 0) const { return set.series.at(n); }
  const Stack& stack(std::size_t n = 0) const { return series().stacks.at(n); }
  std::vector<std::uint64_t> order(std::size_t stackNumber = 0) const {
    std::vector<std::uint64_t> frames;
    for (const SliceRef& r : stack(stackNumber).slices) frames.push_back(r.frame);
    return frames;
  }
  const Finding* finding(const std::string& code) const {
    const auto in = [&](const std::vector<Finding>& list) -> const Finding* {
      for (const Finding& f : list)
        if (f.code == code) return &f;
      return nullptr;
    };
    for (const Series& s : set.series) {
      if (const Finding* f = in(s.findings)) return f;
      for (const Stack& k : s.stacks)
        if (const Finding* f = in(k.findings)) return f;
    }
    return in(set.findings);
  }
};
inline Scan scanOf(const std::vector<EnhancedObject>& objects) {
  Scan s;
  for (const EnhancedObject& o : objects) s.add(o);
  s.run();
  return s;
}
inline double number(const Finding& f, const std::string& key) { return std::get<double>(f.numbers.at(key)); }

}  // namespace vernier::test
