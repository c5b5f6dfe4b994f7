// SPDX-License-Identifier: GPL-3.0-or-later
#include "QaRun.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "OptionText.h"
#include "Sha256.h"
#include "vernier/base/Guarded.h"
#include "vernier/phantoms/Phantoms.h"
#include "vernier/picture/Compare.h"
#include "vernier/picture/Png.h"
#include "vernier/picture/Quantise.h"

namespace vernier::app {
namespace {
namespace fs = std::filesystem;

// A private folder that is gone at the end.
class WorkFolder {
 public:
  WorkFolder() {
    std::error_code ec;
    std::string name = (fs::temp_directory_path(ec) / "vernier-qa-XXXXXX").string();
    if (!ec && ::mkdtemp(name.data())) path_ = name;
  }
  ~WorkFolder() {
    std::error_code ec;
    if (!path_.empty()) fs::remove_all(path_, ec);
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

bool asksFor(const QaCase& c, const char* kind) {
  return std::any_of(c.checks.begin(), c.checks.end(),
                     [&](const auto& check) { return check.value("kind", "") == kind; });
}

// CLI11 reads a case's options as it reads those of `vernier render`.
Result<ViewOptions> viewOptionsOf(const QaCase& c, const std::vector<std::string>& inputs,
                                  const std::vector<std::string>& surfaces) {
  ViewOptions o;
  CLI::App app;
  addViewOptions(app, o);
  std::vector<std::string> args(inputs.rbegin(), inputs.rend());  // CLI11 takes them from the back
  args.push_back("--");
  args.insert(args.end(), c.options.rbegin(), c.options.rend());
  try {
    app.parse(args);
  } catch (const CLI::ParseError& e) {
    return makeError(ErrorCode::FileDamaged,
                     std::string(e.what()) + "; options are those of `vernier render`.",
                     c.name + "/case.json#/options");
  }
  o.view = c.view, o.series = c.series, o.surfaces = surfaces;
  o.size = std::to_string(c.width_px) + "x" + std::to_string(c.height_px);
  if (!c.sceneText.empty()) o.sceneText = c.sceneText, o.sceneFile = c.folder + "/case.json";
  return o;
}

Error located(Error e, const std::string& name) {
  if (e.where.empty() || fs::path(e.where).is_absolute()) e.where = name;  // no path of this machine
  return e;
}

}  // namespace

const char* nameOf(QaVerdict v) {
  return v == QaVerdict::Pass ? "pass" : v == QaVerdict::Fail ? "fail" : "error";
}

Result<std::string> sha256OfPath(const std::string& path) {
  std::error_code ec;
  std::vector<fs::path> files;
  const bool folder = fs::is_directory(path, ec);
  if (folder) {
    for (fs::recursive_directory_iterator it(path, ec), end; !ec && it != end; it.increment(ec))
      if (it->is_regular_file(ec)) files.push_back(it->path());
    std::sort(files.begin(), files.end());
  } else if (fs::is_regular_file(path, ec)) {
    files = {path};
  }
  if (ec || files.empty())
    return makeError(ErrorCode::FileNotFound, "The data is not there, or holds no file.");
  Sha256 hash;
  std::vector<char> buffer(1 << 16);
  for (const fs::path& file : files) {
    if (folder) {
      const std::string name = file.lexically_relative(path).generic_string();
      hash.add(name.c_str(), name.size() + 1);
    }
    std::ifstream f(file, std::ios::binary);
    if (!f) return makeError(ErrorCode::FileNotFound, "A file of the data cannot be read.");
    while (f.read(buffer.data(), static_cast<std::streamsize>(buffer.size())) || f.gcount() > 0)
      hash.add(buffer.data(), static_cast<std::size_t>(f.gcount()));
  }
  return hash.hex();
}

struct QaRunner::Impl {
  Settings settings;
  NewSession newSession;
  std::stop_token stop;
  WorkFolder work;
  struct Ready {
    std::string path, sha256;
  };
  std::map<std::pair<std::string, QaData>, Ready> ready;  // phantoms written, files hashed
  std::unique_ptr<Session> session;
  std::vector<std::string> open;  // what the session has open
  int folders = 0;

  // A case as it can be drawn.
  struct Prepared {
    std::vector<std::string> inputs;
    std::string dataSha256;
    std::optional<RenderRequest> request;
  };

