#include "normalshop/chart/seen_texels.h"

#include <algorithm>

#include "normalshop/chart/visible_weight.h"

namespace normalshop {

namespace {

void copy(const SeenTexels::Lane& from, int count, TexelBatch::Lane& to) {
  std::copy_n(from.begin(), count, to.begin());
}

void copy(const std::array<SeenTexels::Lane, 3>& from, int count, TexelBatch::Vectors& to) {
  copy(from[0], count, to.x);
  copy(from[1], count, to.y);
  copy(from[2], count, to.z);
}

void set(std::array<SeenTexels::Lane, 3>& lanes, std::size_t at, const Vec3f& v) {
  lanes[0][at] = v.x();
  lanes[1][at] = v.y();
  lanes[2][at] = v.z();
}

Vec3f get(const std::array<SeenTexels::Lane, 3>& lanes, std::size_t at) {
  return {lanes[0][at], lanes[1][at], lanes[2][at]};
}

/// Makes room for one more within the box.
std::size_t grow(SeenTexels& s, float x, float y) {
  const auto at = static_cast<std::size_t>(s.count++);
  s.x[at] = x;
  s.y[at] = y;
  s.left = at == 0 ? x : std::min(s.left, x);
  s.right = at == 0 ? x : std::max(s.right, x);
  s.top = at == 0 ? y : std::min(s.top, y);
  s.bottom = at == 0 ? y : std::max(s.bottom, y);
  return at;
}

}  // namespace

void SeenTexels::append(const SeenTexels& from, int i) {
  const auto k = static_cast<std::size_t>(i);
  const std::size_t at = grow(*this, from.x[k], from.y[k]);
  places[at] = from.places[k];
  triangles[at] = from.triangles[k];
  weight[at] = from.weight[k];
  sign[at] = from.sign[k];
  set(base, at, get(from.base, k));
  set(tangent, at, get(from.tangent, k));
  set(stored, at, get(from.stored, k));
}

void SeenTile::add(TexelLanes& lanes, std::deque<SeenTexels>& seen) {
  TexelBatch& batch = lanes.batch;
  if (!read_visible_weight(everywhere_, batch)) return;
  read_stored(map_, lanes);
  const int band = texel_place(lanes.texels[0], map_.width()).y / side;
  if (band != band_) finish(seen);
  band_ = band;
  for (int i = 0; i < batch.count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (!(batch.weight[k] > 0.0F)) continue;
    const auto [x, y] = texel_place(lanes.texels[k], map_.width());
    SeenTexels& s = squares_[static_cast<std::size_t>(x % NormalMap::tile_size / side)];
    const std::size_t at = grow(s, batch.point.x[k], batch.point.y[k]);
    s.places[at] = static_cast<std::uint16_t>(NormalMap::index_in_tile(x, y));
    s.triangles[at] = lanes.triangles[k];
    s.weight[at] = batch.weight[k];
    s.sign[at] = batch.sign[k];
    set(s.base, at, batch.base.get(i));
    set(s.tangent, at, batch.tangent.get(i));
    set(s.stored, at, batch.stored.get(i));
  }
}

void SeenTile::finish(std::deque<SeenTexels>& seen) {
  for (SeenTexels& square : squares_) {
    for (int i = 0; i < square.count; ++i) {
      if (seen.empty() || seen.back().count == SeenTexels::capacity) seen.emplace_back();
      seen.back().append(square, i);
    }
    square.count = 0;
  }
}

bool SeenTexels::load(const EditReach& reach, TexelLanes& lanes) const {
  TexelBatch& batch = lanes.batch;
  batch.count = count;
  switch (reach.marks(left, top, right, bottom)) {
    case EditReach::Marks::None:
      return false;
    case EditReach::Marks::All:
      copy(weight, count, batch.weight);
      break;
    case EditReach::Marks::Some:
      for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
        batch.weight[i] = reach.marked(x[i], y[i]) ? weight[i] : 0.0F;
      }
      break;
  }
  lanes.triangles = triangles;
  copy(x, count, batch.point.x);
  copy(y, count, batch.point.y);
  copy(sign, count, batch.sign);
  copy(base, count, batch.base);
  copy(base, count, batch.normal);
  copy(tangent, count, batch.tangent);
  copy(stored, count, batch.stored);
  return true;
}

}  // namespace normalshop
