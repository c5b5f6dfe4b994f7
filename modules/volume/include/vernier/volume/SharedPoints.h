// SPDX-License-Identifier: GPL-3.0-or-later
// A list of points, mm of a lens or mesh's own frame, that its copies share: a copy costs nothing however
// many there are, and who changes one has a list of its own from there on. Lists of one origin are known to
// be equal without a look at the points. As thread-safe as a std::vector.
#pragma once
#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "vernier/volume/Mesh.h"

namespace vernier {

class SharedPoints {
 public:
  SharedPoints() = default;
  SharedPoints(std::vector<MeshPoint> points)
      : points_(std::make_shared<std::vector<MeshPoint>>(std::move(points))) {}

  std::size_t size() const { return points_ ? points_->size() : 0; }
  bool empty() const { return size() == 0; }
  const MeshPoint* data() const { return points_ ? points_->data() : nullptr; }
  const MeshPoint* begin() const { return data(); }
  const MeshPoint* end() const { return data() + size(); }
  const MeshPoint& operator[](std::size_t n) const { return data()[n]; }
  operator std::span<const MeshPoint>() const { return {data(), size()}; }

  // One of the list's own, to be changed.
  std::vector<MeshPoint>& own() {
    if (!points_)
      points_ = std::make_shared<std::vector<MeshPoint>>();
    else if (points_.use_count() > 1)
      points_ = std::make_shared<std::vector<MeshPoint>>(*points_);
    return *points_;
  }
  template <class... Args>
  void emplace_back(Args&&... args) {
    own().emplace_back(std::forward<Args>(args)...);
  }
  void push_back(const MeshPoint& p) { own().push_back(p); }

  // Are they one list? The same numbers in two lists are not.
  bool isSame(const SharedPoints& other) const { return points_ == other.points_; }
  // Which list it is; of another one once all that share it are gone.
  const void* identity() const { return points_.get(); }
  friend bool operator==(const SharedPoints& a, const SharedPoints& b) {
    if (a.isSame(b)) return true;
    if (a.size() != b.size()) return false;
    for (std::size_t n = 0; n < a.size(); ++n)
      if (!(a[n] == b[n])) return false;
    return true;
  }

 private:
  std::shared_ptr<std::vector<MeshPoint>> points_;
};

}  // namespace vernier
