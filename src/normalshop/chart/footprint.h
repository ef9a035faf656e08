#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "normalshop/chart/pixel_row.h"
#include "normalshop/chart/storage.h"

/// What the maps hold under pixels that are larger than texels, private to floor 4.
namespace normalshop {

/// Texels along a pixel's side up to which one bilinear sample shows all of them.
inline constexpr float fine_texels = 1.5F;

inline Vec2f size_in_texels(const RawImage& codes) {
  return {static_cast<float>(codes.width()), static_cast<float>(codes.height())};
}

/// Do the pixels of a triangle cover more than fine_texels of a map of that size along a side? Not
/// those of triangles so thin that steps from pixel to pixel are no numbers.
inline bool is_minified(const PixelTriangle& triangle, const Vec2f& size) {
  constexpr float limit = fine_texels * fine_texels;
  constexpr float countless = 1e12F;
  const float across = triangle.uv_dx.cwiseProduct(size).squaredNorm();
  const float down = triangle.uv_dy.cwiseProduct(size).squaredNorm();
  return std::max(across, down) > limit && across + down < countless;
}

/// Pixels of a row, side by side, that see one triangle.
struct PixelRun {
  int begin;
  int end;
  std::uint32_t triangle;
};

/// Means over the squares of pixels, by bilinear samples no further than a texel from each other
/// (in pixels with more than `most` texels a side: that many samples a side, evenly spread). Where
/// a square leaves its pixel's triangle, what lies there counts if it is the same chart of the
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

  /// Rewrites the pixels of the runs that are minified, and leaves those of which nothing counts.
  /// Pixel 0 of the row has chart coordinates (x, y).
  void normals(std::span<const PixelRun> runs, int x, int y, PixelRow::Vectors& stored);
  void colors(std::span<const PixelRun> runs, int x, int y, PixelRow::Vectors& color);

 private:
  struct Counts {
    int across = 1;
    int down = 1;
    std::uint32_t texture_set = 0;
    bool operator==(const Counts&) const = default;
  };
  using Lane = PixelRow::Lane;

  template <class SizeOf, class Take>
  void read(std::span<const PixelRun> runs, int x, int y, const SizeOf& size_of, const Take& take);
  void add(const PixelRun& run, int x, int y);
  template <class Sample>
  void add_samples(const Counts& counts, const Vec2f& size, const Sample& sample);
  void find_places(const Vec2f& offset, const Vec2f& size);
  bool both_go_on(std::size_t lane, const Vec2f& offset, const Vec2f& size);
  bool goes_on(std::size_t lane, const Vec2f& uv, const Vec2f& pixel, const Vec2f& size);
  void keep_inside(std::uint32_t set, const Vec2f& size, Lane& u, Lane& v) const;
  void add_slopes();
  void add_units();
  void add_colors();

  const Mesh& mesh_;
  const StorageAtlas& storage_;
  TriangleCache<PixelTriangle>& triangles_;

  // Pixels that take equally many samples, as lanes.
  int count_ = 0;
  std::array<int, PixelRow::capacity> pixel_{};  // in the row
  std::array<std::uint32_t, PixelRow::capacity> id_{};
  std::uint32_t set_ = 0;
  float x_ = 0.0F;  // chart coordinates of the row
  float y_ = 0.0F;
  // At the middle of the pixel, and their steps to the right and down.
  struct Affine {
    alignas(64) Lane at{};
    alignas(64) Lane dx{};
    alignas(64) Lane dy{};
  };
  Affine u_, v_, b1_, b2_;
  // Two places, opposite of each other; 1 where they count.
  alignas(64) Lane u0_{};
  alignas(64) Lane v0_{};
  alignas(64) Lane u1_{};
  alignas(64) Lane v1_{};
  alignas(64) Lane counts_{};
  PixelRow::Vectors sample_;
  PixelRow::Vectors sum_;
  alignas(64) Lane total_{};
};

}  // namespace normalshop
