// SPDX-License-Identifier: GPL-3.0-or-later
// What a report of quality assurance is about: which program, which machine, which driver.
#include <dlfcn.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <clocale>
#include <ctime>
#include <filesystem>
#include <fstream>

#include "PluginCard.h"
#include "QaDocument.h"
#include "Version.h"
#include "vernier/measure/Libraries.h"

namespace vernier::app {
namespace {

// The value after `key` and `by` in a text file of the system; "" when it is not there.
std::string valueIn(const char* file, const std::string& key, char by) {
  std::ifstream f(file);
  for (std::string line; std::getline(f, line);)
    if (line.starts_with(key)) {
      std::string v = line.substr(std::min(line.find(by), line.size() - 1) + 1);
      const auto edge = [](char c) { return c == ' ' || c == '"' || c == '\t'; };
      while (!v.empty() && edge(v.front())) v.erase(v.begin());
      while (!v.empty() && edge(v.back())) v.pop_back();
      return v;
    }
  return {};
}

std::string shaOrUnknown(const std::string& path) {
  const Result<std::string> sha = sha256OfPath(path);
  return sha ? *sha : "unknown";
}

// The library that holds the engines; "" in a build that links it statically.
std::string coreLibrary() {
  Dl_info info{};
  const auto address = reinterpret_cast<const void*>(&measure::imageLibrary);
  return ::dladdr(address, &info) && info.dli_fname ? info.dli_fname : "";
}

QaJson programFacts() {
  QaJson j = {{"version", kVersion}, {"sha256", shaOrUnknown("/proc/self/exe")}};
  if (const std::string core = coreLibrary(); !core.empty())
    j["library"] = {{"name", std::filesystem::path(core).filename().string()},
                    {"sha256", shaOrUnknown(core)}};
  j["image_library"] = measure::imageLibrary();
  return j;
}

QaJson machineFacts(Session& session) {
  utsname u{};
  ::uname(&u);
  char host[256] = {};
  ::gethostname(host, sizeof host - 1);
  return {{"name", host},
          {"system", valueIn("/etc/os-release", "PRETTY_NAME", '=')},
          {"kernel", std::string(u.sysname) + " " + u.release + " " + u.machine},
          {"processor", valueIn("/proc/cpuinfo", "model name", ':')},
          {"cores", ::sysconf(_SC_NPROCESSORS_ONLN)},
          {"memory_mb", ::sysconf(_SC_PHYS_PAGES) / 1024 * ::sysconf(_SC_PAGESIZE) / 1024},
          {"threads", session.threadCount()},
          {"locale", std::setlocale(LC_ALL, nullptr)}};
}

QaJson pluginFacts(const Session& session) {
  QaJson list = QaJson::array();
  for (const PluginInfo& p : session.plugins()) {
    QaJson j = {{"name", p.name}, {"version", p.version}, {"state", nameOf(p.state)}};
    if (const Result<PluginCard> card = readPluginCard(p.folder + "/plugin.json"))
      j["sha256"] = shaOrUnknown(p.folder + "/" + card->library);
    else
      j["sha256"] = "unknown";
    list.push_back(j);
  }
  return list;
}

}  // namespace

std::string utcNow() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

QaJson qaIdentity(Session& session, bool gl, const std::string& operatorName) {
  const Capabilities& c = session.capabilities(gl);
  QaJson j;
  j["program"] = programFacts();
  j["plugins"] = pluginFacts(session);
  j["machine"] = machineFacts(session);
  j["native"] = {{"simd", c.simd}};
  j["gl"] = !gl ? QaJson("not asked for")
            : c.gl
                ? QaJson{{"renderer", c.glRenderer}, {"version", c.glVersion}, {"software", c.glIsSoftware}}
                : QaJson("not available: " + c.glWhyNot);
  j["operator"] = operatorName;
  return j;
}

}  // namespace vernier::app
