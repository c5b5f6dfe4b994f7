// SPDX-License-Identifier: GPL-3.0-or-later
// guarded(where, fn): runs fn and turns an escaping exception into an Error (std::bad_alloc -> OutOfMemory,
// anything else -> Internal with the exception's text). Stands at every border with a library or a plugin.
#pragma once
#include <exception>
#include <new>
#include <string>
#include <type_traits>
#include <utility>

#include "vernier/base/Result.h"

namespace vernier {

VERNIER_API Error errorFromCurrentException(std::string where);

template <class Fn>
auto guarded(std::string where, Fn&& fn) -> std::invoke_result_t<Fn> {
  try {
    return std::forward<Fn>(fn)();
  } catch (...) {
    return errorFromCurrentException(std::move(where));
  }
}

}  // namespace vernier
