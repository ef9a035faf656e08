#include "normalshop/surface/convert_space.h"

#include <algorithm>
#include <cassert>
#include <numeric>

#include "normalshop/core/normal_codes.h"
#include "normalshop/core/parallel.h"
#include "normalshop/surface/frames.h"

namespace normalshop {

namespace {

Vec3f convert(const Mesh& mesh, const SurfacePoint& point, const Vec3f& n, NormalSpace from,
              NormalSpace to) {
  const Vec3f object =
      n.isZero() ? base_normal_at(mesh, point) : frame_at(mesh, point, from).object_normal(n);
  return frame_at(mesh, point, to).map_normal(object);
}

}  // namespace

RawImage convert_space(const Mesh& mesh, const TexelMap& texels, const NormalMap& map,
                       const NormalConvention& to, CodeType type) {
  assert(texels.width() == map.width() && texels.height() == map.height());
  const NormalSpace from = map.convention().space;
  const int width = map.width();
  const int channels = codes::normal_channels(to);
  RawImage out(width, map.height(), std::max(map.codes().channels(), channels), type);
  std::vector<int> columns(static_cast<std::size_t>(width));
  std::iota(columns.begin(), columns.end(), 0);
  parallel_for(static_cast<std::size_t>(map.height()), 16, [&](std::size_t a, std::size_t b) {
    std::vector<Vec3f> row(static_cast<std::size_t>(width));
    for (int y = static_cast<int>(a); y < static_cast<int>(b); ++y) {
      map.read_normals(y, row.data());
      for (int x = 0; x < width; ++x) {
        Vec3f& n = row[static_cast<std::size_t>(x)];
        const std::uint32_t owner = texels.owner()(x, y);
        n = owner == no_triangle
                ? Vec3f(0.0F, 0.0F, 1.0F)
                : convert(mesh, texels.surface_point(owner, x, y), n, from, to.space);
      }
      codes::encode_texels(row.data(), width, to, out, 0, y);
      codes::copy_other_channels(map.codes(), y, columns, out, y, channels);
    }
  });
  std::uint32_t done = no_triangle;
  for (const GutterTexel& g : texels.gutter()) {
    if (g.texel == done) continue;  // the owner's entry comes first
    done = g.texel;
    const auto [x, y] = texel_place(g.texel, width);
    const SurfacePoint point{g.owner, g.owner_b1, g.owner_b2};
    const Vec3f n = convert(mesh, point, map.normal(x, y), from, to.space);
    codes::encode_texels(&n, 1, to, out, x, y);
  }
  return out;
}

}  // namespace normalshop
