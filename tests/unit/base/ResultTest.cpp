// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/base/Result.h"

#include <gtest/gtest.h>

#include <new>
#include <set>
#include <stdexcept>

#include "vernier/base/Guarded.h"

namespace vernier {
namespace {

TEST(Result, HoldsValueOrError) {
  Result<int> good = 7;
  EXPECT_TRUE(good.ok());
  EXPECT_EQ(*good, 7);
  Result<int> bad = makeError(ErrorCode::NotDicom, "It is text.", "a.txt");
  EXPECT_FALSE(bad.ok());
  EXPECT_EQ(bad.error().text(), "a.txt: It is text. [NotDicom]");
  EXPECT_DEATH((void)*bad, "assertion failed");
}

TEST(Errors, ExitCodesFollowTheClass) {
  int count = 0;
#define VERNIER_ERROR(name, cls, exit, text)                                             \
  {                                                                                      \
    ++count;                                                                             \
    EXPECT_EQ(errorName(ErrorCode::name), #name);                                        \
    EXPECT_FALSE(generalSentence(ErrorCode::name).empty());                              \
    const int code = exitCode(ErrorCode::name);                                          \
    EXPECT_EQ(code, exit);                                                               \
    EXPECT_EQ(errorClass(ErrorCode::name) == ErrorClass::Input, code == 3) << #name;     \
    EXPECT_EQ(errorClass(ErrorCode::name) == ErrorClass::Tolerance, code == 4) << #name; \
    EXPECT_TRUE(code >= 1 && code <= 4) << #name;                                        \
  }
#include "vernier/base/errors.def"
#undef VERNIER_ERROR
  EXPECT_GT(count, 20);
}

TEST(Guarded, TurnsExceptionsIntoErrors) {
  auto r = guarded("here", []() -> Result<int> { throw std::bad_alloc(); });
  ASSERT_FALSE(r.ok());
  EXPECT_EQ(r.error().code, ErrorCode::OutOfMemory);
  EXPECT_EQ(r.error().where, "here");
  auto s = guarded("there", []() -> Result<void> { throw std::runtime_error("odd"); });
  ASSERT_FALSE(s.ok());
  EXPECT_EQ(s.error().code, ErrorCode::Internal);
  EXPECT_NE(s.error().sentence.find("odd"), std::string::npos);
  auto t = guarded("x", []() -> Result<int> { throw 3; });
  EXPECT_EQ(t.error().code, ErrorCode::Internal);
}

}  // namespace
}  // namespace vernier
