#include "normalshop/document/layered_tiles.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <type_traits>

#include "normalshop/document/layer_blend.h"

namespace normalshop {

namespace {

/// That a layer has there; null: what is below shows through.
const PackedTile* tile_of(const std::vector<PackedTile>& tiles, std::int64_t layer) {
  const auto found = std::find_if(tiles.begin(), tiles.end(), [&](const PackedTile& tile) {
    return tile.layer == layer && !tile.bytes.empty();
  });
  return found == tiles.end() ? nullptr : &*found;
}

bool covers(const LayersShown& shown, std::size_t index) {
  const bool as_edited = shown.last_as_edited && index + 1 == shown.layers.size();
  return as_edited || shown.layers[index].plain();
}

void put_imported(const TilePlace& place, const std::vector<PackedTile>& tiles,
                  StorageAtlas& storage) {
  if (place.attribute == Attribute::Normals) {
    put_tile({place, imported_layer, {}}, storage);
  } else if (const PackedTile* imported = tile_of(tiles, imported_layer)) {
    put_tile(*imported, storage);
  }
}

/// Over what the map holds.
void blend_normals_of(const PackedTile& above, const Layer& layer, NormalMap& map) {
  const auto tile = unpack_normals(above);
  const auto below = map.tile(above.place.tile);
  const NormalSpace space = map.convention().space;
  const int columns = NormalMap::tiles_along(map.width());
  const int x0 = static_cast<int>(above.place.tile) % columns * NormalMap::tile_size;
  const int y0 = static_cast<int>(above.place.tile) / columns * NormalMap::tile_size;
  for (int y = y0; y < std::min(y0 + NormalMap::tile_size, map.height()); ++y) {
    for (int x = x0; x < std::min(x0 + NormalMap::tile_size, map.width()); ++x) {
      const std::size_t i = NormalMap::index_in_tile(x, y);
      if (!tile->edited[i]) continue;
      const bool same = below && below->edited[i] &&
                        std::memcmp(&below->normals[i], &tile->normals[i], sizeof(Vec3f)) == 0;
      if (same) continue;
      const Vec3f under = map.normal(x, y);
      const Vec3f over = tile->normals[i].normalized();
      map.set_normal(
          x, y,
          under.isZero() ? over : blend_normals(under, over, layer.opacity, layer.blend, space));
    }
  }
}

template <class Code>
void blend_codes(std::string& below, const std::string& above, float opacity) {
  for (std::size_t i = 0; i + sizeof(Code) <= below.size(); i += sizeof(Code)) {
    Code a{};
    Code b{};
    std::memcpy(&a, below.data() + i, sizeof(Code));
    std::memcpy(&b, above.data() + i, sizeof(Code));
    if (a == b) continue;
    const float mixed =
        static_cast<float>(a) + opacity * (static_cast<float>(b) - static_cast<float>(a));
    const Code code = std::is_floating_point_v<Code> ? static_cast<Code>(mixed)
                                                     : static_cast<Code>(std::lround(mixed));
    std::memcpy(below.data() + i, &code, sizeof(Code));
  }
}

void blend_colors_of(const PackedTile& above, const Layer& layer, ColorMap& map) {
  map.begin_edits();
  const std::string over = unpack_colors(above, map.codes());
  std::string codes = color_bytes(map.codes(), above.place.tile);
  if (map.codes().type() == CodeType::F32) {
    blend_codes<float>(codes, over, layer.opacity);
  } else {
    blend_codes<std::uint16_t>(codes, over, layer.opacity);
  }
  write_color_bytes(codes, above.place.tile, map);
}

}  // namespace

bool any_shown(std::span<const std::int64_t> layers, const LayersShown& shown) {
  for (std::size_t i = 0; i < shown.layers.size(); ++i) {
    const bool seen = covers(shown, i) || shown.layers[i].seen();
    if (seen && std::find(layers.begin(), layers.end(), shown.layers[i].id) != layers.end())
      return true;
  }
  return false;
}

void show_tile(const TilePlace& place, const std::vector<PackedTile>& tiles,
               const LayersShown& shown, StorageAtlas& storage) {
  std::size_t next = shown.layers.size();
  const PackedTile* lowest = nullptr;
  while (next > 0 && lowest == nullptr) {
    --next;
    if (covers(shown, next)) lowest = tile_of(tiles, shown.layers[next].id);
  }
  if (lowest != nullptr) {
    put_tile(*lowest, storage);
    ++next;
  } else {
    put_imported(place, tiles, storage);
  }
  for (; next < shown.layers.size(); ++next) {
    const Layer& layer = shown.layers[next];
    const PackedTile* tile = tile_of(tiles, layer.id);
    if (tile == nullptr || !layer.seen()) continue;
    check_fits(*tile, storage);
    StorageSet& set = storage.sets[place.set];
    if (place.attribute == Attribute::Normals) {
      blend_normals_of(*tile, layer, set.normals);
    } else {
      blend_colors_of(*tile, layer, set.albedo);
    }
  }
}

}  // namespace normalshop
