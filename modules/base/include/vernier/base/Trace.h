// SPDX-License-Identifier: GPL-3.0-or-later
// Spans in Chrome's trace format (--trace FILE). Off until traceStart(); then a TraceSpan costs two clock
// reads and one locked append. Thread-safe.
#pragma once
#include <cstdint>
#include <string>

#include "vernier/base/Api.h"
#include "vernier/base/Result.h"

namespace vernier {

VERNIER_API void traceStart();
VERNIER_API Result<void> traceWrite(const std::string& path);  // what was recorded since traceStart()

class VERNIER_API TraceSpan {
 public:
  explicit TraceSpan(const char* name);  // name: a literal
  ~TraceSpan();
  TraceSpan(const TraceSpan&) = delete;
  TraceSpan& operator=(const TraceSpan&) = delete;

 private:
  const char* name_;
  std::int64_t begin_us_;
};

}  // namespace vernier
