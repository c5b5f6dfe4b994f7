// SPDX-License-Identifier: GPL-3.0-or-later
#include "Textures.h"

#include <GLFW/glfw3.h>

#include <algorithm>
#include <utility>

namespace vernier::ui {
namespace {

struct Functions {
  void (*GenTextures)(GLsizei, GLuint*);
  void (*DeleteTextures)(GLsizei, const GLuint*);
  void (*BindTexture)(GLenum, GLuint);
  void (*TexParameteri)(GLenum, GLenum, GLint);
  void (*PixelStorei)(GLenum, GLint);
  void (*TexImage2D)(GLenum, GLint, GLint, GLsizei, GLsizei, GLint, GLenum, GLenum, const void*);
  void (*TexSubImage2D)(GLenum, GLint, GLint, GLint, GLsizei, GLsizei, GLenum, GLenum, const void*);
  void (*Viewport)(GLint, GLint, GLsizei, GLsizei);
  void (*ClearColor)(GLfloat, GLfloat, GLfloat, GLfloat);
  void (*Clear)(GLbitfield);
  void (*ReadPixels)(GLint, GLint, GLsizei, GLsizei, GLenum, GLenum, void*);
} gl;
constexpr GLenum kClampToEdge = 0x812F;

template <class F>
bool fill(F& f, const char* name) {
  f = reinterpret_cast<F>(glfwGetProcAddress(name));
  return f != nullptr;
}

}  // namespace

bool Textures::load() {
  return fill(gl.GenTextures, "glGenTextures") && fill(gl.DeleteTextures, "glDeleteTextures") &&
         fill(gl.BindTexture, "glBindTexture") && fill(gl.TexParameteri, "glTexParameteri") &&
         fill(gl.PixelStorei, "glPixelStorei") && fill(gl.TexImage2D, "glTexImage2D") &&
         fill(gl.TexSubImage2D, "glTexSubImage2D") && fill(gl.Viewport, "glViewport") &&
         fill(gl.ClearColor, "glClearColor") && fill(gl.Clear, "glClear") &&
         fill(gl.ReadPixels, "glReadPixels");
}

Textures::~Textures() { clear(); }

void Textures::clear() {
  for (auto& [key, t] : all_) gl.DeleteTextures(1, &t.name);
  all_.clear();
}

std::uint64_t Textures::get(const std::string& key, std::uint64_t number, const Picture& picture) {
  if (picture.width < 1 || picture.height < 1) return 0;
  Texture& t = all_[key];
  t.used = true;
  const GLenum format = picture.channels == 4 ? GL_RGBA : GL_RGB;
  if (t.name == 0) {
    gl.GenTextures(1, &t.name);
    gl.BindTexture(GL_TEXTURE_2D, t.name);
    // 1:1, so that nearest shows the picture's own pixels.
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, kClampToEdge);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, kClampToEdge);
  } else if (t.number == number) {
    return t.name;
  }
  gl.BindTexture(GL_TEXTURE_2D, t.name);
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  if (t.width == picture.width && t.height == picture.height)
    gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, picture.width, picture.height, format, GL_UNSIGNED_BYTE,
                     picture.pixels.data());
  else
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA, picture.width, picture.height, 0, format, GL_UNSIGNED_BYTE,
                  picture.pixels.data());
  t.width = picture.width, t.height = picture.height, t.number = number;
  return t.name;
}

void Textures::sweep() {
  for (auto it = all_.begin(); it != all_.end();) {
    if (std::exchange(it->second.used, false)) {
      ++it;
      continue;
    }
    gl.DeleteTextures(1, &it->second.name);
    it = all_.erase(it);
  }
}

void Textures::beginFrame(int width, int height, float r, float g, float b) {
  gl.Viewport(0, 0, width, height);
  gl.ClearColor(r, g, b, 1);
  gl.Clear(GL_COLOR_BUFFER_BIT);
}

Picture Textures::readBack(int width, int height) {
  Picture bottomUp(width, height);
  gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
  gl.ReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, bottomUp.pixels.data());
  Picture out(width, height);
  const auto row = static_cast<std::size_t>(3 * width);
  for (int y = 0; y < height; ++y) std::copy_n(bottomUp.at(0, height - 1 - y), row, out.at(0, y));
  return out;
}

}  // namespace vernier::ui
