// SPDX-License-Identifier: GPL-3.0-or-later
#include <zlib.h>

#include <algorithm>
#include <limits>

#include "decode/Codecs.h"
#include "vernier/study/Limits.h"

namespace vernier::study {
namespace {

struct Stream {
  z_stream z{};
  bool ready = false;
  Stream() { ready = inflateInit2(&z, -MAX_WBITS) == Z_OK; }
  ~Stream() {
    if (ready) inflateEnd(&z);
  }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
};

}  // namespace

Result<std::vector<std::byte>> inflateAll(ByteSpan deflated) {
  Stream s;
  if (!s.ready) return makeError(ErrorCode::OutOfMemory, "There is no memory to inflate the data set.");
  if (deflated.size() > std::numeric_limits<uInt>::max())
    return makeError(ErrorCode::LimitExceeded, "The deflated data set is larger than 4 GiB.");
  // A small data set may be packed denser than the ratio allows.
  const std::uint64_t cap =
      std::min(limits::kMaxInflatedBytes,
               std::max(limits::kAlwaysInflatedBytes, deflated.size() * limits::kMaxInflateRatio));
  s.z.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(deflated.data()));
  s.z.avail_in = static_cast<uInt>(deflated.size());
  std::vector<std::byte> out;
  for (;;) {
    const std::size_t have = out.size();
    if (have >= cap)
      return makeError(ErrorCode::LimitExceeded, "The deflated data set grows beyond " +
                                                     std::to_string(limits::kMaxInflateRatio) +
                                                     " times its size, or beyond 2 GiB; it is refused.");
    const std::uint64_t step = std::min<std::uint64_t>(std::max<std::uint64_t>(have, 64 << 10), cap - have);
    out.resize(have + step);
    s.z.next_out = reinterpret_cast<Bytef*>(out.data() + have);
    s.z.avail_out = static_cast<uInt>(step);
    const int code = ::inflate(&s.z, Z_NO_FLUSH);
    out.resize(have + step - s.z.avail_out);
    if (code == Z_STREAM_END) return out;
    if (code != Z_OK || (s.z.avail_in == 0 && s.z.avail_out != 0))
      return makeError(ErrorCode::FileDamaged,
                       "The deflated data is cut short or damaged; fetch the file again from its source.");
  }
}

}  // namespace vernier::study
