// SPDX-License-Identifier: GPL-3.0-or-later
// The GL device of a test program. Where OSMesa is missing, a test that needs GL says so and passes, unless
// VERNIER_REQUIRE_GL is set: then it fails (`./dev test` sets it).
#pragma once
#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>
#include <memory>

#include "vernier/gpu/Device.h"

namespace vernier::test {

inline gpu::Device* glDevice() {
  static const Result<std::unique_ptr<gpu::Device>> device = gpu::Device::make();
  if (device) return device->get();
  const char* required = std::getenv("VERNIER_REQUIRE_GL");
  if (required && *required)
    ADD_FAILURE() << "VERNIER_REQUIRE_GL is set: " << device.error().text();
  else
    std::cout << "[  NOTE    ] " << device.error().text() << ": not checked\n";
  return nullptr;
}

}  // namespace vernier::test

#define VERNIER_NEEDS_GL(device)                                  \
  vernier::gpu::Device* const device = vernier::test::glDevice(); \
  if (!device) return
