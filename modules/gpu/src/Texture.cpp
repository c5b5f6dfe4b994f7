// SPDX-License-Identifier: GPL-3.0-or-later
// Textures and vertex data.
#include <algorithm>
#include <limits>

#include "DeviceImpl.h"
#include "State.h"

namespace vernier::gpu {
namespace {

std::string sizeText(int w, int h, int d) {
  std::string s = std::to_string(w) + " x " + std::to_string(h);
  return d > 0 ? s + " x " + std::to_string(d) : s;
}

std::uint64_t texelsOf(int w, int h, int d) {
  return static_cast<std::uint64_t>(w) * static_cast<std::uint64_t>(h) *
         static_cast<std::uint64_t>(d > 0 ? d : 1);
}

Error wrongSize(const char* where, std::uint64_t expected, std::uint64_t got) {
  return makeError(
      ErrorCode::GlFailed,
      "The texels are " + std::to_string(got) + " bytes, expected " + std::to_string(expected) + ".", where);
}

// Asks the driver, without a byte being taken, whether it would make this texture.
bool hasRoom(const GladGLContext& gl, const FormatInfo& f, int w, int h, int d) {
  const GLenum proxy = d > 0 ? GL_PROXY_TEXTURE_3D : GL_PROXY_TEXTURE_2D;
  if (d > 0)
    gl.TexImage3D(proxy, 0, f.internal, w, h, d, 0, f.layout, f.type, nullptr);
  else
    gl.TexImage2D(proxy, 0, f.internal, w, h, 0, f.layout, f.type, nullptr);
  GLint width = 0;
  gl.GetTexLevelParameteriv(proxy, 0, GL_TEXTURE_WIDTH, &width);
  return width == w;
}

}  // namespace

Result<Texture> Device::makeTexture(Format format, int w, int h, int d, const void* texels) {
  const int limit = d > 0 ? impl_->limits.max3d : impl_->limits.max2d;
  if (w < 1 || h < 1 || d < 0 || w > limit || h > limit || d > limit)
    return makeError(ErrorCode::GlFailed,
                     "A texture of " + sizeText(w, h, d) + " was asked for; this GL takes 1 to " +
                         std::to_string(limit) + " per side.",
                     "texture");
  const GladGLContext& gl = impl_->core->gl;
  const FormatInfo f = infoOf(format);
  const GLenum target = d > 0 ? GL_TEXTURE_3D : GL_TEXTURE_2D;
  statePixelStore(gl);
  if (!hasRoom(gl, f, w, h, d))
    return makeError(ErrorCode::OutOfMemory,
                     "The GL driver has no room for a texture of " + sizeText(w, h, d) + " (" +
                         std::to_string((f.bytes * texelsOf(w, h, d)) >> 20) +
                         " MiB); use a smaller picture or volume, or the native engine.",
                     "texture");
  Texture t;
  unsigned id = 0;
  gl.GenTextures(1, &id);
  t.object_ = Object(impl_->core, ObjectKind::Texture, id);
  t.width_ = w, t.height_ = h, t.depth_ = d, t.format_ = format;
  gl.ActiveTexture(GL_TEXTURE0);
  gl.BindTexture(target, id);
  gl.TexParameteri(target, GL_TEXTURE_BASE_LEVEL, 0);
  gl.TexParameteri(target, GL_TEXTURE_MAX_LEVEL, 0);
  if (d > 0)
    gl.TexImage3D(target, 0, f.internal, w, h, d, 0, f.layout, f.type, texels);
  else
    gl.TexImage2D(target, 0, f.internal, w, h, 0, f.layout, f.type, texels);
  if (Result<void> r = check("texture"); !r) return r.error();
  impl_->counters.texturesCreated += 1;
  impl_->counters.textures3dCreated += d > 0 ? 1u : 0u;
  return t;
}

Result<Texture> Device::texture2d(Format format, int w, int h, std::span<const std::byte> texels) {
  if (Result<void> r = enter("texture2d"); !r) return r.error();
  if (w > 0 && h > 0 && texels.size() != infoOf(format).bytes * texelsOf(w, h, 0))
    return wrongSize("texture2d", infoOf(format).bytes * texelsOf(w, h, 0), texels.size());
  Result<Texture> t = makeTexture(format, w, h, 0, texels.data());
  if (t) impl_->counters.bytesUploaded += texels.size();
  return t;
}

Result<Texture> Device::texture3d(Format format, int w, int h, int d) {
  if (Result<void> r = enter("texture3d"); !r) return r.error();
  if (d < 1) return makeError(ErrorCode::GlFailed, "A 3-D texture needs at least one slice.", "texture3d");
  return makeTexture(format, w, h, d, nullptr);
}

Result<void> Device::uploadSlices(const Texture& t, int first, int count, std::span<const std::byte> texels) {
  if (Result<void> r = enter("uploadSlices"); !r) return r;
  const FormatInfo f = infoOf(t.format_);
  if (first < 0 || count < 1 || first > t.depth_ - count)
    return makeError(ErrorCode::GlFailed,
                     "Slices " + std::to_string(first) + " to " + std::to_string(first + count - 1) +
                         " are not in a texture of " + std::to_string(t.depth_) + ".",
                     "uploadSlices");
  if (texels.size() != f.bytes * texelsOf(t.width_, t.height_, count))
    return wrongSize("uploadSlices", f.bytes * texelsOf(t.width_, t.height_, count), texels.size());
  const GladGLContext& gl = impl_->core->gl;
  statePixelStore(gl);
  gl.ActiveTexture(GL_TEXTURE0);
  gl.BindTexture(GL_TEXTURE_3D, t.object_.id());
  gl.TexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, first, t.width_, t.height_, count, f.layout, f.type,
                   texels.data());
  impl_->counters.bytesUploaded += texels.size();
  return check("uploadSlices");
}

