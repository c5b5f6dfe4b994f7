// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdio>

#include "vernier/base/Guarded.h"
#include "vernier/base/Result.h"

namespace vernier {
namespace {
struct Row {
  std::string_view name;
  ErrorClass cls;
  int exit;
  std::string_view text;
};
constexpr Row kRows[] = {
#define VERNIER_ERROR(name, cls, exit, text) {#name, ErrorClass::cls, exit, text},
#include "vernier/base/errors.def"
#undef VERNIER_ERROR
};
const Row& row(ErrorCode c) { return kRows[static_cast<std::size_t>(c)]; }
}  // namespace

std::string_view errorName(ErrorCode c) { return row(c).name; }
ErrorClass errorClass(ErrorCode c) { return row(c).cls; }
int exitCode(ErrorCode c) { return row(c).exit; }
std::string_view generalSentence(ErrorCode c) { return row(c).text; }

std::string Error::text() const {
  std::string s = where.empty() ? std::string() : where + ": ";
  s += sentence.empty() ? std::string(generalSentence(code)) : sentence;
  return s + " [" + std::string(errorName(code)) + "]";
}

void assertFailed(const char* expression, const char* file, int line) {
  std::fprintf(stderr, "vernier: assertion failed: %s (%s:%d)\n", expression, file, line);
  std::abort();
}

Error errorFromCurrentException(std::string where) {
  try {
    throw;
  } catch (const std::bad_alloc&) {
    return makeError(ErrorCode::OutOfMemory, "The memory for this step could not be had.", std::move(where));
  } catch (const std::exception& e) {
    return makeError(ErrorCode::Internal, std::string("An unexpected failure: ") + e.what() + ".",
                     std::move(where));
  } catch (...) {
    return makeError(ErrorCode::Internal, "An unexpected failure of unknown kind.", std::move(where));
  }
}

}  // namespace vernier
