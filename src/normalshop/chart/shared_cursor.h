#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "normalshop/surface/texel_map.h"

/// Tells which texels further triangles cover, private to floor 4.
namespace normalshop {

/// Looks up rising texels in TexelMap::shared(), each at the price of how far it lies from the one
/// before.
class SharedCursor {
 public:
  explicit SharedCursor(const std::vector<SharedTexel>& shared) : shared_(shared) {}

  /// `texel` is none before that of the last call.
  bool holds(std::uint32_t texel) {
    const auto before = [texel](const SharedTexel& s) { return s.texel < texel; };
    std::size_t step = 1;
    while (at_ + step < shared_.size() && before(shared_[at_ + step])) {
      at_ += step;
      step *= 2;
    }
    const auto begin = shared_.begin();
    const auto end = begin + static_cast<std::ptrdiff_t>(std::min(at_ + step + 1, shared_.size()));
    const auto found = std::partition_point(begin + static_cast<std::ptrdiff_t>(at_), end, before);
    at_ = static_cast<std::size_t>(found - begin);
    return found != shared_.end() && found->texel == texel;
  }

 private:
  const std::vector<SharedTexel>& shared_;
  std::size_t at_ = 0;
};

}  // namespace normalshop
