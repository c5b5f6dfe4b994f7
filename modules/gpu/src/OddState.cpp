// SPDX-License-Identifier: GPL-3.0-or-later
// The dirty-state hook: a pass that draws the same picture after this states all that it depends on.
#include "DeviceImpl.h"

namespace vernier::gpu {

void Device::setOddStateForTest(unsigned seed) {
  if (!enter("setOddStateForTest")) return;
  const GladGLContext& gl = impl_->core->gl;
  const bool odd = seed % 2 != 0;
  for (GLenum on :
       {GL_BLEND, GL_DEPTH_TEST, GL_CULL_FACE, GL_SCISSOR_TEST, GL_STENCIL_TEST, GL_DITHER,
        GL_FRAMEBUFFER_SRGB, GL_POLYGON_OFFSET_FILL, GL_SAMPLE_ALPHA_TO_COVERAGE, GL_SAMPLE_COVERAGE,
        GL_SAMPLE_MASK, GL_MULTISAMPLE, GL_PRIMITIVE_RESTART, GL_RASTERIZER_DISCARD, GL_DEPTH_CLAMP,
        GL_PROGRAM_POINT_SIZE, GL_CLIP_DISTANCE0, GL_CLIP_DISTANCE1, GL_POLYGON_SMOOTH})
    gl.Enable(on);
  odd ? gl.Enable(GL_COLOR_LOGIC_OP) : gl.Disable(GL_COLOR_LOGIC_OP);
  gl.LogicOp(GL_INVERT);
  gl.BlendEquation(odd ? GL_FUNC_REVERSE_SUBTRACT : GL_MIN);
  gl.BlendFunc(GL_ZERO, GL_ONE_MINUS_DST_COLOR);
  gl.BlendColor(0.3f, 0.5f, 0.7f, 0.9f);
  gl.DepthFunc(odd ? GL_NEVER : GL_EQUAL);
  gl.DepthMask(odd ? GL_TRUE : GL_FALSE);
  gl.DepthRange(0.75, 0.25);
  gl.StencilFunc(GL_NEVER, 3, 0xff);
  gl.StencilOp(GL_INCR, GL_DECR, GL_INVERT);
  gl.CullFace(odd ? GL_FRONT_AND_BACK : GL_FRONT);
  gl.FrontFace(odd ? GL_CCW : GL_CW);
  gl.PolygonMode(GL_FRONT_AND_BACK, odd ? GL_LINE : GL_POINT);
  gl.PolygonOffset(7.0f, 11.0f);
  gl.Scissor(3, 5, 1, 1);
  gl.Viewport(1, 2, 3, 4);
  gl.ColorMask(GL_FALSE, odd, GL_FALSE, !odd);
  gl.SampleCoverage(0.25f, GL_TRUE);
  gl.SampleMaski(0, 0);
  gl.PrimitiveRestartIndex(1);
  gl.ClampColor(GL_CLAMP_READ_COLOR, GL_TRUE);
  gl.ProvokingVertex(GL_FIRST_VERTEX_CONVENTION);
  gl.PointSize(5.0f);
  for (const GLenum p : {GL_UNPACK_ROW_LENGTH, GL_PACK_ROW_LENGTH, GL_UNPACK_IMAGE_HEIGHT})
    gl.PixelStorei(p, 777);
  for (const GLenum p : {GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_PIXELS, GL_UNPACK_SKIP_IMAGES, GL_PACK_SKIP_ROWS,
                         GL_PACK_SKIP_PIXELS, GL_UNPACK_SWAP_BYTES, GL_PACK_SWAP_BYTES})
    gl.PixelStorei(p, 1);
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, 8);
  gl.PixelStorei(GL_PACK_ALIGNMENT, 8);
  for (unsigned unit = 0; unit < kMaxUnits; ++unit) {
    gl.ActiveTexture(GL_TEXTURE0 + unit);
    gl.BindTexture(GL_TEXTURE_2D, 0);
    gl.BindTexture(GL_TEXTURE_3D, 0);
    gl.BindSampler(unit, impl_->samplers[odd ? 1 : 0][1]);
  }
  gl.ActiveTexture(GL_TEXTURE5);
  gl.UseProgram(0);
  gl.BindVertexArray(0);
  gl.BindBuffer(GL_ARRAY_BUFFER, 0);
  gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
  while (gl.GetError() != GL_NO_ERROR) {
  }
}

}  // namespace vernier::gpu