  std::string newFolder() { return work.path() + "/" + std::to_string(++folders); }
  Result<Ready> dataOf(const QaCase&, const QaData&);
  Result<void> openInSession(const std::vector<std::string>& inputs, bool afresh);
  Result<Prepared> prepare(const QaCase&);
  Result<Rendered> drawn(const QaCase&, RenderRequest&, const std::string& engine);
  Result<void> judged(const QaCase&, Prepared&, QaCaseResult&, QaEngineResult&);
};

Result<QaRunner::Impl::Ready> QaRunner::Impl::dataOf(const QaCase& c, const QaData& d) {
  if (work.path().empty())
    return makeError(ErrorCode::WriteFailed,
                     "No temporary folder can be made; set TMPDIR to one that can be "
                     "written.");
  const auto key = std::pair(d.path.empty() ? std::string() : c.folder, d);
  if (const auto found = ready.find(key); found != ready.end()) return found->second;
  Ready r;
  if (!d.recipe.empty()) {
    PhantomOptions options;
    options.settings = d.settings;
    options.stop = stop;
    const Result<PhantomInfo> written = writePhantom(d.recipe, newFolder(), options);
    if (!written) return written.error();
    r.path = written->data.string();
  } else {
    r.path = (fs::path(c.folder) / d.path).string();
  }
  const Result<std::string> sha = sha256OfPath(r.path);
  const std::string name = d.recipe.empty() ? d.path : d.recipe;
  if (!sha) return makeError(sha.error().code, sha.error().sentence, c.name + ": " + name);
  if (!d.sha256.empty() && d.sha256 != *sha)
    return makeError(ErrorCode::FileDamaged,
                     "The data is not what the case was made for: its hash is " + *sha + ".",
                     c.name + ": " + name);
  r.sha256 = *sha;
  return ready[key] = r;
}

Result<void> QaRunner::Impl::openInSession(const std::vector<std::string>& inputs, bool afresh) {
  if (session && !afresh && open == inputs) return {};
  session.reset();  // its volumes and its GL device go before the next one's come
  open.clear();
  session = newSession();
  if (!session) return makeError(ErrorCode::Internal, "No session could be made.");
  if (inputs.empty()) return {};
  const Result<void> r = session->open(inputs, {}, stop);
  if (r) open = inputs;
  return r;
}

Result<QaRunner::Impl::Prepared> QaRunner::Impl::prepare(const QaCase& c) {
  Prepared p;
  std::vector<std::string> surfaces;
  Sha256 all;
  const auto take = [&](const QaData& d, std::vector<std::string>& into) -> Result<void> {
    const Result<Ready> r = dataOf(c, d);
    if (!r) return r.error();
    into.push_back(r->path);
    all.add(r->sha256.data(), r->sha256.size());
    p.dataSha256 = r->sha256;
    return {};
  };
  if (c.data)
    if (const Result<void> r = take(*c.data, p.inputs); !r) return r.error();
  for (const QaData& d : c.surfaces)
    if (const Result<void> r = take(d, c.data ? surfaces : p.inputs); !r) return r.error();
  if (p.inputs.size() + surfaces.size() > 1) p.dataSha256 = all.hex();
  if (const Result<void> r = openInSession(p.inputs, !c.surfaces.empty()); !r) return r.error();
  if (c.draws()) {
    const Result<ViewOptions> options = viewOptionsOf(c, p.inputs, surfaces);
    if (!options) return options.error();
    Result<RenderRequest> request = makeRequest(*session, *options, settings, {}, stop);
    if (!request) return request.error();
    request->options.measure = asksFor(c, "error");
    request->view.wantValues = asksFor(c, "value");
    p.request = std::move(*request);
  } else if (c.data) {
    const Result<StackChoice> choice = session->choose(c.series);
    if (!choice) return choice.error();
    session->use(*choice);
  }
  return p;
}

Result<Rendered> QaRunner::Impl::drawn(const QaCase& c, RenderRequest& request, const std::string& engine) {
  request.quality.engine = engine == "gl" ? EngineChoice::Gl : EngineChoice::Native;
  Result<Rendered> r = session->render(request.scene, request.view, request.quality, request.options, stop);
  if (r && r->frame.engine != engine)
    return makeError(ErrorCode::NoTechnique,
                     "The picture was drawn by " + r->frame.engine + ", not by " + engine + ".", c.name);
  return r;
}

Result<void> QaRunner::Impl::judged(const QaCase& c, Prepared& p, QaCaseResult& result, QaEngineResult& e) {
  std::optional<Rendered> rendered;
  if (p.request) {
    Result<Rendered> r = drawn(c, *p.request, e.engine);
    if (!r) return r.error();
    rendered = std::move(*r);
    e.renderer = rendered->frame.renderer, e.technique = rendered->frame.technique;
    e.picture = quantise(rendered->frame.images);
  }
  const QaContext context{c,
                          e.engine,
                          *session,
                          p.request ? &*p.request : nullptr,
                          rendered ? &*rendered : nullptr,
                          e.picture ? &*e.picture : nullptr,
                          p.inputs,
                          newFolder(),
                          [&](const QaData& d) -> Result<std::string> {
                            const Result<Ready> r = dataOf(c, d);
                            if (!r) return r.error();
                            return r->path;
                          },
                          newSession};
  std::error_code ec;
  fs::create_directories(context.workFolder, ec);
  Result<std::vector<QaRow>> rows = runQaChecks(context);
  if (!rows) return rows.error();
  e.rows = std::move(*rows);
  const std::optional<QaTolerance>& tolerance = c.toleranceOf(e.engine);
  if (!tolerance) return {};
  if (!result.expected) {
    QaRow row = equalText("baseline", "missing", "expected.png");
    row.why = "look at the picture, then `vernier qa accept`";
    e.rows.push_back(row);
    return {};
  }
  const std::vector<QaRow> picture = judgePicture(*result.expected, *e.picture, *tolerance);
  e.rows.insert(e.rows.end(), picture.begin(), picture.end());
  if (Result<Picture> heat = heatmap(*result.expected, *e.picture)) e.heat = std::move(*heat);
  if (const auto histogram = differenceHistogram(*result.expected, *e.picture)) e.histogram = *histogram;
  result.caught.clear();
  // A baseline that proves nothing fails the case, whatever it looks like.
  if (const Result<void> fit = guardBaseline(c, *result.expected, *tolerance, &result.caught); !fit)
    e.error = fit.error();
  return {};
}

QaRunner::QaRunner(Settings settings, NewSession newSession, std::stop_token stop)
    : impl_(std::make_unique<Impl>()) {
  impl_->settings = std::move(settings), impl_->newSession = std::move(newSession),
  impl_->stop = std::move(stop);
}
QaRunner::~QaRunner() = default;

QaCaseResult QaRunner::run(const std::string& folder, const std::string& name,
                           const std::vector<std::string>& engines) {
  QaCaseResult result;
  result.name = name;
  const auto failAll = [&](const Error& e) {
    result.engines.clear();
    for (const std::string& engine : engines) {
      QaEngineResult& r = result.engines.emplace_back();
      r.engine = engine, r.error = located(e, name);
    }
    return result;
  };
  Result<QaCase> c = readQaCase(folder, name);
  if (!c) return failAll(c.error());
  result.qaCase = *c;
  if (const auto sha = sha256OfPath(folder + "/case.json")) result.caseSha256 = *sha;
  std::error_code ec;
  if (c->tolerance && fs::exists(c->expectedFile(), ec)) {
    Result<Picture> expected = readPng(c->expectedFile());
    if (!expected)
      return failAll(makeError(expected.error().code, expected.error().sentence, name + "/expected.png"));
    result.expected = std::move(*expected);
    if (const auto sha = sha256OfPath(c->expectedFile())) result.expectedSha256 = *sha;
  }
  Result<Impl::Prepared> prepared =
      guarded(name, [&]() -> Result<Impl::Prepared> { return impl_->prepare(*c); });
  if (!prepared) return failAll(prepared.error());
  result.dataSha256 = prepared->dataSha256;
  for (const std::string& engine : engines) {
    if (std::find(c->engines.begin(), c->engines.end(), engine) == c->engines.end()) continue;
    QaEngineResult& e = result.engines.emplace_back();
    e.engine = engine;
    const Result<void> done =
        guarded(name, [&]() -> Result<void> { return impl_->judged(*c, *prepared, result, e); });
    const bool allPass = std::all_of(e.rows.begin(), e.rows.end(), [](const QaRow& r) { return r.pass; });
    e.verdict = !done ? QaVerdict::Error : allPass && !e.error ? QaVerdict::Pass : QaVerdict::Fail;
    if (!done) e.error = located(done.error(), name);
  }
  if (result.engines.empty())
    return failAll(makeError(ErrorCode::NoTechnique,
                             "The case is meant for " + c->engines.front() +
                                 " only, which was not asked for; run it with --engine both.",
                             name));
  return result;
}

Result<Picture> QaRunner::draw(const QaCase& c, const std::string& engine) {
  return guarded(c.name, [&]() -> Result<Picture> {
    if (!c.draws()) return makeError(ErrorCode::OptionInvalid, "The case draws no picture.", c.name);
    Result<Impl::Prepared> p = impl_->prepare(c);
    if (!p) return located(p.error(), c.name);
    const Result<Rendered> r = impl_->drawn(c, *p->request, engine);
    if (!r) return located(r.error(), c.name);
    return quantise(r->frame.images);
  });
}

}  // namespace vernier::app
