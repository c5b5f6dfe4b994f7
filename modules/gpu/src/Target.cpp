// SPDX-License-Identifier: GPL-3.0-or-later
// Targets: float framebuffers, their clearing and read-back.
#include "DeviceImpl.h"
#include "State.h"

namespace vernier::gpu {

Result<Target> Device::target(int w, int h, std::span<const Format> colours, bool depth) {
  if (Result<void> r = enter("target"); !r) return r.error();
  if (colours.empty() || static_cast<int>(colours.size()) > impl_->limits.maxColours)
    return makeError(ErrorCode::GlFailed,
                     "A target takes 1 to " + std::to_string(impl_->limits.maxColours) +
                         " colour images, got " + std::to_string(colours.size()) + ".",
                     "target");
  const GladGLContext& gl = impl_->core->gl;
  Target t;
  t.width_ = w, t.height_ = h, t.hasDepth_ = depth;
  for (Format f : colours) {
    Result<Texture> c = makeTexture(f, w, h, 0, nullptr);
    if (!c) return c.error();
    t.colours_.push_back(std::move(*c));
  }
  unsigned id = 0;
  gl.GenFramebuffers(1, &id);
  t.object_ = Object(impl_->core, ObjectKind::Framebuffer, id);
  gl.BindFramebuffer(GL_FRAMEBUFFER, id);
  std::vector<GLenum> buffers;
  for (const Texture& c : t.colours_) {
    buffers.push_back(static_cast<GLenum>(GL_COLOR_ATTACHMENT0 + buffers.size()));
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, buffers.back(), GL_TEXTURE_2D, c.object_.id(), 0);
  }
  gl.DrawBuffers(static_cast<GLsizei>(buffers.size()), buffers.data());
  if (depth) {
    unsigned depthId = 0;
    gl.GenTextures(1, &depthId);
    t.depth_ = Object(impl_->core, ObjectKind::Texture, depthId);
    gl.ActiveTexture(GL_TEXTURE0);
    gl.BindTexture(GL_TEXTURE_2D, depthId);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, w, h, 0, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT,
                  nullptr);
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depthId, 0);
  }
  const GLenum status = gl.CheckFramebufferStatus(GL_FRAMEBUFFER);
  if (status != GL_FRAMEBUFFER_COMPLETE)
    return makeError(
        ErrorCode::GlFailed,
        "The GL driver cannot draw into this combination of images (status " + std::to_string(status) + ").",
        "target");
  if (Result<void> r = check("target"); !r) return r.error();
  return t;
}

Result<void> Device::clear(const Target& t, int colour, glm::vec4 value) {
  if (Result<void> r = enter("clear"); !r) return r;
  if (colour < 0 || colour >= t.colours())
    return makeError(ErrorCode::GlFailed, "The target has no colour image " + std::to_string(colour) + ".",
                     "clear");
  applyState(impl_->core->gl, DrawState{}, t.object_.id(), t.width_, t.height_);
  impl_->core->gl.ClearBufferfv(GL_COLOR, colour, &value[0]);
  return check("clear");
}

Result<void> Device::clearDepth(const Target& t, float value) {
  if (Result<void> r = enter("clearDepth"); !r) return r;
  DrawState state;
  state.depth = DepthTest::Less, state.depthWrite = true;
  applyState(impl_->core->gl, state, t.object_.id(), t.width_, t.height_);
  impl_->core->gl.ClearBufferfv(GL_DEPTH, 0, &value);
  return check("clearDepth");
}

Result<void> Device::read(const Target& t, int colour, std::span<float> out) {
  if (Result<void> r = enter("read"); !r) return r;
  if (colour < 0 || colour >= t.colours())
    return makeError(ErrorCode::GlFailed, "The target has no colour image " + std::to_string(colour) + ".",
                     "read");
  const FormatInfo f = infoOf(t.colour(colour).format());
  const std::size_t expected = static_cast<std::size_t>(t.width_) * static_cast<std::size_t>(t.height_) *
                               static_cast<std::size_t>(f.components);
  if (out.size() != expected)
    return makeError(ErrorCode::GlFailed,
                     "The space for the picture has " + std::to_string(out.size()) + " floats, expected " +
                         std::to_string(expected) + ".",
                     "read");
  const GladGLContext& gl = impl_->core->gl;
  applyState(gl, DrawState{}, t.object_.id(), t.width_, t.height_);
  gl.ReadBuffer(static_cast<GLenum>(GL_COLOR_ATTACHMENT0 + colour));
  gl.ReadPixels(0, 0, t.width_, t.height_, f.layout, GL_FLOAT, out.data());
  return check("read");
}

}  // namespace vernier::gpu
