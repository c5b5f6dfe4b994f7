// SPDX-License-Identifier: GPL-3.0-or-later
// DerivedCache: the one home of derived data (bricks, histograms, meshes...), keyed by kind, revision of its
// source and parameters; least recently used entries go when the byte limit is passed. Values are shared and
// immutable: an entry that was evicted lives on while somebody holds it. Thread-safe; `make` runs outside the
// lock, so two threads may make the same thing at once and the first one stays.
#pragma once
#include <any>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "vernier/base/Api.h"
#include "vernier/base/Result.h"
#include "vernier/base/Revision.h"

namespace vernier {

class VERNIER_API DerivedCache {
 public:
  explicit DerivedCache(std::uint64_t limit_bytes);

  struct Key {
    std::string kind;
    Revision source = 0;
    std::string parameters;
    friend auto operator<=>(const Key&, const Key&) = default;
  };
  template <class T>
  struct Made {
    std::shared_ptr<const T> value;
    std::uint64_t bytes = 0;
  };

  // One kind always means one type T.
  template <class T>
  Result<std::shared_ptr<const T>> get(const Key& key, const std::function<Result<Made<T>>()>& make) {
    if (std::shared_ptr<const void> hit = find(key)) return std::static_pointer_cast<const T>(hit);
    Result<Made<T>> fresh = make();
    if (!fresh) return fresh.error();
    return std::static_pointer_cast<const T>(insert(key, fresh->value, fresh->bytes));
  }
  std::uint64_t bytes() const;
  // How often something was made because it was not there, for as long as the cache lives; for tests.
  std::uint64_t made() const;
  std::uint64_t limit() const { return limit_; }

 private:
  struct Entry {
    Key key;
    std::shared_ptr<const void> value;
    std::uint64_t bytes;
  };
  std::shared_ptr<const void> find(const Key&);
  std::shared_ptr<const void> insert(const Key&, std::shared_ptr<const void>, std::uint64_t bytes);

  mutable std::mutex mutex_;
  std::uint64_t limit_;
  std::uint64_t bytes_ = 0, made_ = 0;
  std::list<Entry> entries_;  // most recently used first
  std::map<Key, std::list<Entry>::iterator> index_;
};

}  // namespace vernier
