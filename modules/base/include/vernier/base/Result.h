// SPDX-License-Identifier: GPL-3.0-or-later
// Result<T>: a value or an Error. Data, file, plugin, shader and device failures travel as values; caller
// bugs hit VERNIER_ASSERT. No exception crosses a plugin entry or a GL callback: see Guarded.h.
#pragma once
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "vernier/base/Api.h"

namespace vernier {

enum class ErrorCode {
#define VERNIER_ERROR(name, cls, exit, text) name,
#include "vernier/base/errors.def"
#undef VERNIER_ERROR
};

enum class ErrorClass { Input, Usage, Resource, Device, Plugin, Internal, Tolerance };

VERNIER_API std::string_view errorName(ErrorCode);
VERNIER_API ErrorClass errorClass(ErrorCode);
VERNIER_API int exitCode(ErrorCode);
VERNIER_API std::string_view generalSentence(ErrorCode);

// sentence: what happened, what was expected and got, and the next step; one sentence or two short ones,
// never with a patient's value in it. where: a file name as the user gave it, a tag, a JSON path or a
// function; may be empty.
struct Error {
  ErrorCode code = ErrorCode::Internal;
  std::string sentence;
  std::string where;
  // "where: sentence [Code]"
  VERNIER_API std::string text() const;
};

[[noreturn]] VERNIER_API void assertFailed(const char* expression, const char* file, int line);
#define VERNIER_ASSERT(x) ((x) ? static_cast<void>(0) : ::vernier::assertFailed(#x, __FILE__, __LINE__))

template <class T = void>
class [[nodiscard]] Result;

template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : v_(std::in_place_index<0>, std::move(value)) {}  // NOLINT(google-explicit-constructor)
  Result(Error error) : v_(std::in_place_index<1>, std::move(error)) {}  // NOLINT
  bool ok() const { return v_.index() == 0; }
  explicit operator bool() const { return ok(); }
  T& value() & {
    VERNIER_ASSERT(ok());
    return std::get<0>(v_);
  }
  const T& value() const& {
    VERNIER_ASSERT(ok());
    return std::get<0>(v_);
  }
  T&& value() && {
    VERNIER_ASSERT(ok());
    return std::get<0>(std::move(v_));
  }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }
  const Error& error() const {
    VERNIER_ASSERT(!ok());
    return std::get<1>(v_);
  }

 private:
  std::variant<T, Error> v_;
};

template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)), ok_(false) {}  // NOLINT(google-explicit-constructor)
  bool ok() const { return ok_; }
  explicit operator bool() const { return ok_; }
  const Error& error() const {
    VERNIER_ASSERT(!ok_);
    return error_;
  }

 private:
  Error error_;
  bool ok_ = true;
};

inline Error makeError(ErrorCode code, std::string sentence, std::string where = {}) {
  return Error{code, std::move(sentence), std::move(where)};
}

}  // namespace vernier
