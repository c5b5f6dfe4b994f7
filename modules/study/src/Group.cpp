// SPDX-License-Identifier: GPL-3.0-or-later
#include "Group.h"

#include <algorithm>
#include <map>
#include <set>

#include "Stacks.h"

namespace vernier {
namespace {

// A key that no other object shares, for objects without a UID.
std::string alone(std::size_t n) { return "\x01" + std::to_string(n); }

std::string orElse(const std::string& uid, std::size_t n) { return uid.empty() ? alone(n) : uid; }

void fillSeries(const Record& r, Series& s) {
  s.seriesUid = r.seriesUid;
  s.studyUid = r.studyUid;
  s.modality = r.instance.modality;
  s.description = r.seriesDescription;
  s.number = r.seriesNumber;
}
void fillStudy(const Record& r, Study& s) {
  s.studyUid = r.studyUid;
  s.date = r.studyDate;
  s.time = r.studyTime;
  s.description = r.studyDescription;
  s.accession = r.accession;
}
void fillPatient(const Record& r, Patient& p) {
  p.id = r.patientId;
  p.issuer = r.issuer;
  p.name = r.patientName;
  p.birthDate = r.birthDate;
  p.sex = r.sex;
}

std::string idKey(const Record& r) { return r.issuer + "\x01" + r.patientId; }

// What is stated of one Patient ID; what is absent is not another value.
struct Stated {
  std::set<std::string> birthDates, sexes;
  bool ofSeveral() const { return birthDates.size() > 1 || sexes.size() > 1; }
};
std::map<std::string, Stated> statedOfIds(const std::vector<Record>& records) {
  std::map<std::string, Stated> out;
  for (const Record& r : records) {
    if (r.patientId.empty()) continue;
    Stated& s = out[idKey(r)];
    if (!r.birthDate.empty()) s.birthDates.insert(r.birthDate);
    if (!r.sex.empty()) s.sexes.insert(r.sex);
  }
  return out;
}

void completePatient(const Record& r, Patient& p) {
  if (p.birthDate.empty()) p.birthDate = r.birthDate;
  if (p.sex.empty()) p.sex = r.sex;
}

}  // namespace

Grouping groupRecords(std::vector<Record>& records) {
  Grouping out;
  std::map<std::string, std::size_t> patientOf, studyOf;
  std::map<std::pair<std::string, std::string>, std::size_t> seriesOf;
  std::map<std::string, std::set<std::string>> studiesOfSeriesUid, patientsOfStudy;
  const std::map<std::string, Stated> stated = statedOfIds(records);
  for (std::size_t n = 0; n < records.size(); ++n) {
    Record& r = records[n];
    const std::string studyKey = orElse(r.studyUid, n);
    const std::string seriesKey = orElse(r.seriesUid, n);
    std::string patientKey = r.patientId.empty() ? "\x02" + studyKey : idKey(r);
    const bool several = !r.patientId.empty() && stated.at(patientKey).ofSeveral();
    if (several) patientKey += "\x01" + r.birthDate + "\x01" + r.sex;

    const auto [p, newPatient] = patientOf.try_emplace(patientKey, out.patients.size());
    if (newPatient) fillPatient(r, out.patients.emplace_back());
    if (!several) completePatient(r, out.patients[p->second]);
    const auto [st, newStudy] = studyOf.try_emplace(studyKey, out.studies.size());
    if (newStudy) fillStudy(r, out.studies.emplace_back());
    const auto [se, newSeries] = seriesOf.try_emplace({studyKey, seriesKey}, out.series.size());
    if (newSeries) {
      fillSeries(r, out.series.emplace_back());
      out.studies[st->second].series.push_back(se->second);
    }
    auto& studies = out.patients[p->second].studies;
    if (std::find(studies.begin(), studies.end(), st->second) == studies.end()) studies.push_back(st->second);
    r.instance.series = se->second, r.instance.patient = p->second;
    out.series[se->second].instances.push_back(n);
    if (!r.seriesUid.empty()) studiesOfSeriesUid[r.seriesUid].insert(studyKey);
    patientsOfStudy[studyKey].insert(patientKey);
  }
  for (const auto& [uid, studies] : studiesOfSeriesUid)
    if (studies.size() > 1)
      out.findings.push_back({"series-uid-in-several-studies",
                              Severity::Notice,
                              "One Series Instance UID occurs in " + std::to_string(studies.size()) +
                                  " studies; they are kept apart.",
                              {{"series", uid}, {"studies", static_cast<double>(studies.size())}}});
  for (const auto& [study, patients] : patientsOfStudy)
    if (patients.size() > 1)
      out.findings.push_back({"study-of-several-patients",
                              Severity::Warning,
                              "One study holds objects of " + std::to_string(patients.size()) +
                                  " patients; their images are never mixed in one stack.",
                              {{"study", study}, {"patients", static_cast<double>(patients.size())}}});
  for (const auto& [id, s] : stated)
    if (s.ofSeveral())
      out.findings.push_back({"patient-id-of-several-people",
                              Severity::Warning,
                              "One Patient ID stands with several birth dates or sexes; these are listed as "
                              "different patients and not compared with each other.",
                              {{"birth_dates", static_cast<double>(s.birthDates.size())},
                               {"sexes", static_cast<double>(s.sexes.size())}}});
  return out;
}

namespace {
struct Verdict {
  bool conflict = false;  // values or geometry differ, or could not be compared
  bool geometryDiffers = false;
  std::optional<bool> same = true;
};

Verdict compareAll(const std::vector<Record>& records, const std::vector<std::size_t>& group,
                   const SameValues& sameValues) {
  Verdict v;
  for (std::size_t i = 1; i < group.size(); ++i) {
    if (!sameGeometry(records[group[0]], records[group[i]])) v.geometryDiffers = true;
    const auto same = sameValues(group[0], group[i]);
    if (same == false)
      v.same = false;
    else if (!same && v.same != false)
      v.same = std::nullopt;
  }
  v.conflict = v.geometryDiffers || v.same != true;
  return v;
}
}  // namespace

std::vector<Finding> settleIdentity(std::vector<Record>& records, const SameValues& sameValues,
                                    const std::function<std::string(std::size_t)>& fileName) {
  std::map<std::string, std::vector<std::size_t>> byUid;
  for (std::size_t n = 0; n < records.size(); ++n)
    if (!records[n].instance.sopInstanceUid.empty()) byUid[records[n].instance.sopInstanceUid].push_back(n);
  std::vector<Finding> findings;
  for (const auto& [uid, group] : byUid) {
    if (group.size() < 2) continue;
    const Verdict v = compareAll(records, group, sameValues);
    for (std::size_t i = 0; i < group.size(); ++i)
      records[group[i]].instance.identity = v.conflict ? Identity::Conflict
                                            : i == 0   ? Identity::Kept
                                                       : Identity::Repeated;
    Finding f;
    f.code = "repeated-sop-instance-uid";
    const std::string n = std::to_string(group.size());
    if (!v.conflict) {
      f.sentence = n + " files are one object with equal values; the first is used.";
    } else {
      f.severity = Severity::Warning;
      f.sentence = n + " files claim to be one object, but their " +
                   (v.geometryDiffers ? "positions differ"
                    : v.same == false ? "values differ"
                                      : "values could not be compared") +
                   "; each can be viewed, none is used in a volume.";
    }
    std::vector<std::string> files;
    for (const std::size_t i : group) files.push_back(fileName(i));
    f.numbers["files"] = files;
    f.numbers["stored_values_identical"] = std::string(!v.same ? "not computed" : *v.same ? "yes" : "no");
    f.numbers["geometry_identical"] = std::string(v.geometryDiffers ? "no" : "yes");
    findings.push_back(std::move(f));
  }
  return findings;
}

}  // namespace vernier
