#pragma once

#include <cmath>
#include <string>

#include "document/fake_assets.h"
#include "support/meshes.h"
#include <gtest/gtest.h>

#include "normalshop/core/random.h"
#include "normalshop/document/document.h"

namespace normalshop::test {

inline Recipe parse(const std::string& json) {
  FakeAssets assets;
  return parse_recipe(json, "r.json", assets);
}

/// One edit from the inside of its braces.
inline Edit edit(const std::string& fields) {
  return parse(R"({"version": 1, "edits": [{)" + fields + "}]}").edits.at(0);
}

inline Document document(const Mesh& mesh, NormalMap normals) {
  std::vector<Document::Maps> maps;
  maps.push_back({std::move(normals), {}});
  return {mesh, std::move(maps)};
}

/// The square [0, 1]^2 without details; "front" is 1.04 wide around (0.5, 0.5).
inline Document flat_plane(int size) {
  return document(plane_grid(2), flat_normal_map(size, size, CodeType::U16));
}

inline const NormalMap& map_of(const Document& d) { return d.storage().sets.at(0).normals; }

/// The hemisphere with a map of its own normals in object space.
inline Document hemisphere_document(int size) {
  RawImage codes(size, size, 3, CodeType::F32);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const Vec2f p((static_cast<float>(x) + 0.5F) / static_cast<float>(size) - 0.5F,
                    0.5F - (static_cast<float>(y) + 0.5F) / static_cast<float>(size));
      const float angle = std::min(p.norm() / 0.4F, 1.0F) * 1.5707963F;
      const Vec2f around = p.norm() > 0.0F ? Vec2f(p.normalized()) : Vec2f(0.0F, 0.0F);
      const Vec3f n(std::sin(angle) * around.x(), std::sin(angle) * around.y(), std::cos(angle));
      std::copy_n(n.data(), 3, codes.row<float>(y) + static_cast<std::ptrdiff_t>(3 * x));
    }
  }
  return document(hemisphere(96, 192), NormalMap(std::move(codes), {.space = NormalSpace::Object,
                                                                    .signed_float = true}));
}

/// Tangent-space normals with random slopes up to about 0.3.
inline NormalMap noise_map(int size, CodeType type) {
  const bool bytes = type == CodeType::U8;
  RawImage codes(size, size, 3, type);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      for (int c = 0; c < 3; ++c) {
        const std::uint32_t bits =
            hash(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
                 static_cast<std::uint32_t>(c));
        const std::uint32_t code = c == 2 ? 240 : 100 + bits % 56;
        if (bytes) {
          codes.row<std::uint8_t>(y)[3 * x + c] = static_cast<std::uint8_t>(code);
        } else {
          codes.row<std::uint16_t>(y)[3 * x + c] =
              static_cast<std::uint16_t>(code * 257 + (bits >> 16U) % 200);
        }
      }
    }
  }
  return {std::move(codes), {}};
}

inline float degrees_between(const Vec3f& a, const Vec3f& b) {
  return 2.0F * std::asin(std::min(1.0F, 0.5F * (a.normalized() - b.normalized()).norm())) *
         57.29578F;
}

/// Centre of the plane of a texel, from the view's centre.
inline Vec2f plane_point(const NormalMap& map, int x, int y) {
  return {(static_cast<float>(x) + 0.5F) / static_cast<float>(map.width()) - 0.5F,
          0.5F - (static_cast<float>(y) + 0.5F) / static_cast<float>(map.height())};
}

/// Slope of the bump profile of that height and half width at a signed distance.
inline float bump_slope(float height, float half_width, float distance) {
  const float u = distance / half_width;
  const float s = 1.0F - u * u;
  return s > 0.0F ? -6.0F * height / half_width * u * s * s : 0.0F;
}

/// The mean place of the texels that an edit changed.
inline Vec2f centre_of_edits(const NormalMap& map) {
  Vec2f sum(0.0F, 0.0F);
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      if (map.edited(x, y)) sum += plane_point(map, x, y);
    }
  }
  return sum / static_cast<float>(map.edited_count());
}

inline void expect_unit_normals(const NormalMap& map) {
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      ASSERT_NEAR(map.normal(x, y).norm(), 1.0F, 1e-3F) << x << ", " << y;
    }
  }
}

}  // namespace normalshop::test
