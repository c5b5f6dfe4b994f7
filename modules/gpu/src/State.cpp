// SPDX-License-Identifier: GPL-3.0-or-later
#include "State.h"

namespace vernier::gpu {
namespace {

void set(const GladGLContext& gl, GLenum what, bool on) { on ? gl.Enable(what) : gl.Disable(what); }

void stateDepth(const GladGLContext& gl, const DrawState& s) {
  set(gl, GL_DEPTH_TEST, s.depth != DepthTest::Off);
  gl.DepthMask(s.depth != DepthTest::Off && s.depthWrite ? GL_TRUE : GL_FALSE);
  gl.DepthRange(0.0, 1.0);
  switch (s.depth) {
    case DepthTest::Off:
      gl.DepthFunc(GL_ALWAYS);
      break;
    case DepthTest::Less:
      gl.DepthFunc(GL_LESS);
      break;
    case DepthTest::LessEqual:
      gl.DepthFunc(GL_LEQUAL);
      break;
    case DepthTest::Greater:
      gl.DepthFunc(GL_GREATER);
      break;
    case DepthTest::GreaterEqual:
      gl.DepthFunc(GL_GEQUAL);
      break;
  }
}

void stateBlend(const GladGLContext& gl, const DrawState& s) {
  set(gl, GL_BLEND, s.blend != Blend::Off);
  gl.BlendColor(0, 0, 0, 0);
  gl.BlendEquation(s.blend == Blend::Max ? GL_MAX : s.blend == Blend::Min ? GL_MIN : GL_FUNC_ADD);
  if (s.blend == Blend::Remaining)
    gl.BlendFuncSeparate(GL_ONE, GL_SRC_ALPHA, GL_ZERO, GL_SRC_ALPHA);
  else
    gl.BlendFunc(GL_ONE, s.blend == Blend::Over  ? GL_ONE_MINUS_SRC_ALPHA
                         : s.blend == Blend::Off ? GL_ZERO
                                                 : GL_ONE);
  const auto mask = [&](int c) -> GLboolean {
    return s.colourMask[static_cast<std::size_t>(c)] ? GL_TRUE : GL_FALSE;
  };
  gl.ColorMask(mask(0), mask(1), mask(2), mask(3));
}

void stateRaster(const GladGLContext& gl, const DrawState& s, int width, int height) {
  set(gl, GL_DEPTH_CLAMP, s.depthClamp);
  for (int n = 0; n < kMostClipDistances; ++n)
    set(gl, GL_CLIP_DISTANCE0 + static_cast<GLenum>(n), n < s.clipDistances);
  set(gl, GL_CULL_FACE, s.cull != Cull::Off);
  gl.CullFace(s.cull == Cull::Front ? GL_FRONT : GL_BACK);
  // Our row 0 is the top: what one sees as counter-clockwise is clockwise in GL's window coordinates.
  gl.FrontFace(GL_CW);
  const Rect v = s.viewport.value_or(Rect{0, 0, width, height});
  gl.Viewport(v.x, v.y, v.width, v.height);
  set(gl, GL_SCISSOR_TEST, s.scissor.has_value());
  const Rect c = s.scissor.value_or(Rect{0, 0, width, height});
  gl.Scissor(c.x, c.y, c.width, c.height);
  gl.PolygonMode(GL_FRONT_AND_BACK, GL_FILL);
}

}  // namespace

void statePixelStore(const GladGLContext& gl) {
  gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
  gl.BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  for (const GLenum p : {GL_UNPACK_SWAP_BYTES, GL_UNPACK_LSB_FIRST, GL_UNPACK_ROW_LENGTH,
                         GL_UNPACK_IMAGE_HEIGHT, GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_PIXELS,
                         GL_UNPACK_SKIP_IMAGES, GL_PACK_SWAP_BYTES, GL_PACK_LSB_FIRST, GL_PACK_ROW_LENGTH,
                         GL_PACK_IMAGE_HEIGHT, GL_PACK_SKIP_ROWS, GL_PACK_SKIP_PIXELS, GL_PACK_SKIP_IMAGES})
    gl.PixelStorei(p, 0);
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
}

void applyState(const GladGLContext& gl, const DrawState& s, unsigned framebuffer, int width, int height) {
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  for (GLenum off :
       {GL_DITHER, GL_FRAMEBUFFER_SRGB, GL_STENCIL_TEST, GL_COLOR_LOGIC_OP, GL_POLYGON_OFFSET_FILL,
        GL_POLYGON_OFFSET_LINE, GL_POLYGON_OFFSET_POINT, GL_POLYGON_SMOOTH, GL_LINE_SMOOTH,
        GL_SAMPLE_ALPHA_TO_COVERAGE, GL_SAMPLE_ALPHA_TO_ONE, GL_SAMPLE_COVERAGE, GL_SAMPLE_MASK,
        GL_MULTISAMPLE, GL_PRIMITIVE_RESTART, GL_RASTERIZER_DISCARD, GL_PROGRAM_POINT_SIZE})
    gl.Disable(off);
  gl.ClampColor(GL_CLAMP_READ_COLOR, GL_FALSE);
  gl.ProvokingVertex(GL_LAST_VERTEX_CONVENTION);
  stateDepth(gl, s);
  stateBlend(gl, s);
  stateRaster(gl, s, width, height);
  statePixelStore(gl);
}

}  // namespace vernier::gpu
