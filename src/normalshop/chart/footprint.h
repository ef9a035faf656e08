#pragma once

#include <array>
#include <optional>

#include "normalshop/chart/pixel_row.h"
#include "normalshop/chart/storage.h"

/// What the maps hold under pixels that are larger than texels, private to floor 4.
namespace normalshop {

/// Texels along a pixel's side up to which one bilinear sample shows all of them.
inline constexpr float fine_texels = 1.5F;

/// Do the pixels of a triangle cover more than fine_texels of a map of that size along a side?
inline bool is_minified(const PixelTriangle& triangle, const Vec2f& size) {
  constexpr float limit = fine_texels * fine_texels;
  return triangle.uv_dx.cwiseProduct(size).squaredNorm() > limit ||
         triangle.uv_dy.cwiseProduct(size).squaredNorm() > limit;
}

/// Means over the square of a pixel, by bilinear samples no further than a texel from each other
/// (in pixels with more than `most` texels a side: that many samples a side, evenly spread). Where
/// the square leaves the pixel's triangle, what lies there counts if it is the same chart of the
/// atlas going on, and nothing else: never what lies beside a chart. What is left out on one side
/// of the pixel's middle is left out on the other, or the mean would be that of another place.
///
/// Normals: means of slopes in tangent space, of unit vectors in other spaces. Colours: linear.
class FootprintReader {
 public:
  static constexpr int most = 16;

  FootprintReader(const Mesh& mesh, const StorageAtlas& storage,
                  TriangleCache<PixelTriangle>& triangles)
      : mesh_(mesh), storage_(storage), triangles_(triangles) {}

  /// The pixels of a row that come: those of one triangle, at chart row y.
  void begin(std::uint32_t triangle, int y);
  const PixelTriangle& triangle() const { return triangle_; }
  /// The mean around the chart's pixel x. False, and nothing written, where nothing counts.
  bool normal(int x, Vec3f& mean);
  bool color(int x, Vec3f& mean);

 private:
  static constexpr std::size_t room = most * most + sample_padding;

  void find_places(int x, const Vec2f& size);
  std::optional<Vec2f> place_of(const Vec2f& pixel, const Vec2f& size);
  bool goes_on(const Vec2f& uv, const Vec2f& pixel, const Vec2f& size);

  const Mesh& mesh_;
  const StorageAtlas& storage_;
  TriangleCache<PixelTriangle>& triangles_;
  PixelTriangle triangle_;  // a copy: the cache lets go of it when others come
  std::uint32_t id_ = 0;
  int y_ = 0;
  int count_ = 0;  // of places
  alignas(64) std::array<float, room> u_{};
  alignas(64) std::array<float, room> v_{};
  alignas(64) std::array<float, room> a_{};
  alignas(64) std::array<float, room> b_{};
  alignas(64) std::array<float, room> c_{};
};

}  // namespace normalshop