Result<void> Device::readTexture(const Texture& t, std::span<std::byte> out) {
  if (Result<void> r = enter("readTexture"); !r) return r;
  if (out.size() != t.bytes()) return wrongSize("readTexture", t.bytes(), out.size());
  const GladGLContext& gl = impl_->core->gl;
  const FormatInfo f = infoOf(t.format_);
  const GLenum target = t.depth_ > 0 ? GL_TEXTURE_3D : GL_TEXTURE_2D;
  statePixelStore(gl);
  gl.ActiveTexture(GL_TEXTURE0);
  gl.BindTexture(target, t.object_.id());
  gl.GetTexImage(target, 0, f.layout, f.type, out.data());
  return check("readTexture");
}

Result<VertexData> Device::vertices(std::span<const float> interleaved, std::span<const int> components,
                                    std::span<const std::uint32_t> indices) {
  if (Result<void> r = enter("vertices"); !r) return r.error();
  int stride = 0;
  for (int c : components) stride += c;
  if (stride < 1 || interleaved.empty() || interleaved.size() % static_cast<std::size_t>(stride) != 0)
    return makeError(ErrorCode::GlFailed, "The vertex data does not divide into whole vertices.", "vertices");
  const std::size_t count = interleaved.size() / static_cast<std::size_t>(stride);
  if (std::any_of(indices.begin(), indices.end(), [&](std::uint32_t i) { return i >= count; }))
    return makeError(ErrorCode::GlFailed, "An index names a vertex that is not there.", "vertices");
  if (std::max(count, indices.size()) > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    return makeError(ErrorCode::OutOfMemory, "The surface has too many triangles for one GL buffer.",
                     "vertices");
  const GladGLContext& gl = impl_->core->gl;
  VertexData v;
  unsigned array = 0, buffer = 0;
  gl.GenVertexArrays(1, &array);
  gl.GenBuffers(1, &buffer);
  v.array_ = Object(impl_->core, ObjectKind::VertexArray, array);
  v.buffer_ = Object(impl_->core, ObjectKind::Buffer, buffer);
  v.count_ = static_cast<int>(interleaved.size() / static_cast<std::size_t>(stride));
  gl.BindVertexArray(array);
  gl.BindBuffer(GL_ARRAY_BUFFER, buffer);
  gl.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(interleaved.size_bytes()), interleaved.data(),
                GL_STATIC_DRAW);
  std::size_t offset = 0;
  for (std::size_t n = 0; n < components.size(); ++n) {
    const auto at = static_cast<GLuint>(n);
    gl.EnableVertexAttribArray(at);
    gl.VertexAttribPointer(at, components[n], GL_FLOAT, GL_FALSE,
                           stride * static_cast<GLsizei>(sizeof(float)),
                           reinterpret_cast<const void*>(offset));
    offset += static_cast<std::size_t>(components[n]) * sizeof(float);
  }
  if (!indices.empty()) {
    unsigned elements = 0;
    gl.GenBuffers(1, &elements);
    v.indices_ = Object(impl_->core, ObjectKind::Buffer, elements);
    gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, elements);
    gl.BufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(indices.size_bytes()), indices.data(),
                  GL_STATIC_DRAW);
    v.count_ = static_cast<int>(indices.size());
    v.indexed_ = true;
  }
  gl.BindVertexArray(0);
  v.bytes_ = interleaved.size_bytes() + indices.size_bytes();
  impl_->counters.bytesUploaded += v.bytes_;
  if (Result<void> r = check("vertices"); !r) return r.error();
  return v;
}

}  // namespace vernier::gpu
