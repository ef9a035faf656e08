#pragma once

#include <array>

#include "normalshop/chart/chart_triangle.h"
#include "normalshop/core/sample.h"

/// Pull's arithmetic for a row of pixels at once, private to floor 4.
namespace normalshop {

/// What the pixels of a triangle share. Vectors stay in object space: turning the pixels' is
/// cheaper than turning the triangles'.
struct PixelTriangle {
  float x0 = 0.0F;  ///< pixel coordinates of corner 0
  float y0 = 0.0F;
  Vec2f dx = Vec2f::Zero();  ///< of the weights of corners 1 and 2, per pixel from corner 0
  Vec2f dy = Vec2f::Zero();
  // Columns as in ChartTriangle.
  Mat3f normals = Mat3f::Zero();
  Mat3f tangents = Mat3f::Zero();
  float sign = 1.0F;  ///< of the bitangent in chart axes
  Vec2f uv = Vec2f::Zero();
  Vec2f uv1 = Vec2f::Zero();  ///< corner 1 - corner 0
  Vec2f uv2 = Vec2f::Zero();
  Vec2f uv_dx = Vec2f::Zero();  ///< steps of uv per pixel to the right and down
  Vec2f uv_dy = Vec2f::Zero();
  std::uint32_t texture_set = 0;

  void load(const Mesh& mesh, const ChartGrid& grid, std::uint32_t triangle);
};

/// Pixels side by side, as rows of components. What is read of a pixel that sees nothing is 0.
struct PixelRow {
  static constexpr int capacity = 32;
  static constexpr int padding = sample_padding;  ///< room for the widest vector past the end
  using Lane = std::array<float, capacity + padding>;
  struct Vectors {
    alignas(64) Lane x{};
    alignas(64) Lane y{};
    alignas(64) Lane z{};
    void set(int i, const Vec3f& vector) {
      const auto k = static_cast<std::size_t>(i);
      x[k] = vector.x();
      y[k] = vector.y();
      z[k] = vector.z();
    }
  };

  Vectors normal;           ///< interpolated, not unit
  Vectors tangent;          ///< likewise
  alignas(64) Lane sign{};  ///< of the bitangent; 0: `stored` is in chart axes
  alignas(64) Lane u{};
  alignas(64) Lane v{};
  alignas(64) Lane seen{};     ///< 1 or 0
  Vectors stored;              ///< what the map holds; unit where it is in chart axes
  alignas(64) Lane regular{};  ///< 0 where the frame has no inverse or the map no direction
  std::array<Vec3f, capacity + padding> base_normals;
  std::array<Vec3f, capacity + padding> details;
  Vectors color;
  std::array<Vec3f, capacity + padding> colors;
};

/// Interpolates a triangle over pixels `begin` to `end` of the row, whose pixel 0 has chart
/// coordinates (x, y). May write beyond `end`: runs come from left to right.
void interpolate_run(const PixelTriangle& triangle, int x, int y, int begin, int end,
                     PixelRow& row);
/// Turns normals and tangents into chart axes and fills base_normals: unit, or zero where nothing
/// is seen.
void finish_base_normals(int count, const View& view, PixelRow& row);
/// Fills details and regular from `stored`: unit, or zero where nothing is seen.
void finish_details(int count, PixelRow& row);
/// Fills colors from `color`; zero where nothing is seen.
void finish_colors(int count, PixelRow& row);

}  // namespace normalshop
