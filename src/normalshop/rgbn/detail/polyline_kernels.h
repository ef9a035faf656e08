#pragma once

#include <array>
#include <vector>

/// The inner loop of fields around polylines. Private to this floor.
namespace normalshop {

/// What places beside a segment take from it; tangents are those at its joints. In pixels, y down.
struct PlainSegment {
  float ax, ay;
  float dx, dy;
  float length;
  float start_x, start_y;
  float end_x, end_y;
};

/// Of 8 pixels in a row: the signed distance to the nearest segment / half width (positive to the
/// left; 2 from the half width on), and its gradient.
struct PlainPlaces {
  static constexpr int count = 8;
  alignas(32) std::array<float, count> u;
  alignas(32) std::array<float, count> x;
  alignas(32) std::array<float, count> y;
};

/// Places of the pixels (x, y), (x + 1, y) ... beside a line without ends near them.
void plain_places(const std::vector<PlainSegment>& segments, float half_width, float x, float y,
                  PlainPlaces& out);

}  // namespace normalshop
