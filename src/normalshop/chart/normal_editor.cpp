#include "normalshop/chart/normal_editor.h"

#include <algorithm>

#include <Eigen/LU>

#include "normalshop/chart/visible_weight.h"
#include "normalshop/core/normal_codes.h"

namespace normalshop {

bool NormalEditor::edit(TexelLanes& lanes) const {
  if (!read_visible_weight(sampler_.reach(), lanes.batch)) return false;
  if (!sampler_.read_weighed(lanes.batch)) return false;
  read_stored(before_, lanes);
  apply_to(lanes);
  return true;
}

bool NormalEditor::edit_weighed(TexelLanes& lanes) const {
  if (!sampler_.read_weighed(lanes.batch)) return false;
  apply_to(lanes);
  return true;
}

void NormalEditor::apply_to(TexelLanes& lanes) const {
  fill_frames(mesh_, sampler_.grid().view, space_, lanes.triangles, lanes.batch);
  apply(sampler_.direction(), lanes.batch);
}

namespace {

std::uint32_t decoding_triangle(const GutterTexel& g) { return g.owner; }
std::uint32_t decoding_triangle(const SharedTexel& s) { return s.triangle; }

const std::vector<GutterTexel>& list_of(const TexelMap& texels, const GutterTexel&) {
  return texels.gutter();
}
const std::vector<SharedTexel>& list_of(const TexelMap& texels, const SharedTexel&) {
  return texels.shared();
}

}  // namespace

template <class Item>
void NormalEditor::collect(const TexelBatch& batch, const PerLane<const Item*>& items,
                           std::vector<TexelWrite>& out) const {
  for (int i = 0; i < batch.count; ++i) {
    if (!batch.acts(i)) continue;
    const Item& item = *items[static_cast<std::size_t>(i)];
    out.push_back(write_of(batch, i, item.texel, decoding_triangle(item)));
    out.back().rank = static_cast<std::uint32_t>(1 + (&item - list_of(texels_, item).data()));
  }
}

/// The texel's vector; codes without a direction count as the base normal.
Vec3f NormalEditor::own_vector(int x, int y, const Vec3f& base, const Mat3f& frame) const {
  Vec3f stored = before_.vector(x, y);
  if (!codes::direction_of(stored).isZero()) return stored;
  if (space_ == NormalSpace::Tangent) return Vec3f::UnitZ();
  return frame.inverse() * base;
}

/// What a gutter texel held before the edit, in its own frame. Where the edit is weak that is its
/// code; the stronger it is, the more the texel is grown anew from the surface that it stands for:
/// else a filter would leave there what it takes away on the other side of the seam.
Vec3f NormalEditor::gutter_vector(const GutterTexel& g, const Mat3f& frame, const Vec3f& own,
                                  const PushTriangle& source, float strength) const {
  if (g.hard_edge || g.source.triangle == g.owner) return own;
  const Vec3f weights(1.0F, g.source.b1, g.source.b2);
  const std::size_t corner = 3 * static_cast<std::size_t>(g.source.triangle);
  const Vec2f uv = interpolate(mesh_.uvs[corner], mesh_.uvs[corner + 1], mesh_.uvs[corner + 2],
                               g.source.b1, g.source.b2);
  const Mat3f across =
      source.frame(weights, source.normals * weights, space_, sampler_.grid().view);
  const Vec3f grown = frame.inverse() *
                      (across * before_.sample(reading_place(mesh_, mesh_.texture_sets[g.owner], uv,
                                                             before_.width(), before_.height())));
  if (!grown.allFinite() || grown.isZero()) return own;
  constexpr float strong = 0.05F;  // a slope of three degrees
  const float share = std::min(1.0F, strength / strong);
  return (1.0F - share) * own.normalized() + share * grown.normalized();
}

void NormalEditor::edit_gutter(const PerLane<const GutterTexel*>& items, Triangles& triangles,
                               TexelBatch& batch, std::vector<TexelWrite>& out) const {
  if (!sampler_.read(batch)) return;
  for (int i = 0; i < batch.count; ++i) {
    if (!batch.acts(i)) continue;
    const auto k = static_cast<std::size_t>(i);
    const GutterTexel& g = *items[k];
    const PushTriangle source = triangles.get(gutter_source(g).triangle);
    const PushTriangle& owner = triangles.get(g.owner);
    const Vec3f weights(1.0F, g.owner_b1, g.owner_b2);
    const Mat3f frame = owner.frame(weights, owner.normals * weights, space_, sampler_.grid().view);
    batch.set_frame(i, frame);
    const auto [x, y] = texel_place(g.texel, texels_.width());
    const float strength = Vec2f(batch.change_x[k], batch.change_y[k]).norm() + batch.covered[k];
    const Vec3f own = own_vector(x, y, batch.base.get(i), frame);
    batch.stored.set(i, gutter_vector(g, frame, own, source, strength));
  }
  apply(sampler_.direction(), batch);
  collect(batch, items, out);
}

void NormalEditor::edit_shared(const PerLane<const SharedTexel*>& items, TexelBatch& batch,
                               std::vector<TexelWrite>& out) const {
  PerLane<std::uint32_t> ids{};
  for (int i = 0; i < batch.count; ++i) {
    const SharedTexel& s = *items[static_cast<std::size_t>(i)];
    ids[static_cast<std::size_t>(i)] = s.triangle;
    const auto [x, y] = texel_place(s.texel, texels_.width());
    batch.stored.set(i, before_.vector(x, y));
  }
  fill_frames(mesh_, sampler_.grid().view, space_, ids, batch);
  apply(sampler_.direction(), batch);
  collect(batch, items, out);
}

}  // namespace normalshop
