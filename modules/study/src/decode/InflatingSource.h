// SPDX-License-Identifier: GPL-3.0-or-later
// A deflated data set (PS3.5 A.5) read as a stream: nothing is kept but a small window, so that the frames of
// a large object can be taken out one after the other without holding it inflated. Reading before the window
// starts over. Limits as inflateAll(). Not shared between threads.
#pragma once
#include <memory>
#include <optional>

#include "decode/Source.h"

namespace vernier::study {

class InflatingSource final : public Source {
 public:
  // `file` must outlive this; the data set begins at `dataSet` and is deflated to the end of the file.
  InflatingSource(Source& file, std::uint64_t dataSet);
  ~InflatingSource() override;
  // The greatest size allowed until the end was met, then the true one.
  std::uint64_t size() const override;
  bool read(std::uint64_t offset, std::span<std::byte> to) override;
  std::span<const std::byte> view(std::uint64_t offset, std::uint64_t n,
                                  std::vector<std::byte>& scratch) override;
  // Why a read failed, when the stream itself is damaged or too large.
  const std::optional<Error>& failure() const { return failure_; }

 private:
  struct Stream;
  void restart();
  bool more();  // inflates the next piece

  Source& file_;
  std::uint64_t dataSet_, packedAt_ = 0;
  std::unique_ptr<Stream> stream_;
  std::vector<std::byte> packed_;  // the piece of the file that is being inflated
  std::vector<std::byte> window_;  // inflated bytes [windowStart_, windowStart_ + size)
  std::uint64_t windowStart_ = 0;
  bool ended_ = false;
  std::optional<std::uint64_t> end_;
  std::optional<Error> failure_;
};

}  // namespace vernier::study
