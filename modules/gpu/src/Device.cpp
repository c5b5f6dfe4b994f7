// SPDX-License-Identifier: GPL-3.0-or-later
// Making a Device, its threads, its error checks.
#include <cstdlib>
#include <cstring>

#include "DeviceImpl.h"

namespace vernier::gpu {
namespace {

std::string textOf(const GladGLContext& gl, GLenum what) {
  const GLubyte* s = gl.GetString(what);
  return s ? reinterpret_cast<const char*>(s) : "";
}

Limits limitsOf(const GladGLContext& gl) {
  Limits l;
  gl.GetIntegerv(GL_MAX_TEXTURE_SIZE, &l.max2d);
  gl.GetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &l.max3d);
  gl.GetIntegerv(GL_MAX_DRAW_BUFFERS, &l.maxColours);
  l.renderer = textOf(gl, GL_RENDERER), l.version = textOf(gl, GL_VERSION), l.vendor = textOf(gl, GL_VENDOR);
  l.software =
      l.renderer.find("llvmpipe") != std::string::npos || l.renderer.find("softpipe") != std::string::npos;
  return l;
}

void makeSamplers(const GladGLContext& gl, unsigned (&samplers)[2][2]) {
  constexpr float kZero[4] = {0, 0, 0, 0};
  for (int filter = 0; filter < 2; ++filter)
    for (int wrap = 0; wrap < 2; ++wrap) {
      unsigned& s = samplers[filter][wrap];
      gl.GenSamplers(1, &s);
      const GLint f = filter == static_cast<int>(Filter::Linear) ? GL_LINEAR : GL_NEAREST;
      const GLint w = wrap == static_cast<int>(Wrap::Zero) ? GL_CLAMP_TO_BORDER : GL_CLAMP_TO_EDGE;
      gl.SamplerParameteri(s, GL_TEXTURE_MIN_FILTER, f);
      gl.SamplerParameteri(s, GL_TEXTURE_MAG_FILTER, f);
      gl.SamplerParameteri(s, GL_TEXTURE_WRAP_S, w);
      gl.SamplerParameteri(s, GL_TEXTURE_WRAP_T, w);
      gl.SamplerParameteri(s, GL_TEXTURE_WRAP_R, w);
      gl.SamplerParameterfv(s, GL_TEXTURE_BORDER_COLOR, kZero);
    }
}

// Of OpenGL 4.5 and KHR_robustness; older drivers never give it.
constexpr GLenum kContextLost = 0x0507;

const char* nameOfError(GLenum e) {
  switch (e) {
    case GL_INVALID_ENUM:
      return "invalid enum";
    case GL_INVALID_VALUE:
      return "invalid value";
    case GL_INVALID_OPERATION:
      return "invalid operation";
    case GL_INVALID_FRAMEBUFFER_OPERATION:
      return "invalid framebuffer operation";
    default:
      return "unknown error";
  }
}

}  // namespace

Device::Device() = default;

Result<std::unique_ptr<Device>> Device::make(const DeviceOptions& options) {
  const char* off = std::getenv("VERNIER_GL");
  if (off && std::strcmp(off, "off") == 0)
    return makeError(ErrorCode::GlUnavailable, "OpenGL is switched off by VERNIER_GL=off.");
  Result<std::unique_ptr<GlContext>> context = makeOsMesaContext(options.osmesaLibrary);
  if (!context) return context.error();
  return makeOn(std::move(*context), options);
}

Result<std::unique_ptr<Device>> Device::makeOn(std::unique_ptr<GlContext> context,
                                               const DeviceOptions& options) {
  std::unique_ptr<Device> device(new Device);
  device->impl_ = std::make_unique<Impl>(options.cacheLimit_bytes);
  Impl& d = *device->impl_;
  d.core = std::make_shared<Core>(std::move(context));
  if (Result<void> r = device->adopt(); !r) return r.error();
  if (Result<void> r = d.core->load(); !r) return r.error();
  d.limits = limitsOf(d.core->gl);
  d.limits.cacheLimit_bytes = options.cacheLimit_bytes;
  makeSamplers(d.core->gl, d.samplers);
  d.core->gl.GenQueries(1, &d.fragmentQuery);
  if (Result<void> r = device->check("making the context"); !r) return r.error();
  constexpr Format kFloats[] = {Format::Rgba32F, Format::R32F};  // as every pass draws into
  if (const Result<Target> target = device->target(1, 1, kFloats); !target)
    return makeError(
        ErrorCode::GlUnavailable,
        "OpenGL is not available: this driver cannot draw into float images; update it, or use the native "
        "engine.",
        d.limits.renderer);
  d.counters = {};
  return device;
}

// Samplers and the query go with the context.
Device::~Device() = default;

const Limits& Device::limits() const { return impl_->limits; }
DeviceCache& Device::cache() { return impl_->cache; }
const Counters& Device::counters() const { return impl_->counters; }

Result<void> Device::release() {
  if (Result<void> r = enter("release"); !r) return r;
  impl_->core->gl.Finish();
  impl_->core->release();
  impl_->core->owner = {};
  return {};
}

Result<void> Device::adopt() {
  if (impl_->core->owner == std::this_thread::get_id()) return {};
  if (impl_->core->owner != std::thread::id())
    return makeError(ErrorCode::GlFailed,
                     "The GL device belongs to another thread, which has not released it.", "adopt");
  if (Result<void> r = impl_->core->makeCurrent(); !r) return r;
  impl_->core->owner = std::this_thread::get_id();
  return {};
}

Result<void> Device::enter(const char* where) {
  if (impl_->core->owner != std::this_thread::get_id())
    return makeError(ErrorCode::GlFailed, "The GL device was used by a thread that it does not belong to.",
                     where);
  if (Result<void> r = impl_->core->makeCurrent(); !r) return r;
  impl_->core->deleteBuried();
  return {};
}

Result<void> Device::check(const char* where) {
  Result<void> first;
  // A driver may hold several error flags; a lost context reports for ever, hence the limit.
  for (int n = 0; n < 16; ++n) {
    const GLenum e = impl_->core->gl.GetError();
    if (e == GL_NO_ERROR) break;
    if (e == kContextLost)
      return makeError(ErrorCode::GlLost, "The OpenGL context was lost: the graphics driver was reset.",
                       where);
    if (!first) continue;
    if (e == GL_OUT_OF_MEMORY)
      first = makeError(ErrorCode::OutOfMemory,
                        "The GL driver ran out of memory; use a smaller picture or volume.", where);
    else
      first = makeError(ErrorCode::GlFailed,
                        std::string("The GL driver refused an operation: ") + nameOfError(e) + ".", where);
  }
  return first;
}

Result<void> Device::finish() {
  if (Result<void> r = enter("finish"); !r) return r;
  impl_->core->gl.Finish();
  return check("finish");
}

void describe(const Limits& l, Capabilities& c) {
  c.gl = true;
  c.glIsSoftware = l.software;
  c.glRenderer = l.renderer, c.glVersion = l.version, c.glWhyNot.clear();
  c.max3dTexture = l.max3d, c.maxTexture = l.max2d;
  c.glTextureBudget_bytes = l.cacheLimit_bytes;
}

void probe(Capabilities& c, const DeviceOptions& options) {
  const Result<std::unique_ptr<Device>> device = Device::make(options);
  if (device) return describe((*device)->limits(), c);
  c.gl = false;
  c.glRenderer.clear(), c.glVersion.clear();
  c.max3dTexture = c.maxTexture = 0;
  c.glWhyNot = device.error().sentence;
}

}  // namespace vernier::gpu
