// SPDX-License-Identifier: GPL-3.0-or-later
// Textures and vertex data that outlive a frame, keyed by what they were made of; least recently used ones go
// when the byte limit is passed. What is in use lives on while somebody holds it. For the render thread only.
#pragma once
#include <compare>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <string>

#include "vernier/base/Api.h"
#include "vernier/base/Result.h"
#include "vernier/base/Revision.h"
#include "vernier/gpu/Resources.h"

namespace vernier::gpu {

class VERNIER_API DeviceCache {
 public:
  explicit DeviceCache(std::uint64_t limit_bytes) : limit_(limit_bytes) {}
  struct Key {
    std::string kind;        // "slice r16"; one kind always means one type
    Revision source = 0;     // of the volume or the mesh
    std::int64_t index = 0;  // slice number, 0 for a whole volume
    friend auto operator<=>(const Key&, const Key&) = default;
  };
  Result<std::shared_ptr<const Texture>> get(const Key&, const std::function<Result<Texture>()>& make);
  Result<std::shared_ptr<const VertexData>> vertices(const Key&,
                                                     const std::function<Result<VertexData>()>& make);
  std::uint64_t bytes() const { return bytes_; }
  std::uint64_t limit() const { return limit_; }
  void setLimit(std::uint64_t limit_bytes);  // drops what no longer fits

 private:
  struct Entry {
    Key key;
    std::shared_ptr<const void> thing;
    std::uint64_t bytes;
  };
  template <class T>
  Result<std::shared_ptr<const T>> any(const Key&, const std::function<Result<T>()>& make);
  void trim(std::uint64_t toBytes);
  std::uint64_t limit_, bytes_ = 0;
  std::list<Entry> entries_;  // most recently used first
  std::map<Key, std::list<Entry>::iterator> index_;
};

}  // namespace vernier::gpu
