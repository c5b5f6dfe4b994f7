// SPDX-License-Identifier: GPL-3.0-or-later
#include "GlCore.h"

namespace vernier::gpu {
namespace {
GLADapiproc lookUp(void* user, const char* name) { return static_cast<GlContext*>(user)->proc(name); }
thread_local Revision t_current = 0;  // the Core whose context is current on this thread
}  // namespace

Result<void> Core::makeCurrent() {
  if (t_current == id_) return {};
  if (Result<void> r = context->makeCurrent(); !r) return r;
  t_current = id_;
  return {};
}

void Core::release() {
  if (t_current != id_) return;
  context->release();
  t_current = 0;
}

Result<void> Core::load() {
  const int version = gladLoadGLContextUserPtr(&gl, lookUp, context.get());
  if (version < GLAD_MAKE_VERSION(3, 3))
    return makeError(ErrorCode::GlUnavailable,
                     "OpenGL is not available: 3.3 is needed and the driver offers " +
                         std::to_string(GLAD_VERSION_MAJOR(version)) + "." +
                         std::to_string(GLAD_VERSION_MINOR(version)) + ".");
  return {};
}

// What is still buried goes with the context.
Core::~Core() { release(); }

void Core::bury(ObjectKind kind, unsigned id) {
  const std::lock_guard lock(mutex_);
  dead_.push_back({kind, id});
}

void Core::deleteBuried() {
  std::vector<Dead> dead;
  {
    const std::lock_guard lock(mutex_);
    dead.swap(dead_);
  }
  for (const Dead& d : dead) switch (d.kind) {
      case ObjectKind::Texture:
        gl.DeleteTextures(1, &d.id);
        break;
      case ObjectKind::Buffer:
        gl.DeleteBuffers(1, &d.id);
        break;
      case ObjectKind::VertexArray:
        gl.DeleteVertexArrays(1, &d.id);
        break;
      case ObjectKind::Program:
        gl.DeleteProgram(d.id);
        break;
      case ObjectKind::Framebuffer:
        gl.DeleteFramebuffers(1, &d.id);
        break;
    }
}

Object& Object::operator=(Object&& o) noexcept {
  if (this == &o) return *this;
  drop();
  core_ = std::move(o.core_), kind_ = o.kind_, id_ = std::exchange(o.id_, 0u);
  return *this;
}

void Object::drop() {
  if (id_ == 0) return;
  if (const std::shared_ptr<Core> core = core_.lock()) core->bury(kind_, id_);
  id_ = 0;
}

FormatInfo infoOf(Format f) {
  switch (f) {
    case Format::R8:
      return {GL_R8, GL_RED, GL_UNSIGNED_BYTE, 1, 1};
    case Format::R16:
      return {GL_R16, GL_RED, GL_UNSIGNED_SHORT, 1, 2};
    case Format::R16Snorm:
      return {GL_R16_SNORM, GL_RED, GL_SHORT, 1, 2};
    case Format::R32F:
      return {GL_R32F, GL_RED, GL_FLOAT, 1, 4};
    case Format::Rgba8:
      return {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, 4, 4};
    case Format::Rgba32F:
      return {GL_RGBA32F, GL_RGBA, GL_FLOAT, 4, 16};
  }
  return {};
}

std::uint64_t Texture::bytes() const {
  return infoOf(format_).bytes * static_cast<std::uint64_t>(width_) * static_cast<std::uint64_t>(height_) *
         static_cast<std::uint64_t>(depth_ > 0 ? depth_ : 1);
}

}  // namespace vernier::gpu
