#include "chart_fixtures.h"

#include <cmath>

#include "support/meshes.h"

#include "normalshop/core/random.h"

namespace normalshop::test {

Mesh smooth_sphere(int segments, int rings) {
  Mesh mesh = uv_sphere(segments, rings);
  for (std::size_t i = 0; i < mesh.corner_count(); ++i) {
    const Vec3f& n = mesh.normals[i];
    const float length = std::hypot(n.x(), n.z());
    if (length > 0.0F) mesh.tangents[i].head<3>() = Vec3f(n.z(), 0.0F, -n.x()) / length;
  }
  return mesh;
}

NormalMap noise_map(int size, CodeType type, std::uint32_t seed, float tilt) {
  RawImage codes(size, size, 3, type);
  NormalConvention convention;
  convention.signed_float = true;
  const CodeRange range = code_range(type, convention);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const std::uint32_t h =
          hash(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), seed);
      const auto signed_part = [&](std::uint32_t shift) {
        return tilt * (static_cast<float>((h >> shift) & 1023U) / 511.5F - 1.0F);
      };
      const Vec3f n = Vec3f(signed_part(0), signed_part(10), 1.0F).normalized();
      for (int c = 0; c < 3; ++c) {
        const float code = (n[c] - range.offset) / range.scale;
        if (type == CodeType::U8) {
          codes.row<std::uint8_t>(y)[3 * x + c] = static_cast<std::uint8_t>(code + 0.5F);
        } else if (type == CodeType::U16) {
          codes.row<std::uint16_t>(y)[3 * x + c] = static_cast<std::uint16_t>(code + 0.5F);
        } else {
          codes.row<float>(y)[3 * x + c] = code;
        }
      }
    }
  }
  return {std::move(codes), convention};
}

StorageAtlas storage_of(const Mesh& mesh, NormalMap map) {
  StorageAtlas storage;
  StorageSet set;
  set.texels = TexelMap(mesh, 0, map.width(), map.height());
  set.normals = std::move(map);
  set.albedo = ColorMap(Vec3f::Constant(0.5F));
  storage.sets.push_back(std::move(set));
  return storage;
}

StorageAtlas storage_of(const Mesh& mesh, int size, NormalSpace space, const NormalAt& normal) {
  RawImage codes(size, size, 3, CodeType::F32);
  NormalConvention convention;
  convention.space = space;
  convention.signed_float = true;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) Eigen::Map<Vec3f>(codes.row<float>(y) + 3 * x).setUnit(2);
  }
  const auto store = [&](std::uint32_t texel, const SurfacePoint& frame, const SurfacePoint& at) {
    const Vec3f n = frame_at(mesh, frame, space).map_normal(normal(position_at(mesh, at)));
    float* row = codes.row<float>(static_cast<int>(texel) / size);
    Eigen::Map<Vec3f>(row + 3 * (static_cast<int>(texel) % size)) = n;
  };
  StorageAtlas storage = storage_of(mesh, flat_normal_map(size, size, CodeType::U8));
  for_texels(storage, [&](int x, int y, const SurfacePoint& p) {
    store(static_cast<std::uint32_t>(y * size + x), p, p);
  });
  const std::vector<GutterTexel>& gutter = storage.sets[0].texels.gutter();
  for (std::size_t i = 0; i < gutter.size(); ++i) {
    const GutterTexel& g = gutter[i];
    if (i > 0 && gutter[i - 1].texel == g.texel) continue;
    store(g.texel, {g.owner, g.owner_b1, g.owner_b2}, g.source);
  }
  storage.sets[0].normals = NormalMap(std::move(codes), convention);
  return storage;
}

EditingChart chart_from(const Mesh& mesh, const StorageAtlas& storage, const Vec3f& direction,
                        int side, const EffectiveOptions& options) {
  const View view = framing_view(mesh, direction);
  const float pixel = std::max(view.width, view.height) / static_cast<float>(side);
  EditingChart chart = pull(mesh, storage, make_grid(view, pixel));
  compute_weight(chart, options);
  return chart;
}

ChartEdit EditImages::edit(const EditDirection& direction) const {
  ChartEdit out;
  out.direction = direction;
  out.change = change;
  out.coverage = coverage;
  out.region = change.rect();
  return out;
}

EditImages constant_edit(const EditingChart& chart, const Vec2f& change, float coverage) {
  EditImages out;
  out.change = SlopeImage(chart.grid.width(), chart.grid.height(), change);
  if (coverage > 0.0F) {
    out.coverage = MaskImage(chart.grid.width(), chart.grid.height(), coverage);
  }
  return out;
}

void for_texels(const StorageAtlas& storage,
                const std::function<void(int, int, const SurfacePoint&)>& visit) {
  const TexelMap& texels = storage.sets[0].texels;
  for (int y = 0; y < texels.height(); ++y) {
    for (int x = 0; x < texels.width(); ++x) {
      const std::uint32_t owner = texels.owner()(x, y);
      if (owner != no_triangle) visit(x, y, texels.surface_point(owner, x, y));
    }
  }
}

Vec3f stored_normal(const Mesh& mesh, const StorageAtlas& storage, int x, int y,
                    const SurfacePoint& point) {
  const NormalMap& map = storage.sets[0].normals;
  return frame_at(mesh, point, map.convention().space).object_normal(map.normal(x, y));
}

}  // namespace normalshop::test
