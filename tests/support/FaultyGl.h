// SPDX-License-Identifier: GPL-3.0-or-later
// OSMesa with faults put in between: a driver that is smaller, poorer or dies on the way. The faults are
// global, since GL functions carry no user data; one test uses them at a time.
#pragma once
#include <functional>
#include <memory>
#include <string>

#include "GlContext.h"
#include "vernier/gpu/Device.h"

namespace vernier::test {

struct GlFaults {
  int max2d = 0, max3d = -1;    // what the driver says of itself; 0 and -1: the truth
  bool floatImages = true;      // false: no float framebuffer is complete
  bool room = true;             // false: no texture above 64 KiB finds room
  int loseAtDraw = 0;           // the n-th draw from now loses the context; 0: none
  std::string renderer;         // "": the truth
  bool lost = false;            // of the current context
  int contexts = 0, draws = 0;  // made and done so far
};
inline GlFaults& glFaults() {
  static GlFaults faults;
  return faults;
}

namespace faulty {

struct Real {
  unsigned (*getError)() = nullptr;
  unsigned (*checkFramebufferStatus)(unsigned) = nullptr;
  void (*drawArrays)(unsigned, int, int) = nullptr;
  void (*getIntegerv)(unsigned, int*) = nullptr;
  const unsigned char* (*getString)(unsigned) = nullptr;
  void (*getTexLevelParameteriv)(unsigned, int, unsigned, int*) = nullptr;
};
inline Real& real() {
  static Real r;
  return r;
}

inline unsigned getError() { return glFaults().lost ? 0x0507u : real().getError(); }
inline unsigned checkFramebufferStatus(unsigned target) {
  return glFaults().floatImages ? real().checkFramebufferStatus(target) : 0x8CDDu;  // unsupported
}
inline void drawArrays(unsigned mode, int first, int count) {
  GlFaults& f = glFaults();
  ++f.draws;
  if (f.loseAtDraw > 0 && --f.loseAtDraw == 0) f.lost = true;
  if (!f.lost) real().drawArrays(mode, first, count);
}
inline void getIntegerv(unsigned what, int* value) {
  real().getIntegerv(what, value);
  if (what == 0x0D33 && glFaults().max2d > 0) *value = glFaults().max2d;
  if (what == 0x8073 && glFaults().max3d >= 0) *value = glFaults().max3d;
}
inline const unsigned char* getString(unsigned what) {
  const std::string& renderer = glFaults().renderer;
  if (what == 0x1F01 && !renderer.empty()) return reinterpret_cast<const unsigned char*>(renderer.c_str());
  return real().getString(what);
}
// A proxy texture of width 0: no room.
inline void getTexLevelParameteriv(unsigned target, int level, unsigned what, int* value) {
  real().getTexLevelParameteriv(target, level, what, value);
  if (glFaults().room) return;
  int height = 1, depth = 1;
  real().getTexLevelParameteriv(target, level, 0x1001, &height);
  real().getTexLevelParameteriv(target, level, 0x8071, &depth);
  if (static_cast<long>(*value) * height * depth > 16 * 1024) *value = 0;
}

class Context final : public gpu::GlContext {
 public:
  explicit Context(std::unique_ptr<gpu::GlContext> real) : real_(std::move(real)) {
    ++glFaults().contexts;
    glFaults().lost = false;
  }
  Result<void> makeCurrent() override { return real_->makeCurrent(); }
  void release() override { real_->release(); }
  Proc proc(const char* name) const override {
    const Proc found = real_->proc(name);
    const std::string wanted = name;
    const auto between = [&](const char* which, auto& keep, auto own) -> bool {
      if (wanted != which) return false;
      keep = reinterpret_cast<std::remove_reference_t<decltype(keep)>>(found);
      result_ = reinterpret_cast<Proc>(own);
      return true;
    };
    if (between("glGetError", real().getError, &getError) ||
        between("glCheckFramebufferStatus", real().checkFramebufferStatus, &checkFramebufferStatus) ||
        between("glDrawArrays", real().drawArrays, &drawArrays) ||
        between("glGetIntegerv", real().getIntegerv, &getIntegerv) ||
        between("glGetString", real().getString, &getString) ||
        between("glGetTexLevelParameteriv", real().getTexLevelParameteriv, &getTexLevelParameteriv))
      return result_;
    return found;
  }

 private:
  std::unique_ptr<gpu::GlContext> real_;
  mutable Proc result_ = nullptr;
};

}  // namespace faulty

inline Result<std::unique_ptr<gpu::Device>> makeFaultyDevice(const gpu::DeviceOptions& options = {}) {
  Result<std::unique_ptr<gpu::GlContext>> real = gpu::makeOsMesaContext("");
  if (!real) return real.error();
  return gpu::Device::makeOn(std::make_unique<faulty::Context>(std::move(*real)), options);
}

}  // namespace vernier::test
