// SPDX-License-Identifier: GPL-3.0-or-later
// Lists: undo and redo, files, and what stands on the screen.
#include <clocale>

#include "MeasureCases.h"
#include "vernier/measure/MeasurementJson.h"

namespace vernier::measure::test {
namespace {

std::vector<Shape> everyKind(Draws& d) {
  const auto p = [&] { return Spot(d.within(-1e3, 1e3), d.normal() / 3, d.within(-1e-6, 1e-6)); };
  PatientFromMesh pose;
  for (int c = 0; c < 3; ++c) pose.linear[c] = d.direction();
  pose.translation = p();
  const SurfaceRef named{"screw \"a\".stl", {}, pose}, level{"", 0.1 + d.unit(), {}};
  return {Length{{p(), p()}},
          Bidirectional{{p(), p()}, {p(), p()}},
          Angle{p(), {p(), p()}},
          Cobb{{p(), p()}, {p(), p()}},
          RectangleRegion{{p(), p()}},
          EllipseRegion{{p(), p()}},
          PolygonRegion{{p(), p(), p(), p()}},
          FreehandRegion{{p(), p(), p()}},
          ThresholdRegion{d.normal(), p()},
          Probe{p()},
          PointToSurface{p(), named},
          ToolToVessel{named, level},
          IsoVolume{d.normal(), p()},
          ConvexVolume{{{PatientVec(d.direction()), d.normal()}, {PatientVec(d.direction()), -0.0}}},
          SurfaceVolume{level},
          Arrow{p(), p(), "tip\n\xC3\xA9"},
          Text{p(), "\"quoted\" \\ \t"}};
}

std::vector<Entry> everyEntry() {
  Draws d(21);
  std::vector<Entry> out;
  for (int round = 0; round < 3; ++round)
    for (Shape s : everyKind(d)) {
      Entry e;
      e.what.id = "m" + std::to_string(out.size());
      e.what.label = round == 1 ? "left \xE2\x80\x9Ckidney\xE2\x80\x9D" : "";
      e.what.shape = std::move(s);
      e.what.on.source = round == 2 ? "1.2.3#2" : "";
      e.what.on.shown = static_cast<Shown>(out.size() % 4);
      e.what.on.screenPixel = d.unit();
      if (round > 0) e.what.on.axes = randomAxes(d);
      if (round == 2 && std::holds_alternative<Length>(e.what.shape)) {
        e.what.on = Placement{};
        e.what.on.space = Space::Image;
        e.what.on.frame = 12;
        e.what.on.userSpacing_mm = glm::dvec2(0.1, 0.3);
        e.what.shape = Length{{Spot(0.1, 0.2, 0), Spot(1e-17, 3, 0)}};
      }
      Measured m;
      m.quantities = {{"length", d.normal() * 1e5, "mm", d.unit()}, {"n", 12, "1", std::nullopt}};
      m.origin = static_cast<Origin>(out.size() % 10);
      m.originText = "mm";
      if (round == 1) {
        m.values = Statistics{5, 2, -1, d.normal(), 0.1 + 0.2, 0.3, 1.0 / 3, 4.7, {-0.5, 0.25, {1, 0, 4}}};
        m.notes = {"interpolated"};
        if (e.what.on.space == Space::Patient) m.found = {d.direction(), d.direction()};
      }
      if (round < 2)
        e.said = m;
      else
        e.refused = "It cannot be.";
      out.push_back(std::move(e));
    }
  return out;
}

TEST(MeasurementJson, ReadsBackBitByBit) {
  const std::vector<Entry> all = everyEntry();
  const std::string text = writeMeasurements(all);
  const auto back = parseMeasurements(text);
  ASSERT_TRUE(back.ok()) << back.error().text();
  ASSERT_EQ(back->size(), all.size());
  for (std::size_t n = 0; n < all.size(); ++n)
    EXPECT_TRUE((*back)[n] == all[n]) << kindOf(all[n].what.shape) << n;
  EXPECT_EQ(writeMeasurements(*back), text);
  EXPECT_TRUE(parseMeasurements(writeMeasurements({}))->empty());
}

TEST(MeasurementJson, EveryFaultIsNamedWithItsPath) {
  const auto fault = [](const std::string& measurements, const std::string& rest = "") {
    const auto r = parseMeasurements("{\"schema\": 1, \"measurements\": [" + measurements + "]" + rest + "}");
    EXPECT_FALSE(r.ok()) << measurements;
    if (r.ok()) return std::string("accepted");
    EXPECT_EQ(r.error().code, ErrorCode::OptionInvalid);
    EXPECT_GT(r.error().sentence.size(), 15u);
    return r.error().where;
  };
  const std::string length = R"({"kind": "length", "space": "patient", "points": [[0,0,0],[1,2,3]])";
  EXPECT_EQ(fault(length + ", \"colour\": 1}"), "/measurements/0/colour");
  EXPECT_EQ(fault(length + ", \"label\": 1}"), "/measurements/0/label");
  EXPECT_EQ(fault(length + ", \"kind\": \"length\"}"), "/measurements/0/kind");
  EXPECT_EQ(fault(length + ", \"screen_pixel\": -1}"), "/measurements/0/screen_pixel");
  EXPECT_EQ(fault(length + ", \"normal\": [0,0,1]}"), "/measurements/0");
  EXPECT_EQ(fault(length + ", \"shown\": \"mip\"}"), "/measurements/0/shown");
  EXPECT_EQ(fault(length + "}, " + R"({"kind": "circle", "space": "patient"})"), "/measurements/1/kind");
  EXPECT_EQ(fault(length + ", \"id\": \"a\"}, " + length + ", \"id\": \"a\"}"), "/measurements/1/id");
  EXPECT_EQ(fault(length + "}", ", \"more\": 1"), "/more");
  EXPECT_EQ(fault(R"({"kind": "length", "space": "patient", "points": [[0,0,0]]})"),
            "/measurements/0/points");
  EXPECT_EQ(fault(R"({"kind": "length", "space": "image", "points": [[0,0,0],[1,1,1]]})"),
            "/measurements/0/points/0");
  EXPECT_EQ(fault(R"({"kind": "length", "space": "patient", "points": [[0,0,0],[1,1,1e999]]})"),
            "/measurements/0/points/1/2");
  EXPECT_EQ(fault(R"({"kind": "probe", "space": "moon", "point": [0,0,0]})"), "/measurements/0/space");
  EXPECT_EQ(
      fault(
          R"({"kind": "point_to_surface", "space": "patient", "point": [0,0,0], "surface": {"file": "a"}})"),
      "/measurements/0/surface");
  EXPECT_EQ(parseMeasurements("{\"schema\": 2, \"measurements\": []}").error().where, "/schema");
  EXPECT_FALSE(parseMeasurements("{\"measurements\": []}").ok());
  EXPECT_FALSE(parseMeasurements("").ok());
  EXPECT_FALSE(parseMeasurements(std::string(40, '[')).ok());
}

// Cut anywhere, a file is refused and never half read.
TEST(MeasurementJson, ATextCutAnywhereIsRefused) {
  const std::string text = writeMeasurements({everyEntry().front(), everyEntry()[20]});
  for (std::size_t n = 0; n + 2 < text.size(); n += 3)
    EXPECT_FALSE(parseMeasurements(text.substr(0, n)).ok()) << n;
}

TEST(MeasurementList, UndoAndRedoGoThroughEveryStep) {
  MeasurementList list;
  Draws d(22);
  std::vector<std::vector<Entry>> states{list.entries()};
  const auto took = [&] { states.push_back(list.entries()); };
  for (int n = 0; n < 60; ++n) {
    if (list.size() < 3 || n % 3 == 0) {
      list.add(inPatient(Length{{Spot(n, 0, 0), Spot(0, n, 0)}}));
    } else if (n % 3 == 1) {
      Measurement m = list.at(static_cast<std::size_t>(n) % list.size()).what;
      setHandle(m.shape, 0, {d.unit(), n, n});
      ASSERT_TRUE(list.change(m));
    } else {
      ASSERT_TRUE(list.remove(list.at(static_cast<std::size_t>(n) % list.size()).what.id));
    }
    took();
  }
  for (std::size_t n = states.size() - 1; n > 0; --n) {
    ASSERT_TRUE(list.canUndo());
    list.undo();
    ASSERT_TRUE(list.entries() == states[n - 1]) << n;
  }
  EXPECT_FALSE(list.canUndo());
  list.undo();
  for (std::size_t n = 1; n < states.size(); ++n) {
    list.redo();
    ASSERT_TRUE(list.entries() == states[n]) << n;
  }
  EXPECT_FALSE(list.canRedo());
  list.undo();
  list.add(inPatient(Probe{}));
  EXPECT_FALSE(list.canRedo()) << "a new step ends what could be redone";
}

TEST(MeasurementList, ADragIsOneStepAndResultsAreNone) {
  MeasurementList list;
  const std::string id = list.add(inPatient(Length{{Spot(0, 0, 0), Spot(1, 0, 0)}}));
  const auto before = list.entries();
  for (int n = 0; n < 50; ++n) {
    Measurement m = list.at(0).what;
    setHandle(m.shape, 1, {2 + n, 0, 0});
    EXPECT_TRUE(list.change(m, n > 0));
    list.setResult(id, Measured{});
  }
  EXPECT_TRUE(list.at(0).said.has_value());
  list.undo();
  EXPECT_TRUE(list.entries() == before);
  EXPECT_FALSE(list.change(list.at(0).what)) << "nothing changed";
  EXPECT_EQ(list.add(list.at(0).what) == id, false) << "an id that is taken is given anew";
  EXPECT_FALSE(list.remove("none"));
}

TEST(MeasurementDisplay, NoDigitIsFinerThanTheUncertainty) {
  const auto text = [](double v, double u, const char* unit = "mm") { return displayText({"", v, unit, u}); };
  EXPECT_EQ(text(52.3456, 0.42), "52.3 \u00b1 0.5 mm");
  EXPECT_EQ(text(52.3456, 0.5), "52.3 \u00b1 0.5 mm");
  EXPECT_EQ(text(52.3456, 0.96), "52 \u00b1 1 mm");
  EXPECT_EQ(text(1234.5, 34, "mm2"), "1230 \u00b1 40 mm\u00b2");
  EXPECT_EQ(text(-0.001, 0.2), "0.0 \u00b1 0.2 mm");
  EXPECT_EQ(text(0.0123456, 0.00021), "0.0123 \u00b1 0.0003 mm");
  EXPECT_EQ(text(89.97, 1.2, "deg"), "90 \u00b1 2\u00b0");
  EXPECT_EQ(displayText({"", 12, "1", std::nullopt}), "12");
  EXPECT_EQ(displayText({"", 1234567.891, "HU", std::nullopt}), "1.23457e+06 HU");
  EXPECT_EQ(displayLike(7.45295, {"mean", 30.1, "HU", 0.4}), "7.5");
  EXPECT_EQ(displayLike(7.45295, {"mean", 30.1, "HU", 4}), "7");
  EXPECT_EQ(displayLike(7.45295, {"mean", 30.1, "HU", std::nullopt}), "7.45295");
  Measured m;
  EXPECT_EQ(displayStatistics(m), "");
  m.quantities = {{"area", 5, "mm2", 1}, {"mean", 70.4, "HU", 42}};
  m.values = Statistics{144, 0, -3, 217, 70.4, 41, 52.3, 20, {}};
  EXPECT_EQ(displayStatistics(m), "min -3, max 217, median 40, SD 50");
  m.notes = {"interpolated"};
  EXPECT_EQ(displayStatistics(m), "min 0, max 220, median 40, SD 50");
  Draws d(23);
  for (int n = 0; n < 2000; ++n) {
    const double v = d.normal() * std::pow(10, d.within(-3, 5)), u = std::pow(10, d.within(-4, 4));
    const std::string s = text(v, u);
    const std::size_t at = s.find(" \u00b1 ");
    ASSERT_NE(at, std::string::npos) << s;
    const std::string shown = s.substr(0, at);
    const double value = std::stod(shown), said = std::stod(s.substr(at + 4));
    ASSERT_GE(said, u * (1 - 1e-9)) << s << " for " << u;
    ASSERT_LE(said, 2 * u * (1 + 1e-9)) << s << " for " << u;
    const std::size_t dot = shown.find('.');
    const double place =
        dot == std::string::npos ? 1 : std::pow(10, -static_cast<double>(shown.size() - dot - 1));
    ASSERT_LE(place, said * (1 + 1e-9)) << s;
    ASSERT_LE(std::abs(value - v), 0.5 * std::max(place, said)) << s;
  }
}

}  // namespace
}  // namespace vernier::measure::test
