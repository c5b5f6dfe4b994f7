// SPDX-License-Identifier: GPL-3.0-or-later
// The context, its function table, and the graveyard of GL objects whose owners went.
#pragma once
#include <glad/gl.h>

#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "GlContext.h"
#include "vernier/base/Revision.h"
#include "vernier/gpu/Resources.h"

namespace vernier::gpu {

class Core {
 public:
  explicit Core(std::unique_ptr<GlContext> c) : context(std::move(c)) {}
  ~Core();
  // Two devices on one thread take turns: the one that is called makes itself current.
  Result<void> makeCurrent();
  void release();
  Result<void> load();                 // fills the table; the context is current
  void bury(ObjectKind, unsigned id);  // any thread
  void deleteBuried();                 // render thread

  std::unique_ptr<GlContext> context;
  GladGLContext gl{};
  std::thread::id owner;  // none: released

 private:
  struct Dead {
    ObjectKind kind;
    unsigned id;
  };
  const Revision id_ = nextRevision();
  std::mutex mutex_;
  std::vector<Dead> dead_;
};

struct FormatInfo {
  GLint internal;
  GLenum layout, type;
  int components;
  std::size_t bytes;
};
FormatInfo infoOf(Format);

}  // namespace vernier::gpu
