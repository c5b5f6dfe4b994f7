// SPDX-License-Identifier: GPL-3.0-or-later
// One series per transfer syntax: equal values where lossless, within the stated bound where lossy.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "Files.h"
#include "TestData.h"

namespace vernier::test {
namespace {

TEST(SyntaxesPhantom, DecodesToTheSameValuesInEverySyntax) {
  TempDir dir;
  const Written w = writeAndRead(dir.path(), "syntaxes");
  ASSERT_EQ(w.answers["series"].size(), 12u);
  std::map<std::string, std::map<double, const ReadFile*>> bySeries;
  for (const ReadFile& f : w.files) bySeries[f.seriesUid][f.origin[2]] = &f;
  ASSERT_EQ(bySeries.size(), 12u);
  const auto& plain = bySeries[w.answers["series"][0]["series_uid"]];
  ASSERT_EQ(plain.size(), 4u);
  std::set<std::string> syntaxes;
  int lossy = 0;
  for (const auto& series : w.answers["series"]) {
    const double bound = series["stored_bound"];
    const double slope = series["rescale_slope"];
    double worst = 0;
    for (const auto& [z, f] : bySeries[series["series_uid"]]) {
      EXPECT_EQ(f->transferSyntax, series["transfer_syntax"]);
      syntaxes.insert(f->transferSyntax);
      const ReadFile& truth = *plain.at(z);
      ASSERT_EQ(f->stored.size(), truth.stored.size());
      for (std::size_t n = 0; n < truth.stored.size(); ++n) {
        // What the series would hold without compression: the same value in its own steps.
        const double whole =
            std::min(std::floor(truth.stored[n] / slope + 0.5), double((1 << f->bitsStored) - 1));
        worst = std::max(worst, std::fabs(f->stored[n] - whole));
      }
    }
    // (8 bit: the uncompressed 8-bit value is rounded from the formula, not from the 12-bit value: 1 more.)
    EXPECT_LE(worst, bound + (slope > 1 ? 1 : 0)) << series["description"];
    std::cout << "  " << series["description"].get<std::string>() << ": largest difference " << worst
              << " of bound " << bound << "\n";
    lossy += bound > 0;
    EXPECT_EQ(worst > 0, bound > 0) << series["description"];
  }
  EXPECT_EQ(syntaxes.size(), 12u);
  EXPECT_EQ(lossy, 3);
}

}  // namespace
}  // namespace vernier::test
