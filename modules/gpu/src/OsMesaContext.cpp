// SPDX-License-Identifier: GPL-3.0-or-later
// OSMesa's few entry points are declared here and looked up with dlsym: no header and no library of Mesa is
// needed to build or to start Vernier.
#include <dlfcn.h>

#include <array>
#include <vector>

#include "GlContext.h"
#include "vernier/base/Threads.h"

namespace vernier::gpu {
namespace {

// Values from OSMesa's published interface and from the GL registry.
constexpr int kFormat = 0x22, kDepthBits = 0x30, kStencilBits = 0x31, kProfile = 0x33, kCoreProfile = 0x34;
constexpr int kMajor = 0x36, kMinor = 0x37;
constexpr int kRgba = 0x1908;
constexpr unsigned kUnsignedByte = 0x1401;

using Handle = struct osmesa_context*;
using CreateFn = Handle (*)(const int* attributes, Handle share);
using DestroyFn = void (*)(Handle);
using MakeCurrentFn = unsigned char (*)(Handle, void* buffer, unsigned type, int width, int height);
using GetProcFn = GlContext::Proc (*)(const char*);

struct Entries {
  CreateFn create = nullptr;
  DestroyFn destroy = nullptr;
  MakeCurrentFn makeCurrent = nullptr;
  GetProcFn getProc = nullptr;
};

Error unavailable(const std::string& why) {
  return makeError(ErrorCode::GlUnavailable, "OpenGL is not available: " + why, "OSMesa");
}

// The library stays loaded: its worker threads and LLVM's statics do not survive dlclose.
Result<Entries> load(const std::string& library) {
  std::vector<std::string> names{library};
  if (library.empty()) names = {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"};
  void* lib = nullptr;
  for (const std::string& name : names) {
    lib = dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (lib) break;
  }
  if (!lib)
    return unavailable(
        "the OSMesa library cannot be loaded; install libosmesa6 to draw with GL, or use the native engine.");
  Entries e;
  e.create = reinterpret_cast<CreateFn>(dlsym(lib, "OSMesaCreateContextAttribs"));
  e.destroy = reinterpret_cast<DestroyFn>(dlsym(lib, "OSMesaDestroyContext"));
  e.makeCurrent = reinterpret_cast<MakeCurrentFn>(dlsym(lib, "OSMesaMakeCurrent"));
  e.getProc = reinterpret_cast<GetProcFn>(dlsym(lib, "OSMesaGetProcAddress"));
  if (!e.create || !e.destroy || !e.makeCurrent || !e.getProc)
    return unavailable(
        "the OSMesa library is too old (it lacks OSMesaCreateContextAttribs); Mesa 12 or later is needed.");
  return e;
}

class OsMesaContext final : public GlContext {
 public:
  OsMesaContext(const Entries& entries, Handle handle) : entries_(entries), handle_(handle) {}
  ~OsMesaContext() override { entries_.destroy(handle_); }
  Result<void> makeCurrent() override {
    // OSMesa wants a window of its own; we draw into framebuffers only, so the smallest one will do.
    if (!entries_.makeCurrent(handle_, window_.data(), kUnsignedByte, 4, 4))
      return unavailable("OSMesa could not make its context current.");
    return {};
  }
  void release() override { entries_.makeCurrent(nullptr, nullptr, 0, 0, 0); }
  Proc proc(const char* name) const override { return entries_.getProc(name); }

 private:
  Entries entries_;
  Handle handle_;
  std::array<unsigned char, 4 * 4 * 4> window_{};
};

}  // namespace

Result<std::unique_ptr<GlContext>> makeOsMesaContext(const std::string& library) {
  Result<Entries> entries = load(library);
  if (!entries) return entries.error();
  setThreads(threads());  // LP_NUM_THREADS is read when the context is made
  const std::array<int, 13> attributes{
      kFormat, kRgba, kDepthBits, 0, kStencilBits, 0, kProfile, kCoreProfile, kMajor, 3, kMinor, 3, 0};
  const Handle handle = entries->create(attributes.data(), nullptr);
  if (!handle) return unavailable("this OSMesa cannot make an OpenGL 3.3 core context.");
  return std::unique_ptr<GlContext>(std::make_unique<OsMesaContext>(*entries, handle));
}

}  // namespace vernier::gpu
