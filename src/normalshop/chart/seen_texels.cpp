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

}  // namespace

void append_seen(const EditReach& everywhere, TexelLanes& lanes, std::vector<SeenTexels>& seen) {
  TexelBatch& batch = lanes.batch;
  if (!read_visible_weight(everywhere, batch)) return;
  for (int i = 0; i < batch.count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (!(batch.weight[k] > 0.0F)) continue;
    if (seen.empty() || seen.back().count == SeenTexels::capacity) seen.emplace_back();
    SeenTexels& s = seen.back();
    const auto at = static_cast<std::size_t>(s.count++);
    s.texels[at] = lanes.texels[k];
    s.triangles[at] = lanes.triangles[k];
    const float x = s.x[at] = batch.point.x[k];
    const float y = s.y[at] = batch.point.y[k];
    s.left = at == 0 ? x : std::min(s.left, x);
    s.right = at == 0 ? x : std::max(s.right, x);
    s.top = at == 0 ? y : std::min(s.top, y);
    s.bottom = at == 0 ? y : std::max(s.bottom, y);
    s.weight[at] = batch.weight[k];
    s.sign[at] = batch.sign[k];
    set(s.base, at, batch.base.get(i));
    set(s.tangent, at, batch.tangent.get(i));
  }
}

bool SeenTexels::load(const EditReach& reach, TexelLanes& lanes) const {
  TexelBatch& batch = lanes.batch;
  batch.count = count;
  bool any = false;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const bool marked = reach.marked(x[i], y[i]);
    batch.weight[i] = marked ? weight[i] : 0.0F;
    any = any || marked;
  }
  if (!any) return false;
  lanes.texels = texels;
  lanes.triangles = triangles;
  copy(x, count, batch.point.x);
  copy(y, count, batch.point.y);
  copy(sign, count, batch.sign);
  copy(base, count, batch.base);
  copy(tangent, count, batch.tangent);
  batch.normal = batch.base;
  return true;
}

}  // namespace normalshop
