// SPDX-License-Identifier: GPL-3.0-or-later
// Programs: compiled once per name; a refused shader brings the driver's own words, shortened.
#include "DeviceImpl.h"

namespace vernier::gpu {
namespace {

constexpr std::size_t kLogCharacters = 400;

// The first lines of the driver's log as one line.
std::string trimmed(std::string log) {
  while (!log.empty() && (log.back() == '\0' || log.back() == '\n' || log.back() == ' ')) log.pop_back();
  for (char& c : log)
    if (c == '\n' || c == '\r' || c == '\t') c = ' ';
  if (log.size() > kLogCharacters) log = log.substr(0, kLogCharacters) + " ...";
  return log.empty() ? "(the driver says nothing)" : log;
}

// A shader object that is deleted when it goes out of scope; a linked program keeps what it needs.
class Shader {
 public:
  Shader(const GladGLContext& gl, GLenum type) : gl_(gl), id_(gl.CreateShader(type)) {}
  ~Shader() { gl_.DeleteShader(id_); }
  Shader(const Shader&) = delete;
  Shader& operator=(const Shader&) = delete;
  unsigned id() const { return id_; }

  Result<void> compile(std::string_view text, const std::string& where) {
    const char* p = text.data();
    const auto n = static_cast<GLint>(text.size());
    gl_.ShaderSource(id_, 1, &p, &n);
    gl_.CompileShader(id_);
    GLint ok = 0, length = 0;
    gl_.GetShaderiv(id_, GL_COMPILE_STATUS, &ok);
    if (ok) return {};
    gl_.GetShaderiv(id_, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<std::size_t>(length > 0 ? length : 1), '\0');
    gl_.GetShaderInfoLog(id_, static_cast<GLsizei>(log.size()), nullptr, log.data());
    return makeError(ErrorCode::ShaderInvalid, "The shader does not compile: " + trimmed(log), where);
  }

 private:
  const GladGLContext& gl_;
  unsigned id_;
};

bool isSampler(GLenum type) {
  return type == GL_SAMPLER_2D || type == GL_SAMPLER_3D || type == GL_SAMPLER_1D || type == GL_SAMPLER_CUBE;
}

}  // namespace

Result<std::shared_ptr<const Program>> Device::program(const std::string& name, std::string_view vertexText,
                                                       std::string_view fragmentText) {
  if (Result<void> r = enter("program"); !r) return r.error();
  if (const auto hit = impl_->programs.find(name); hit != impl_->programs.end()) return hit->second;
  const GladGLContext& gl = impl_->core->gl;
  Shader vertex(gl, GL_VERTEX_SHADER), fragment(gl, GL_FRAGMENT_SHADER);
  if (Result<void> r = vertex.compile(vertexText, name + ", vertex shader"); !r) return r.error();
  if (Result<void> r = fragment.compile(fragmentText, name + ", fragment shader"); !r) return r.error();

  auto program = std::make_shared<Program>();
  const unsigned id = gl.CreateProgram();
  program->object_ = Object(impl_->core, ObjectKind::Program, id);
  program->name_ = name;
  gl.AttachShader(id, vertex.id());
  gl.AttachShader(id, fragment.id());
  gl.LinkProgram(id);
  gl.DetachShader(id, vertex.id());
  gl.DetachShader(id, fragment.id());
  GLint ok = 0, count = 0;
  gl.GetProgramiv(id, GL_LINK_STATUS, &ok);
  if (!ok) {
    std::string log(2048, '\0');
    gl.GetProgramInfoLog(id, static_cast<GLsizei>(log.size()), nullptr, log.data());
    return makeError(ErrorCode::ShaderInvalid, "The shaders do not link: " + trimmed(log.c_str()), name);
  }
  gl.GetProgramiv(id, GL_ACTIVE_UNIFORMS, &count);
  for (GLint n = 0; n < count; ++n) {
    char text[256] = "";
    GLint size = 0;
    GLenum type = 0;
    gl.GetActiveUniform(id, static_cast<GLuint>(n), sizeof text, nullptr, &size, &type, text);
    const int location = gl.GetUniformLocation(id, text);
    if (location < 0) continue;  // a built-in
    if (size > 1)
      return makeError(ErrorCode::ShaderInvalid,
                       std::string("Uniform arrays are not used here: ") + text + ".", name);
    (isSampler(type) ? program->samplers_ : program->uniforms_).push_back({text, location, type});
  }
  if (program->samplers_.size() > kMaxUnits)
    return makeError(ErrorCode::ShaderInvalid,
                     "The program reads more than " + std::to_string(kMaxUnits) + " textures.", name);
  if (Result<void> r = check("program"); !r) return r.error();
  impl_->programs[name] = program;
  return std::shared_ptr<const Program>(program);
}

}  // namespace vernier::gpu
