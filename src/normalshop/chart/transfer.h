#pragma once

#include <array>
#include <string_view>

#include "normalshop/chart/grid.h"

namespace normalshop {

/// How an editing chart is made of the storage atlas (thesis 5.3.1 and 5.3.2).
enum class Transfer {
  Triangle,  ///< textured triangles: pull()
  Point      ///< a splat per texel: pull_points()
};
constexpr auto names_of(Transfer) { return std::array<std::string_view, 2>{"triangle", "point"}; }

/// How an edited chart gets back into it.
enum class Update {
  Gather,  ///< every texel reads the change where it lies in the chart: push()
  Point,   ///< thesis 5.3.3: a texel takes the normal of the pixel at its centre
  Area     ///< thesis 5.3.3: a texel takes the mean normal of the pixels that show it
};
constexpr auto names_of(Update) {
  return std::array<std::string_view, 3>{"gather", "point", "area"};
}

/// The way of an edit. Anything but the default is here for comparison: docs/transfers.md.
struct TransferOptions {
  Transfer transfer = Transfer::Triangle;
  Update update = Update::Gather;
  /// Views with more pixels a side are cut into tiles where the edit allows it. Charts in one piece
  /// have max_chart_side at most, whatever it says.
  int largest_side = max_chart_side;

  bool operator==(const TransferOptions&) const = default;
};

}  // namespace normalshop
