// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of two people side by side: a red band, and they are laid on each other by nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "MakeDicom.h"
#include "WindowDriver.h"
#include "WindowStudies.h"

namespace vernier::ui {
namespace {

using vernier::test::DicomSlice;

// Stripes whose brightness tells the two apart.
std::string series(const vernier::test::TempDir& dir, const std::string& name, const std::string& uid,
                   const std::vector<std::pair<std::string, std::string>>& person, int level) {
  std::filesystem::create_directories(dir.path() / "set");
  DicomSlice s;
  s.seriesUid = uid;
  s.frameOfReferenceUid = "2.25.1003";  // one scanner's coordinates for all of them
  s.rows = s.columns = 16;
  s.set = person;
  s.set.insert(s.set.end(), {{"0008,103E", name}, {"0028,1050", "100"}, {"0028,1051", "200"}});
  for (int i = 0; i < 256; ++i) s.pixels.push_back(level + (i % 16 < 8 ? 0 : 60));
  for (int k = 0; k < 4; ++k) {
    s.position = {0, 0, 2.0 * k};
    s.instanceNumber = k + 1;
    vernier::test::writeDicom(dir.path() / "set" / (name + std::to_string(k) + ".dcm"), s);
  }
  return (dir.path() / "set").string();
}

using Person = std::vector<std::pair<std::string, std::string>>;
const Person kOne = {{"0010,0020", "ID-1"}, {"0010,0030", "19700102"}, {"0010,0040", "F"}};

struct Case {
  const char* what;
  Person other;
  bool refused;
  const char* words;  // of the refusal
};
const Case kCases[] = {{"another ID",
                        {{"0010,0020", "ID-2"}, {"0010,0030", "19700102"}, {"0010,0040", "F"}},
                        true,
                        "not of one person"},
                       {"another birth date",
                        {{"0010,0020", "ID-1"}, {"0010,0030", "19700103"}, {"0010,0040", "F"}},
                        true,
                        "birth date"},
                       {"another sex",
                        {{"0010,0020", "ID-1"}, {"0010,0030", "19700102"}, {"0010,0040", "M"}},
                        true,
                        "birth date or sex"},
                       {"the same person", kOne, false, ""}};

struct Seen {
  std::vector<std::uint8_t> left, right;  // a row of each picture
  // Pixels of the band's colour: in the band that runs above the pictures, and in their headers below it.
  std::size_t band = 0, headers = 0;
};
Seen look(test::WindowDriver& w) {
  const Picture p = w.screenshot();
  Seen s;
  const int tile = (p.width - 2) / 2, y = p.height / 2 + 90;
  for (int x = 4; x < tile - 4; ++x) {
    s.left.push_back(p.at(x, y)[0]);
    s.right.push_back(p.at(tile + 2 + x, y)[0]);
  }
  const auto red = [&](int from, int to) {
    std::size_t n = 0;
    for (int row = from; row < to; ++row)
      for (int x = 0; x < p.width; ++x) {
        const std::uint8_t* c = p.at(x, row);
        n += c[0] == 150 && c[1] == 32 && c[2] == 30;
      }
    return n;
  };
  s.band = red(48, 68), s.headers = red(74, 94);
  return s;
}

// Both series in one set of one study, one after the other in `w`.
void openBoth(test::WindowDriver& w, const std::string& folder) {
  w.open(folder);
  w.key(GLFW_KEY_B, true);
  w.key(GLFW_KEY_F3);
  for (const auto& d : w.desk().documents()) {
    const StudySet& set = d->session->study();
    ASSERT_EQ(set.series.size(), 2u);
    for (std::size_t s = 0; s < 2; ++s)
      w.desk().openSource({d->number, d->session->sourceName({s, 0})}, static_cast<int>(s));
  }
  ASSERT_TRUE(w.settle());
}

TEST(TwoPatients, WipeAndFlickerAreRefusedWithinOneSet) {
  for (const Case& c : kCases) {
    SCOPED_TRACE(c.what);
    vernier::test::TempDir dir;
    test::WindowDriver w;
    if (!w.here()) return;
    (void)series(dir, "a", "2.25.21", kOne, 40);
    openBoth(w, series(dir, "b", "2.25.22", c.other, 90));
    w.move(1, 1);
    const Seen before = look(w);
    ASSERT_NE(before.left, before.right);
    EXPECT_EQ(w.workspace().differentPeople(), c.refused);
    if (c.refused) {
      EXPECT_GT(before.band, 20u * 640);
      EXPECT_GT(before.headers, 20u * 640);
    } else {
      EXPECT_EQ(before.band + before.headers, 0u);
    }

    w.key(GLFW_KEY_K);
    const std::string why = w.host().gui().why();
    w.key(GLFW_KEY_ESCAPE);  // the sentence is not looked at here
    w.move(200, 500);
    w.move(1, 790);
    const Seen wiped = look(w);
    if (c.refused) {
      EXPECT_NE(why.find(c.words), std::string::npos) << why;
      EXPECT_NE(why.find("not laid on each other"), std::string::npos) << why;
      EXPECT_EQ(why.find("1970"), std::string::npos) << why;
      EXPECT_EQ(wiped.left, before.left);
      EXPECT_EQ(wiped.right, before.right);
    } else {
      EXPECT_EQ(why, "");
      EXPECT_NE(wiped.left, before.left) << "it can be wiped";
      w.key(GLFW_KEY_K);
    }
    w.hold(GLFW_KEY_F, true);
    const std::string whyFlicker = w.host().gui().why();
    w.key(GLFW_KEY_ESCAPE);
    const Seen flicker = look(w);
    w.hold(GLFW_KEY_F, false);
    if (c.refused) {
      EXPECT_NE(whyFlicker.find(c.words), std::string::npos) << whyFlicker;
      EXPECT_EQ(flicker.left, before.left);
      EXPECT_EQ(flicker.right, before.right);
    } else {
      EXPECT_EQ(flicker.left, before.right);
      EXPECT_EQ(flicker.right, before.left);
    }
  }
}

// A wipe that was begun ends when another person's picture comes into one of the two.
TEST(TwoPatients, AWipeEndsWhenAnotherPersonComes) {
  vernier::test::TempDir dir;
  test::WindowDriver w;
  if (!w.here()) return;
  (void)series(dir, "a", "2.25.21", kOne, 40);
  openBoth(w, series(dir, "b", "2.25.22", kCases[1].other, 90));
  const SourceId one = w.workspace().tile(0).source, other = w.workspace().tile(1).source;
  w.desk().openSource(one, 1);
  ASSERT_TRUE(w.settle());
  w.key(GLFW_KEY_K);
  EXPECT_EQ(w.host().gui().why(), "");
  w.desk().openSource(other, 1);
  ASSERT_TRUE(w.settle());
  w.move(200, 500);
  w.move(1, 790);
  const Seen now = look(w);
  EXPECT_GT(now.band, 20u * 640);
  const auto [low, high] = std::minmax_element(now.left.begin(), now.left.end());
  const auto [lowR, highR] = std::minmax_element(now.right.begin(), now.right.end());
  EXPECT_LT(*high, *highR) << "each picture is its own, on its whole width";
  EXPECT_GT(*lowR, *low);
}

// Volume files name nobody: two of them may be laid on each other, one of them on a patient's images not.
TEST(TwoPatients, VolumeFilesNameNobody) {
  vernier::test::TempDir dir;
  test::WindowDriver w;
  if (!w.here()) return;
  w.key(GLFW_KEY_F3);
  for (const char* name : {"one", "two"}) w.open(test::volumeFile(dir, name));
  ASSERT_EQ(w.desk().documents().size(), 2u);
  for (int t = 0; t < 2; ++t) {
    const Document& d = *w.desk().documents()[static_cast<std::size_t>(t)];
    w.desk().openSource({d.number, d.session->sourceName(*d.session->choose(""))}, t);
  }
  ASSERT_TRUE(w.settle());
  EXPECT_FALSE(w.workspace().differentPeople());
  w.open(series(dir, "a", "2.25.21", kOne, 40));
  const Document& patient = *w.desk().documents()[2];
  w.desk().openSource({patient.number, patient.session->sourceName(*patient.session->choose(""))}, 1);
  ASSERT_TRUE(w.settle());
  EXPECT_TRUE(w.workspace().differentPeople());
}

}  // namespace
}  // namespace vernier::ui
