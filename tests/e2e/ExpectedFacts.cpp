// SPDX-License-Identifier: GPL-3.0-or-later
#include "ExpectedFacts.h"

#include <fstream>
#include <set>

#include "InfoJson.h"
#include "TestData.h"

namespace vernier::test {
namespace {
const Json* byFile(const Json& list, const std::string& name) {
  for (const Json& o : list)
    if (o.at("file") == name) return &o;
  return nullptr;
}
}  // namespace

bool Facts::undecided(const std::string& name) const {
  const Json* o = byFile(expected.at("objects"), name);
  return o && o->value("verdict", "") == "either";
}
const Json* Facts::object(const std::string& name) const { return byFile(info.at("objects"), name); }
const Json* Facts::file(const std::string& name) const { return byFile(info.at("files"), name); }

std::vector<Json> Facts::findings(const std::string& code) const {
  std::vector<Json> out;
  const auto take = [&](const Json& list, const Json& series) {
    for (Json f : list) {
      if (f.at("code") != code) continue;
      if (!series.is_null()) f["series"] = series.at("series_uid");
      out.push_back(std::move(f));
    }
  };
  take(info.at("findings"), nullptr);
  for (const Json& s : info.at("series")) {
    take(s.at("findings"), s);
    for (const Json& stack : s.at("stacks")) take(stack.at("findings"), s);
  }
  return out;
}

const Json* Facts::series(const std::string& studyUid, const std::string& seriesUid) const {
  for (const Json& s : info.at("series"))
    if (s.at("study_uid") == studyUid && s.at("series_uid") == seriesUid) return &s;
  return nullptr;
}

Facts factsOf(const std::string& folder) {
  Facts facts;
  facts.expected = Json::parse(std::ifstream(dataDir() / "expected" / (folder + ".json")));
  InfoOptions options;
  options.pixels = true;
  for (const Json& o : facts.expected.at("objects"))
    if (o.contains("pixels"))
      for (const Json& p : o["pixels"].value("probes", Json::array()))
        options.probes.push_back({o.at("file"), p.at("row"), p.at("column")});
  const auto set = scanStudy({(dataDir() / folder).string()});
  if (!set) {
    ADD_FAILURE() << set.error().text();
    return facts;
  }
  facts.info = Json::parse(infoJson(*set, options));
  return facts;
}

Totals expectedTotals(const Facts& f, bool withUndecided) {
  Totals t;
  std::set<std::string> uids;
  for (const Json& o : f.expected.at("objects")) {
    if (!withUndecided && o.value("verdict", "") == "either") continue;
    ++t.files;
    const std::string kind = o.at("kind");
    t.notDicom += kind == "not DICOM";
    t.directories += kind == "DICOMDIR";
    if (kind != "image" && kind != "non-image") continue;
    ++t.objects;
    if (kind == "image") {
      ++t.images;
      t.frames += o.value("frames", std::size_t{0});
    }
    if (o.contains("sop_instance")) uids.insert(o["sop_instance"]);
  }
  t.distinctUids = uids.size();
  return t;
}

Totals infoTotals(const Facts& f, bool withUndecided) {
  Totals t;
  std::set<std::string> uids;
  for (const Json& file : f.info.at("files")) {
    if (!withUndecided && f.undecided(file.at("file"))) continue;
    ++t.files;
    t.notDicom += file.at("kind") == "not DICOM";
    t.directories += file.at("kind") == "DICOMDIR";
  }
  for (const Json& o : f.info.at("objects")) {
    if (!withUndecided && f.undecided(o.at("file"))) continue;
    ++t.objects;
    if (o.at("kind") == "image") {
      ++t.images;
      t.frames += o.at("frames").get<std::size_t>();
    }
    if (!o.at("sop_instance_uid").get<std::string>().empty()) uids.insert(o["sop_instance_uid"]);
  }
  t.distinctUids = uids.size();
  return t;
}

}  // namespace vernier::test
