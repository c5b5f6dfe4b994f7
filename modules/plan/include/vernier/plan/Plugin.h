// SPDX-License-Identifier: GPL-3.0-or-later
// What makes a shared library a Vernier plugin: three C entries, written by VERNIER_PLUGIN. The boundary is
// C++ and same-build: the ABI id is a hash of compiler, standard library, build type, sanitizers and all
// public headers, so that a plugin of another build is refused before any of its C++ code runs.
//
//   Result<void> registerMine(vernier::Host& host) { return host.addTechnique(...); }
//   VERNIER_PLUGIN(registerMine)
#pragma once
#include "vernier/AbiId.h"
#include "vernier/base/Guarded.h"
#include "vernier/plan/Technique.h"

namespace vernier {
// Changes when the meaning of Host or of what it hands over changes.
inline constexpr const char* kPluginInterface = "vernier.technique/2";

extern "C" {
using PluginTextFn = const char* (*)();
// Returns true when all was registered; else fills the error. Never throws.
using PluginRegisterFn = bool (*)(Host* host, Error* error);
}
}  // namespace vernier

#define VERNIER_PLUGIN(registerFunction)                                                                \
  extern "C" VERNIER_API const char* vernier_plugin_abi() { return VERNIER_ABI_ID; }                    \
  extern "C" VERNIER_API const char* vernier_plugin_interface() { return ::vernier::kPluginInterface; } \
  extern "C" VERNIER_API bool vernier_plugin_register(::vernier::Host* host, ::vernier::Error* error) { \
    const auto result = ::vernier::guarded("register", [&] { return registerFunction(*host); });        \
    if (!result) *error = result.error();                                                               \
    return result.ok();                                                                                 \
  }
