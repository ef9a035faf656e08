#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include "normalshop/io/model.h"

/// UDIM tiles: one map a unit square of the UVs. Tile 1001 + column + 10 * row, columns 0 to 9
/// along u, rows 0 to 99 upwards from v = 0 in files whose v runs up.
namespace normalshop {

inline constexpr int first_tile_number = 1001;
inline constexpr int last_tile_number = 2000;

/// Does the name hold <UDIM> (1001) or <UVTILE> (u1_v1), for which every tile has its own?
bool names_tiles(const std::filesystem::path& path);
/// The name of one tile's file.
std::filesystem::path tile_path(const std::filesystem::path& pattern, int tile);
/// The first tile's file that exists.
std::optional<std::filesystem::path> first_tile(const std::filesystem::path& pattern,
                                                const FileSource& files);

/// Splits the texture sets for which `tiled` is true into one a tile that their triangles lie in,
/// named "<set>.<tile>", ascending: maps that name tiles become the tile's own, UVs move to 0..1,
/// where single_maps says that they don't repeat. Tangents are computed before, where the mesh has
/// none, so that they are shared across tiles. Returns, per new set, the old one's index. Throws
/// InvalidInput where a triangle lies in several tiles or beyond them.
std::vector<std::size_t> split_tiles(Model& model, const std::vector<bool>& tiled);

}  // namespace normalshop
