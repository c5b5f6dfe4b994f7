// SPDX-License-Identifier: GPL-3.0-or-later
// The suite that comes with the program: it passes on both engines, and it notices when the program is broken
// on purpose. What is expected of it was computed outside of the program, from the formulas of
// docs/phantoms.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <set>

#include "InstallPlace.h"
#include "QaDocument.h"
#include "QaRun.h"
#include "TestData.h"
#include "vernier/plan/CameraPicture.h"

namespace vernier::app {
namespace {
using test::TempDir;
using Json = nlohmann::ordered_json;

const std::vector<std::string> kBoth{"native", "gl"};

std::vector<std::string> cases() {
  const auto found = findQaCases(clinicSuiteFolder());
  return found ? *found : std::vector<std::string>();
}

std::vector<QaCaseResult> runAll(const Sabotage& sabotage, const std::vector<std::string>& engines,
                                 const std::string& suite = clinicSuiteFolder(),
                                 const std::vector<std::string>& names = cases()) {
  const auto newSession = [&] {
    SessionOptions o;
    o.threads = 2;
    o.sabotage = sabotage;
    return std::make_unique<Session>(o);
  };
  QaRunner runner({}, newSession, {});
  std::vector<QaCaseResult> results;
  for (const std::string& name : names) results.push_back(runner.run(suite + "/" + name, name, engines));
  return results;
}

std::string said(const QaCaseResult& r) {
  std::string all;
  for (const QaEngineResult& e : r.engines) {
    if (e.error) all += e.engine + ": " + e.error->text() + "\n";
    for (const QaRow& row : e.rows)
      if (!row.pass)
        all +=
            e.engine + ": " + row.quantity + " " + row.measured.dump() + " for " + row.expected.dump() + "\n";
  }
  return all;
}

std::set<std::string> notPassed(const std::vector<QaCaseResult>& results) {
  std::set<std::string> names;
  for (const QaCaseResult& r : results)
    for (const QaEngineResult& e : r.engines)
      if (e.verdict != QaVerdict::Pass) names.insert(r.name);
  return names;
}

TEST(ClinicSuite, PassesOnBothEngines) {
  ASSERT_GE(cases().size(), 60u) << clinicSuiteFolder();
  const auto results = runAll({}, kBoth);
  std::size_t gl = 0;
  for (const QaCaseResult& r : results)
    for (const QaEngineResult& e : r.engines) {
      EXPECT_EQ(e.verdict, QaVerdict::Pass) << r.name << "\n" << said(r);
      gl += e.engine == "gl" ? 1 : 0;
    }
  EXPECT_GE(gl + 5, cases().size());  // stored images, and lenses on slices, are the processor's alone
}

// What the list of the promises names is there.
TEST(ClinicSuite, HasEveryRequirement) {
  std::set<std::string> requirements;
  for (const std::string& name : cases()) {
    const auto c = readQaCase(clinicSuiteFolder() + "/" + name, name);
    ASSERT_TRUE(c.ok()) << c.error().text();
    EXPECT_FALSE(c->hazard.empty()) << name;
    requirements.insert(c->requirement);
  }
  for (const char* wanted :
       {"slices show the place that they state", "lengths and angles on slices", "areas on slices",
        "measurements", "grey scale", "values", "no data", "orientation letters", "projections",
        "volume rendering", "depth of tools", "lenses", "patient identity", "saving"})
    EXPECT_TRUE(requirements.contains(wanted)) << wanted;
}

// Half a pixel to the right, of slices and of pictures in 3-D.
void shiftCamera(Scene& scene, const View& view, const Sources& sources) {
  double mmPerPixel = 0;
  for (const Layer& layer : scene.layers)
    if (const auto* slice = std::get_if<SliceLayer>(&layer))
      if (const auto p = slicePicture(*slice, scene.camera, view, *sources.volumes.at(slice->source)))
        mmPerPixel = p->mmPerPixel;
  if (mmPerPixel == 0)
    if (const auto box = cameraBox(scene, sources))
      if (const auto p = cameraPicture(scene.camera, view, *box))
        mmPerPixel =
            p->projection == Projection::Orthographic ? p->pixelStep : p->pixelStep * p->targetDistance_mm;
  scene.camera.pan_mm.x += 0.5 * mmPerPixel;
}

void swapRows(Images& images, bool neighbours) {
  const auto swap = [&](auto& of, std::size_t perPixel) {
    if (of.empty()) return;
    const std::size_t row = perPixel * static_cast<std::size_t>(images.width);
    const auto height = static_cast<std::size_t>(images.height);
    const auto at = [&](std::size_t y) { return of.begin() + static_cast<std::ptrdiff_t>(y * row); };
    if (neighbours)
      for (std::size_t y = 0; y + 1 < height; y += 2) std::swap_ranges(at(y), at(y + 1), at(y + 1));
    else
      for (std::size_t y = 0; y < height / 2; ++y) std::swap_ranges(at(y), at(y + 1), at(height - 1 - y));
  };
  swap(images.colour, 4);
  swap(images.depth, 1);
  swap(images.values, 1);
}

TEST(ClinicSuite, NoticesABrokenEngineAndNamesTheCase) {
  std::vector<std::pair<std::string, Sabotage>> ways;
  ways.emplace_back("half a pixel", Sabotage{shiftCamera, {}, {}});
  ways.emplace_back("rows from below", Sabotage{{}, {}, [](const Plan&, Images& i) { swapRows(i, false); }});
  ways.emplace_back("rows in pairs", Sabotage{{}, {}, [](const Plan&, Images& i) { swapRows(i, true); }});
  ways.emplace_back("the last pass dropped", Sabotage{{},
                                                      [](Plan& p) {
                                                        if (!p.passes.empty()) p.passes.pop_back();
                                                      },
                                                      {}});
  std::set<std::string> noticed;
  for (const auto& [name, sabotage] : ways) {
    const auto broken = notPassed(runAll(sabotage, {"native"}));
    EXPECT_GE(broken.size(), name == "rows in pairs" ? 10u : 15u) << name;
    const std::string wanted =
        name == "the last pass dropped" ? "tools/inside-a-volume" : "geometry/ramp-axial";
    EXPECT_TRUE(broken.contains(wanted)) << name;
    noticed.insert(broken.begin(), broken.end());
  }
  // A case that draws and that no such fault reaches proves nothing.
  for (const std::string& name : cases()) {
    const auto c = readQaCase(clinicSuiteFolder() + "/" + name, name);
    ASSERT_TRUE(c.ok());
    if (!c->draws() || name == "orientation/three-d" || name == "saving/scene-3d" ||
        name == "saving/scene-and-measurements")
      continue;  // letters of the scene; and the same picture twice, whatever it shows
    EXPECT_TRUE(noticed.contains(name)) << name;
  }
}

TEST(ClinicSuite, AFaultOfOneEngineIsToldApart) {
  Sabotage onlyGl;
  onlyGl.picture = [](const Plan& p, Images& i) {
    if (!p.passes.empty() && p.passes.front().engine == Engine::Gl) swapRows(i, false);
  };
  const std::vector<std::string> some{"geometry/ramp-axial", "measure/lengths", "orientation/axial-of-axial"};
  const auto results = runAll(onlyGl, kBoth, clinicSuiteFolder(), some);
  for (const QaCaseResult& r : results) {
    ASSERT_EQ(r.engines.size(), 2u) << r.name;
    EXPECT_EQ(r.engines[0].verdict, QaVerdict::Pass) << r.name;
    EXPECT_EQ(r.engines[1].verdict, r.name == "measure/lengths" ? QaVerdict::Pass : QaVerdict::Fail)
        << r.name;
  }
  const QaJson document = qaDocument({"clinic", kBoth, "2026-01-01T00:00:00Z", 1}, {}, results);
  ASSERT_EQ(document["summary"].size(), 2u);
  EXPECT_EQ(document["summary"][0]["passed"], 3);
  EXPECT_EQ(document["summary"][1]["passed"], 1);
  EXPECT_NE(document["summary"][1].dump().find("geometry/ramp-axial"), std::string::npos);
}

// Every expectation is moved out of its tolerance: every row must fail, so none is there for show.
Json spoilt(Json check) {
  const auto off = [&](Json& n) {
    if (n.is_number())
      n = n.get<double>() + (n.get<double>() > 128 ? -1 : 1) * (2 * check.value("tolerance", 0.0) + 1);
  };
  const std::string kind = check["kind"];
  if (kind == "letters") {
    for (const char* edge : {"left", "right", "top", "bottom"}) check[edge] = "X";
    check["flipped"] = true;
  } else if (kind == "text") {
    check["says"] = "nothing of the kind";
  } else if (kind == "two-patients") {
    check["answer"] = check["answer"] == "refused" ? "allowed" : "refused";
  } else if (kind == "error") {
    check["at_most"] = 0;
  } else if (kind == "centroid") {
    for (Json& n : check["expected_px"]) off(n);
  } else if (check["expected"].is_null()) {
    check["expected"] = 1, check["tolerance"] = 1;
  } else if (check["expected"].is_array()) {
    for (Json& n : check["expected"]) off(n);
  } else if (kind == "measurement" && !check.contains("tolerance")) {
    check["expected"] = 2 * check["expected"].get<double>();  // far outside of any +/-
  } else {
    off(check["expected"]);
    if (check.contains("stored")) check["stored"] = check["stored"].get<double>() + 1;
  }
  return check;
}

TEST(ClinicSuite, NoExpectationIsThereForShow) {
  const TempDir dir;
  std::vector<std::string> names;
  for (const std::string& name : cases()) {
    std::ifstream in(clinicSuiteFolder() + "/" + name + "/case.json");
    Json j = Json::parse(in);
    Json checks = Json::array();
    for (const Json& check : j["checks"])
      if (check["kind"] != "reload") checks.push_back(spoilt(check));
    if (checks.empty()) continue;
    j["checks"] = checks;
    std::filesystem::create_directories(dir.path() / name);
    std::ofstream(dir.path() / name / "case.json") << j.dump();
    names.push_back(name);
  }
  ASSERT_GE(names.size(), 60u);
  for (const QaCaseResult& r : runAll({}, {"native"}, dir.path().string(), names)) {
    ASSERT_EQ(r.engines.size(), 1u);
    EXPECT_FALSE(r.engines[0].error.has_value()) << r.name << " " << r.engines[0].error->text();
    for (const QaRow& row : r.engines[0].rows)
      EXPECT_FALSE(row.pass) << r.name << ": " << row.quantity << " " << row.measured.dump();
  }
}

// The one kind that has no expectation of its own: another picture at the second time is noticed.
TEST(ClinicSuite, ReloadNoticesAnotherPicture) {
  int drawn = 0;
  Sabotage second;
  second.picture = [&](const Plan&, Images& i) {
    if (++drawn == 2) i.colour[100] += 1e-6f;
  };
  const auto results = runAll(second, {"native"}, clinicSuiteFolder(), {"saving/scene-3d"});
  ASSERT_EQ(drawn, 2);
  ASSERT_EQ(results[0].engines[0].verdict, QaVerdict::Fail);
  for (const QaRow& row : results[0].engines[0].rows)
    EXPECT_EQ(row.pass, row.quantity != "picture of the saved scene") << row.quantity;
}

}  // namespace
}  // namespace vernier::app
