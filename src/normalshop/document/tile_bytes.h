#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <tuple>

#include "normalshop/core/color_map.h"
#include "normalshop/core/normal_map.h"
#include "normalshop/document/edit_stack.h"

namespace normalshop {

/// What a texel has: a normal and a colour.
enum class Attribute { Normals, Colors };
constexpr auto names_of(Attribute) { return std::array<std::string_view, 2>{"normals", "colors"}; }

/// NormalMap::tile_size texels a side of one map of a texture set; tiles count in rows from the top
/// left.
struct TilePlace {
  std::uint32_t set = 0;
  Attribute attribute = Attribute::Normals;
  std::uint32_t tile = 0;
  bool operator==(const TilePlace&) const = default;
  /// By texture set, attribute and tile.
  bool operator<(const TilePlace& o) const {
    return std::tie(set, attribute, tile) < std::tie(o.set, o.attribute, o.tile);
  }
};

/// A tile's edited texels as bytes, the same on every machine (docs/document.md), packed
/// (store/packing.h).
struct PackedTile {
  TilePlace place;
  std::int64_t layer = first_layer;
  std::string bytes;  ///< empty: the tile is what the layers below make of it
};

/// Its bytes, packed.
std::string pack_normals(const NormalMap::Tile& tile);
/// Null for an empty tile. Throws InvalidInput for what is no tile of normals.
std::shared_ptr<NormalMap::Tile> unpack_normals(const PackedTile& tile);

/// Tiles of a colour map, counted as those of a normal map.
std::size_t color_tile_count(const RawImage& codes);
/// A tile's codes in rows, numbers of several bytes with the lowest first.
std::string color_bytes(const RawImage& codes, std::size_t tile);
/// The same of a packed tile, in the type that codes have while they are edited. Throws
/// InvalidInput for what is no tile of this map.
std::string unpack_colors(const PackedTile& tile, const RawImage& codes);
/// The map must be in edits.
void write_color_bytes(const std::string& bytes, std::size_t tile, ColorMap& map);

/// Throws InvalidInput unless the bytes are those of a tile; empty ones are what lies below.
void check_tile(const PackedTile& tile);

}  // namespace normalshop
