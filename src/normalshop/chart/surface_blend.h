#pragma once

#include <array>
#include <memory>
#include <vector>

#include "normalshop/chart/push.h"

namespace normalshop {

struct PushTally;

/// One edit of a surface that no single view shows: what every view of it would do to a texel, as a
/// mean that is continuous over the surface (a partition of unity). A view counts by its weight
/// there times a power of the cosine between base normal and viewing direction, so that the one
/// that faces the surface decides, and where views take turns the mean goes smoothly from one to
/// the other. Where all weights together are below 1 the edit fades out with them. Of several
/// triangles that share a texel the first in file order that any view edits has it alone: a mean of
/// what they get would be right on none.
///
/// The views see the storage as it is before the edit: it must not change until write().
class SurfaceBlend {
 public:
  /// `part`: 1 for each triangle of the mesh that is edited, else 0: texels that others decode keep
  /// their codes. Empty: all are edited.
  explicit SurfaceBlend(const StorageAtlas& storage, std::vector<std::uint8_t> part = {});

  /// What push() would do from this view. Deterministic for any number of threads, as push() is.
  void add(const Mesh& mesh, const EditingChart& chart, const ChartEdit& edit,
           const StorageAtlas& storage);
  /// Stores the mean. `visited` counts texels once for each view that reached them.
  PushResult write(StorageAtlas& storage) const;

 private:
  static constexpr int side = NormalMap::tile_size;
  /// Sums over the views.
  struct Tile {
    std::array<Vec3f, side * side> turned;   ///< share * (unit normal after - before)
    std::array<float, side * side> share{};  ///< weight * power of the cosine
    std::array<float, side * side> weight{};
    std::array<std::uint32_t, side * side> triangle;  ///< that has the texel
    Tile() {
      turned.fill(Vec3f::Zero());
      triangle.fill(no_triangle);
    }
    bool take(std::size_t i, std::uint32_t by);
    Vec3f result(std::size_t i, const Vec3f& before) const;
  };
  struct Target;
  using Tiles = std::vector<std::unique_ptr<Tile>>;
  static PushTally write_tile(const Tile& tile, int x0, int y0, StorageSet& set);

  std::vector<Tiles> sets_;
  std::vector<std::uint8_t> part_;
  std::size_t visited_ = 0;
};

}  // namespace normalshop
