// SPDX-License-Identifier: GPL-3.0-or-later
// Draws: state, inputs, uniforms, all of them stated.
#include <algorithm>
#include <cstring>

#include "DeviceImpl.h"
#include "State.h"

namespace vernier::gpu {
namespace {

struct UniformType {
  GLenum operator()(int) const { return GL_INT; }
  GLenum operator()(float) const { return GL_FLOAT; }
  GLenum operator()(const glm::vec2&) const { return GL_FLOAT_VEC2; }
  GLenum operator()(const glm::vec3&) const { return GL_FLOAT_VEC3; }
  GLenum operator()(const glm::vec4&) const { return GL_FLOAT_VEC4; }
  GLenum operator()(const glm::ivec2&) const { return GL_INT_VEC2; }
  GLenum operator()(const glm::ivec3&) const { return GL_INT_VEC3; }
  GLenum operator()(const glm::mat4&) const { return GL_FLOAT_MAT4; }
};

struct SetUniform {
  const GladGLContext& gl;
  int at;
  void operator()(int v) const { gl.Uniform1i(at, v); }
  void operator()(float v) const { gl.Uniform1f(at, v); }
  void operator()(const glm::vec2& v) const { gl.Uniform2fv(at, 1, &v[0]); }
  void operator()(const glm::vec3& v) const { gl.Uniform3fv(at, 1, &v[0]); }
  void operator()(const glm::vec4& v) const { gl.Uniform4fv(at, 1, &v[0]); }
  void operator()(const glm::ivec2& v) const { gl.Uniform2iv(at, 1, &v[0]); }
  void operator()(const glm::ivec3& v) const { gl.Uniform3iv(at, 1, &v[0]); }
  void operator()(const glm::mat4& v) const { gl.UniformMatrix4fv(at, 1, GL_FALSE, &v[0][0]); }
};

GLenum modeOf(Primitive p) {
  switch (p) {
    case Primitive::Triangles:
      return GL_TRIANGLES;
    case Primitive::TriangleStrip:
      return GL_TRIANGLE_STRIP;
    case Primitive::TriangleFan:
      return GL_TRIANGLE_FAN;
  }
  return GL_TRIANGLES;
}

std::uint64_t trianglesOf(const Draw& d) {
  if (d.count < 3) return 0;
  return static_cast<std::uint64_t>(d.primitive == Primitive::Triangles ? d.count / 3 : d.count - 2);
}

Error drawError(std::string sentence, const Program& p) {
  return makeError(ErrorCode::GlFailed, std::move(sentence), "draw with " + p.name());
}

}  // namespace

Result<void> Device::applyUniforms(const Draw& d) {
  for (const Program::Active& u : d.program->uniforms_) {
    const auto given = std::find_if(d.uniforms.begin(), d.uniforms.end(),
                                    [&](const Uniform& g) { return u.name == g.name; });
    if (given == d.uniforms.end())
      return drawError("The uniform '" + u.name + "' was not given.", *d.program);
    if (std::visit(UniformType{}, given->value) != u.type)
      return drawError("The uniform '" + u.name + "' was given in another type.", *d.program);
    std::visit(SetUniform{impl_->core->gl, u.location}, given->value);
  }
  return {};
}

Result<void> Device::bindInputs(const Target& target, const Draw& d) {
  const GladGLContext& gl = impl_->core->gl;
  unsigned unit = 0;
  for (const Program::Active& s : d.program->samplers_) {
    const auto given = std::find_if(d.textures.begin(), d.textures.end(),
                                    [&](const TextureBinding& g) { return s.name == g.sampler; });
    if (given == d.textures.end() || !given->texture)
      return drawError("The texture '" + s.name + "' was not given.", *d.program);
    const Texture& t = *given->texture;
    if ((s.type == GL_SAMPLER_3D) != (t.depth_ > 0) || (s.type != GL_SAMPLER_3D && s.type != GL_SAMPLER_2D))
      return drawError("The texture '" + s.name + "' has the wrong number of dimensions.", *d.program);
    for (const Texture& c : target.colours_)
      if (c.object_.id() == t.object_.id())
        return drawError("The texture '" + s.name + "' is the image that is drawn into.", *d.program);
    gl.ActiveTexture(GL_TEXTURE0 + unit);
    gl.BindTexture(t.depth_ > 0 ? GL_TEXTURE_3D : GL_TEXTURE_2D, t.object_.id());
    gl.BindSampler(unit, impl_->samplers[static_cast<int>(given->filter)][static_cast<int>(given->wrap)]);
    gl.Uniform1i(s.location, static_cast<int>(unit));
    ++unit;
  }
  return {};
}

Result<void> Device::one(const Target& target, const Draw& d) {
  if (!d.program || !d.vertices)
    return makeError(ErrorCode::GlFailed, "A draw needs a program and vertices.", "draw");
  if (d.first < 0 || d.count < 0 || d.first > d.vertices->count_ - d.count)
    return drawError("The draw asks for vertices " + std::to_string(d.first) + " to " +
                         std::to_string(d.first + d.count - 1) + " of " + std::to_string(d.vertices->count_) +
                         ".",
                     *d.program);
  if (d.state.depth != DepthTest::Off && !target.hasDepth_)
    return drawError("A depth test was asked for, but the target has no depth.", *d.program);
  if (d.state.clipDistances < 0 || d.state.clipDistances > kMostClipDistances)
    return drawError("A draw cuts with 0 to 8 clip distances.", *d.program);
  const GladGLContext& gl = impl_->core->gl;
  gl.UseProgram(d.program->object_.id());
  gl.BindVertexArray(d.vertices->array_.id());
  if (Result<void> r = bindInputs(target, d); !r) return r;
  if (Result<void> r = applyUniforms(d); !r) return r;
  applyState(gl, d.state, target.object_.id(), target.width_, target.height_);
  if (d.vertices->indexed_)
    gl.DrawElements(modeOf(d.primitive), d.count, GL_UNSIGNED_INT,
                    reinterpret_cast<const void*>(static_cast<std::size_t>(d.first) * sizeof(std::uint32_t)));
  else
    gl.DrawArrays(modeOf(d.primitive), d.first, d.count);
  impl_->counters.triangles += trianglesOf(d);
  return {};
}

Result<void> Device::draw(const Target& target, std::span<const Draw> draws) {
  if (Result<void> r = enter("draw"); !r) return r;
  const GladGLContext& gl = impl_->core->gl;
  Result<void> result;
  gl.BeginQuery(GL_SAMPLES_PASSED, impl_->fragmentQuery);
  for (const Draw& d : draws)
    if (result = one(target, d); !result) break;
  gl.EndQuery(GL_SAMPLES_PASSED);
  GLuint fragments = 0;
  gl.GetQueryObjectuiv(impl_->fragmentQuery, GL_QUERY_RESULT, &fragments);
  impl_->counters.samples += fragments;
  gl.BindVertexArray(0);
  const Result<void> checked = check("draw");
  return result ? checked : result;
}

}  // namespace vernier::gpu
