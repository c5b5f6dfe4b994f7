// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/study/FrameSpec.h"

#include "vernier/base/Checked.h"
#include "vernier/study/Limits.h"

namespace vernier {

std::uint64_t bytesOf(SampleType t) {
  switch (t) {
    case SampleType::U8:
    case SampleType::I8: return 1;
    case SampleType::U16:
    case SampleType::I16: return 2;
    case SampleType::U32:
    case SampleType::I32:
    case SampleType::F32: return 4;
    case SampleType::F64: return 8;
  }
  return 0;
}

Result<std::uint64_t> FrameSpec::frameBytes() const {
  const auto n = checkedProduct({rows, columns, samplesPerPixel, bytesOf(sample)});
  if (!n || *n > limits::kMaxDecodedFrameBytes)
    return makeError(ErrorCode::LimitExceeded, "One frame would need more memory than the limit of " +
                                                   std::to_string(limits::kMaxDecodedFrameBytes >> 20) + " MiB.");
  return *n;
}

Result<std::uint64_t> FrameSpec::outputBytes() const {
  const Result<std::uint64_t> one = frameBytes();
  if (!one) return one;
  const auto n = checkedProduct({*one, frameCount});
  if (!n) return makeError(ErrorCode::LimitExceeded, "The frames asked for need more memory than can be counted.");
  return *n;
}

}  // namespace vernier
