// SPDX-License-Identifier: GPL-3.0-or-later
// Where a GL context comes from. OSMesa is the first source; a hidden GLFW window and EGL can stand beside it
// without touching anything else, since all that the Device needs is here.
#pragma once
#include <memory>
#include <string>

#include "vernier/base/Api.h"
#include "vernier/base/Result.h"

namespace vernier::gpu {

class GlContext {
 public:
  using Proc = void (*)();
  virtual ~GlContext() = default;
  virtual Result<void> makeCurrent() = 0;  // on the calling thread
  virtual void release() = 0;              // of the calling thread
  virtual Proc proc(const char* name) const = 0;
};

// OpenGL 3.3 core by OSMesa. library: "" tries the usual names. Exported for tests, which put faults in
// between.
VERNIER_API Result<std::unique_ptr<GlContext>> makeOsMesaContext(const std::string& library);

}  // namespace vernier::gpu
