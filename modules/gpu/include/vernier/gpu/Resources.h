// SPDX-License-Identifier: GPL-3.0-or-later
// Owners of GL objects: movable, and safe to drop on any thread and after their Device; the object itself is
// deleted on the render thread, at the Device's next call. Made by Device only.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "vernier/base/Api.h"
#include "vernier/gpu/Draw.h"

namespace vernier::gpu {

class Core;  // the context with its function table
enum class ObjectKind { Texture, Buffer, VertexArray, Program, Framebuffer };

class VERNIER_API Object {
 public:
  Object() = default;
  Object(const std::shared_ptr<Core>& core, ObjectKind kind, unsigned id)
      : core_(core), kind_(kind), id_(id) {}
  Object(Object&& o) noexcept { *this = std::move(o); }
  Object& operator=(Object&& o) noexcept;
  ~Object() { drop(); }
  unsigned id() const { return id_; }

 private:
  void drop();
  std::weak_ptr<Core> core_;
  ObjectKind kind_ = ObjectKind::Texture;
  unsigned id_ = 0;
};

class VERNIER_API Texture {
 public:
  int width() const { return width_; }
  int height() const { return height_; }
  int depth() const { return depth_; }  // 0: a 2-D texture
  Format format() const { return format_; }
  std::uint64_t bytes() const;

 private:
  friend class Device;
  Object object_;
  int width_ = 0, height_ = 0, depth_ = 0;
  Format format_ = Format::R8;
};

// Interleaved floats; attribute n has components[n] of them and is `layout(location = n)`.
class VERNIER_API VertexData {
 public:
  int count() const { return count_; }  // of indices where there are some, else of vertices
  std::uint64_t bytes() const { return bytes_; }

 private:
  friend class Device;
  Object array_, buffer_, indices_;
  int count_ = 0;
  bool indexed_ = false;
  std::uint64_t bytes_ = 0;
};

class VERNIER_API Program {
 public:
  const std::string& name() const { return name_; }

 private:
  friend class Device;
  struct Active {
    std::string name;
    int location = 0;
    unsigned type = 0;
  };
  Object object_;
  std::string name_;
  std::vector<Active> uniforms_, samplers_;
};

// A framebuffer: float colour textures, which later draws may read, and a 24-bit depth buffer if asked for.
class VERNIER_API Target {
 public:
  int width() const { return width_; }
  int height() const { return height_; }
  int colours() const { return static_cast<int>(colours_.size()); }
  bool hasDepth() const { return hasDepth_; }
  const Texture& colour(int n) const { return colours_[static_cast<std::size_t>(n)]; }

 private:
  friend class Device;
  Object object_, depth_;
  std::vector<Texture> colours_;
  int width_ = 0, height_ = 0;
  bool hasDepth_ = false;
};

}  // namespace vernier::gpu
