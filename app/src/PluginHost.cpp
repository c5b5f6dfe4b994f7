// SPDX-License-Identifier: GPL-3.0-or-later
#include "PluginHost.h"

#include <dlfcn.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <set>

#include "InstallPlace.h"
#include "PluginCard.h"
#include "vernier/base/Log.h"
#include "vernier/plan/Plugin.h"

namespace vernier::app {
namespace fs = std::filesystem;

const char* nameOf(PluginState s) {
  switch (s) {
    case PluginState::Loaded:
      return "loaded";
    case PluginState::CardDamaged:
      return "card damaged";
    case PluginState::LibraryMissing:
      return "library missing";
    case PluginState::WritableByOthers:
      return "writable by others";
    case PluginState::LoadFailed:
      return "load failed";
    case PluginState::NotAPlugin:
      return "not a plugin";
    case PluginState::OtherAbi:
      return "other ABI";
    case PluginState::OtherInterface:
      return "other interface";
    case PluginState::MissingDependency:
      return "missing dependency";
    case PluginState::Duplicate:
      return "duplicate";
    case PluginState::RegisterFailed:
      return "register failed";
    case PluginState::Failed:
      return "failed";
  }
  return "?";
}

namespace {

// What a plugin registers is gathered here first; only a whole registration reaches the registry. It lives as
// long as the plugin host: techniques keep a reference to it for the GL device.
class Gathering final : public Host {
 public:
  Gathering(const std::function<Result<gpu::Device*>()>& glDevice, DerivedCache* derived)
      : glDevice_(glDevice), derived_(derived) {}
  Result<void> addTechnique(Technique t) override {
    if (t.name.empty() || t.kinds.empty() || !t.passesFor || !t.execute)
      return makeError(ErrorCode::PluginFailed, "A technique without name, kinds, passesFor or execute.",
                       t.name);
    techniques.push_back(std::move(t));
    return {};
  }
  Result<void> addPanel(Panel p) override {
    if (Result<void> r = checkPanel(p); !r) return r;
    panels.push_back(std::move(p));
    return {};
  }
  Result<gpu::Device*> glDevice() override { return glDevice_(); }
  DerivedCache& derivedData() override { return derived_ ? *derived_ : Host::derivedData(); }
  std::vector<Technique> techniques;
  std::vector<Panel> panels;

 private:
  std::function<Result<gpu::Device*>()> glDevice_;
  DerivedCache* derived_;
};

}  // namespace

struct PluginHost::Impl {
  std::function<Result<gpu::Device*>()> glDevice;
  DerivedCache* derived = nullptr;
  std::vector<std::unique_ptr<Gathering>> hosts;
  // A plugin may be switched off by its own techniques while they run, so its info has a fixed address.
  std::vector<std::unique_ptr<PluginInfo>> infos;
  mutable std::vector<PluginInfo> listed;
  TechniqueRegistry registry;

