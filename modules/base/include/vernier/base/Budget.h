// SPDX-License-Identifier: GPL-3.0-or-later
// MemoryBudget: bytes that the session may hold in host memory (default: half of what is free). Thread-safe.
// A reservation is released when its handle goes.
#pragma once
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "vernier/base/Api.h"
#include "vernier/base/Result.h"

namespace vernier {

class VERNIER_API MemoryBudget {
 public:
  explicit MemoryBudget(std::uint64_t limit_bytes);
  static std::uint64_t halfOfFreeBytes();  // from /proc/meminfo MemAvailable; 1 GiB when unknown

  class VERNIER_API Reservation {
   public:
    Reservation() = default;
    Reservation(Reservation&& o) noexcept;
    Reservation& operator=(Reservation&& o) noexcept;
    ~Reservation();
    std::uint64_t bytes() const { return bytes_; }

   private:
    friend class MemoryBudget;
    std::shared_ptr<std::atomic<std::uint64_t>> used_;  // outlives the budget while anything is reserved
    std::uint64_t bytes_ = 0;
  };

  // OutOfMemory with the numbers (asked, used, limit) when it does not fit. A reservation may outlive its
  // budget.
  Result<Reservation> reserve(std::uint64_t bytes, const std::string& what);
  std::uint64_t used() const { return used_->load(); }
  std::uint64_t limit() const { return limit_; }

 private:
  std::uint64_t limit_;
  std::shared_ptr<std::atomic<std::uint64_t>> used_ = std::make_shared<std::atomic<std::uint64_t>>(0);
};

}  // namespace vernier