  struct Candidate {
    PluginInfo* info;
    PluginCard card;
    std::string libraryPath;
  };
  void finish(const Candidate&);
  // "" when none of what was registered exists already.
  std::string existing(const Gathering&) const;
  const Panel* panelOf(const std::string& kind) const;
  bool isLoaded(const std::string& name) const {
    return std::any_of(infos.begin(), infos.end(),
                       [&](const auto& i) { return i->name == name && i->state == PluginState::Loaded; });
  }
};

namespace {

// Empty, or why the path must not be trusted.
std::string distrust(const std::string& path) {
  struct stat s {};
  if (::stat(path.c_str(), &s) != 0) return "it cannot be read";
  if (s.st_mode & S_IWOTH) return "other users may write it";
  // A group of one's own (user private groups) or root's is no stranger.
  if ((s.st_mode & S_IWGRP) && s.st_gid != 0 && s.st_gid != ::getegid()) return "another group may write it";
  if (s.st_uid != 0 && s.st_uid != ::geteuid()) return "it belongs to another user";
  return {};
}

void refuse(PluginInfo& info, PluginState state, std::string reason) {
  info.state = state;
  info.reason = std::move(reason);
  log(LogLevel::Info, "plugins", info.name + ": " + nameOf(state));
}

// An exception in a technique becomes an error, and its plugin is switched off.
Technique wrapped(Technique t, PluginInfo* owner) {
  const auto failed = [owner, name = t.name](const Error& e) {
    owner->state = PluginState::Failed;
    owner->reason = "Technique " + name + " threw: " + e.sentence;
    return makeError(ErrorCode::PluginFailed,
                     "Plugin " + owner->name + " failed and is switched off: " + e.sentence, name);
  };
  const auto off = [owner, name = t.name] {
    return makeError(ErrorCode::PluginFailed, "Plugin " + owner->name + " is switched off.", name);
  };
  auto passesFor = std::move(t.passesFor);
  t.passesFor = [=](const Layer& layer, std::size_t index,
                    const PlanContext& context) -> Result<std::vector<Pass>> {
    if (owner->state == PluginState::Failed) return off();
    try {
      return passesFor(layer, index, context);
    } catch (...) {
      return failed(errorFromCurrentException(owner->name));
    }
  };
  if (auto truth = std::move(t.truth)) {
    t.truth = [=](const Layer& layer, std::size_t index, const PlanContext& context) -> Result<PixelTruth> {
      Result<PixelTruth> made = guarded(owner->name, [&] { return truth(layer, index, context); });
      if (!made) return made.error();
      // On many threads at once: what throws is told as a pixel without a colour, which counts as wholly
      // wrong.
      return PixelTruth([at = std::move(*made)](glm::dvec2 pixel, glm::dvec4 under) {
        try {
          return at(pixel, under);
        } catch (...) {
          return glm::dvec4(std::numeric_limits<double>::quiet_NaN());
        }
      });
    };
  }
  auto execute = std::move(t.execute);
  t.execute = [=](const Pass& pass, Images& images, std::stop_token stop) -> Result<void> {
    if (owner->state == PluginState::Failed) return off();
    try {
      return execute(pass, images, stop);
    } catch (const std::bad_alloc&) {
      return makeError(ErrorCode::OutOfMemory, "The memory for this pass could not be had.", pass.name);
    } catch (...) {
      return failed(errorFromCurrentException(owner->name));
    }
  };
  return t;
}

}  // namespace

PluginHost::PluginHost(std::function<Result<gpu::Device*>()> glDevice, DerivedCache* derived)
    : impl_(std::make_unique<Impl>()) {
  impl_->glDevice = std::move(glDevice);
  impl_->derived = derived;
}
PluginHost::~PluginHost() = default;

void PluginHost::load(const std::vector<std::string>& folders) {
  std::vector<Impl::Candidate> waiting;
  for (const std::string& root : folders) {
    std::error_code ec;
    std::vector<fs::path> found;
    for (const auto& entry : fs::directory_iterator(root, ec))
      if (entry.is_directory(ec)) found.push_back(entry.path());
    std::sort(found.begin(), found.end());
    for (const fs::path& folder : found) {
      PluginInfo& info = *impl_->infos.emplace_back(std::make_unique<PluginInfo>());
      info.name = folder.filename().string();
      info.folder = folder.string();
      const std::string cardPath = (folder / "plugin.json").string();
      auto card = guarded("plugin.json", [&] { return readPluginCard(cardPath); });
      if (!card) {
        refuse(info, PluginState::CardDamaged, card.error().sentence);
        continue;
      }
      info.name = card->name, info.version = card->version, info.description = card->description;
      info.kinds = card->kinds, info.views = card->views, info.needs = card->needs;
      const std::string library = (folder / card->library).string();
      if (!fs::is_regular_file(library, ec)) {
        refuse(info, PluginState::LibraryMissing,
               "The card names " + card->library + ", which is not there.");
        continue;
      }
      std::string why;
      for (const std::string& p : {root, info.folder, cardPath, library})
        if (why.empty()) {
          why = distrust(p);
          if (!why.empty()) why = fs::path(p).filename().string() + ": " + why;
        }
      if (!why.empty()) {
        refuse(info, PluginState::WritableByOthers, "Not loaded, since " + why + ".");
        continue;
      }
      waiting.push_back({&info, *card, library});
    }
  }
  // Dependencies first: whatever has all it needs is loaded, until nothing moves.
  for (bool moved = true; moved;) {
    moved = false;
    for (auto it = waiting.begin(); it != waiting.end();) {
      const bool ready = std::all_of(it->card.needs.begin(), it->card.needs.end(),
                                     [&](const std::string& n) { return impl_->isLoaded(n); });
      if (!ready) {
        ++it;
        continue;
      }
      impl_->finish(*it);
      it = waiting.erase(it);
      moved = true;
    }
  }
  for (const Impl::Candidate& c : waiting) {
    std::string missing;
    for (const std::string& n : c.card.needs)
      if (!impl_->isLoaded(n)) missing += (missing.empty() ? "" : ", ") + n;
    refuse(*c.info, PluginState::MissingDependency, "It needs " + missing + ", which is not loaded.");
  }
}

std::string PluginHost::Impl::existing(const Gathering& g) const {
  std::set<std::string> names, kinds;
  for (const Technique& t : g.techniques)
    if (registry.find(t.name) || !names.insert(t.name).second) return "Technique " + t.name;
  for (const Panel& p : g.panels)
    if (panelOf(p.kind) || !kinds.insert(p.kind).second) return "A panel for " + p.kind;
  return "";
}

const Panel* PluginHost::Impl::panelOf(const std::string& kind) const {
  for (const auto& i : infos)
    for (const Panel& p : i->panels)
      if (p.kind == kind && i->state == PluginState::Loaded) return &p;
  return nullptr;
}

void PluginHost::Impl::finish(const Candidate& c) {
  PluginInfo& info = *c.info;
  if (isLoaded(info.name))
    return refuse(info, PluginState::Duplicate, "A plugin of this name is loaded already.");
  if (c.card.interface != kPluginInterface)
    return refuse(
        info, PluginState::OtherInterface,
        "Its card says interface " + c.card.interface + "; this program speaks " + kPluginInterface + ".");
  void* handle = ::dlopen(c.libraryPath.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!handle) {
    const char* why = ::dlerror();
    return refuse(info, PluginState::LoadFailed,
                  std::string("The dynamic linker says: ") + (why ? why : "?"));
  }
  const auto abi = reinterpret_cast<PluginTextFn>(::dlsym(handle, "vernier_plugin_abi"));
  const auto interface = reinterpret_cast<PluginTextFn>(::dlsym(handle, "vernier_plugin_interface"));
  const auto registerFn = reinterpret_cast<PluginRegisterFn>(::dlsym(handle, "vernier_plugin_register"));
  if (!abi || !interface || !registerFn)
    return refuse(info, PluginState::NotAPlugin,
                  "The library lacks one of the three vernier_plugin_ entries.");
  if (std::string(abi()) != VERNIER_ABI_ID)
    return refuse(info, PluginState::OtherAbi,
                  "It was built with another compiler, in another way or against other headers; rebuild it.");
  if (std::string(interface()) != kPluginInterface)
    return refuse(info, PluginState::OtherInterface,
                  std::string("It speaks interface ") + interface() + "; this program speaks " +
                      kPluginInterface + ".");
  auto gathering = std::make_unique<Gathering>(glDevice, derived);
  Error error;
  bool registered = false;
  const Result<void> run = guarded(info.name, [&]() -> Result<void> {
    registered = registerFn(gathering.get(), &error);
    return {};
  });
  if (!run) error = run.error();
  if (!registered || !run)
    return refuse(info, PluginState::RegisterFailed, "Its register() failed: " + error.sentence);
  if (const std::string what = existing(*gathering); !what.empty())
    return refuse(info, PluginState::Duplicate, what + " is registered already.");
  for (Technique& t : gathering->techniques) {
    info.techniques.push_back(t.name);
    const Result<void> added = registry.add(wrapped(std::move(t), &info));
    VERNIER_ASSERT(added.ok());  // the only refusal is a duplicate name, which was looked for above
  }
  gathering->techniques.clear();
  info.panels = std::move(gathering->panels);
  hosts.push_back(std::move(gathering));
  info.state = PluginState::Loaded;
}

const std::vector<PluginInfo>& PluginHost::plugins() const {
  impl_->listed.clear();
  for (const auto& i : impl_->infos) impl_->listed.push_back(*i);
  return impl_->listed;
}
const TechniqueRegistry& PluginHost::techniques() const { return impl_->registry; }

const Panel* PluginHost::panelOf(const std::string& kind) const { return impl_->panelOf(kind); }

std::string PluginHost::installFolder() { return installPrefix() + "/lib/vernier/plugins"; }

}  // namespace vernier::app
