#include "normalshop/document/map_tiles.h"

#include <bit>
#include <cstring>
#include <memory>
#include <optional>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/document/store/packing.h"

namespace normalshop {

namespace {

constexpr int tile_side = NormalMap::tile_size;
constexpr std::size_t tile_texels = std::size_t{tile_side} * tile_side;
constexpr std::size_t mask_bytes = tile_texels / 8;
constexpr std::size_t normal_bytes = 3 * sizeof(float);
constexpr std::size_t largest_normals = mask_bytes + tile_texels * normal_bytes;
constexpr std::size_t largest_colors = tile_texels * 4 * sizeof(float);

using NormalTile = NormalMap::Tile;

bool same_normals(const NormalTile* a, const NormalTile* b) {
  if (a == b) return true;
  const bool none_a = a == nullptr || a->edited.none();
  const bool none_b = b == nullptr || b->edited.none();
  if (none_a || none_b) return none_a == none_b;
  if (a->edited != b->edited) return false;
  for (std::size_t i = 0; i < tile_texels; ++i) {
    if (a->edited[i] && std::memcmp(&a->normals[i], &b->normals[i], normal_bytes) != 0)
      return false;
  }
  return true;
}

/// Which texels are edited, a bit each, then the bytes of their components: first the lowest of
/// every x, then the next, up to the highest of every z. Like beside like is what compresses.
std::string normals_as_bytes(const NormalTile& tile) {
  const std::size_t count = tile.edited.count();
  std::string bytes(mask_bytes + count * normal_bytes, '\0');
  std::size_t at = 0;
  for (std::size_t i = 0; i < tile_texels; ++i) {
    if (!tile.edited[i]) continue;
    bytes[i / 8] = static_cast<char>(static_cast<unsigned char>(bytes[i / 8]) | 1U << i % 8);
    for (std::size_t c = 0; c < 3; ++c) {
      const auto word = std::bit_cast<std::uint32_t>(tile.normals[i][static_cast<int>(c)]);
      for (std::size_t b = 0; b < 4; ++b) {
        bytes[mask_bytes + (4 * c + b) * count + at] = static_cast<char>(word >> 8 * b & 0xFFU);
      }
    }
    ++at;
  }
  return bytes;
}

std::shared_ptr<NormalTile> normals_from_bytes(std::string_view bytes) {
  if (bytes.size() < mask_bytes) throw InvalidInput("is damaged: it is too short");
  auto tile = std::make_shared<NormalTile>();
  for (std::size_t i = 0; i < tile_texels; ++i) {
    tile->edited[i] = (static_cast<unsigned char>(bytes[i / 8]) >> i % 8 & 1U) != 0;
  }
  const std::size_t count = tile->edited.count();
  if (bytes.size() != mask_bytes + count * normal_bytes) {
    throw InvalidInput("is damaged: its length is not that of its texels");
  }
  std::size_t at = 0;
  for (std::size_t i = 0; i < tile_texels; ++i) {
    if (!tile->edited[i]) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      std::uint32_t word = 0;
      for (std::size_t b = 0; b < 4; ++b) {
        const auto byte = static_cast<unsigned char>(bytes[mask_bytes + (4 * c + b) * count + at]);
        word |= std::uint32_t{byte} << 8 * b;
      }
      tile->normals[i][static_cast<int>(c)] = std::bit_cast<float>(word);
    }
    ++at;
  }
  return tile;
}

/// Where a tile lies in a map of that size.
Rect tile_rect(std::size_t tile, int width, int height) {
  const auto columns = static_cast<std::size_t>(NormalMap::tiles_along(width));
  const int x = static_cast<int>(tile % columns) * tile_side;
  const int y = static_cast<int>(tile / columns) * tile_side;
  return intersect({x, y, x + tile_side, y + tile_side}, {0, 0, width, height});
}

std::size_t tile_count(const RawImage& image) {
  return static_cast<std::size_t>(NormalMap::tiles_along(image.width())) *
         static_cast<std::size_t>(NormalMap::tiles_along(image.height()));
}

std::size_t pixel_bytes(const RawImage& image) {
  return static_cast<std::size_t>(image.channels() * RawImage::code_size(image.type()));
}

/// visit(first byte, number of bytes) of a tile's rows.
template <class Visit>
void for_tile_rows(const RawImage& image, std::size_t tile, const Visit& visit) {
  const Rect rect = tile_rect(tile, image.width(), image.height());
  const std::size_t first = static_cast<std::size_t>(rect.x0) * pixel_bytes(image);
  const std::size_t size = static_cast<std::size_t>(rect.width()) * pixel_bytes(image);
  for (int y = rect.y0; y < rect.y1; ++y) visit(image.row_data(y) + first, size);
}

/// The codes in rows, numbers of several bytes with the lowest first.
std::string colors_as_bytes(const RawImage& image, std::size_t tile) {
  std::string bytes;
  for_tile_rows(image, tile, [&](const std::uint8_t* row, std::size_t size) {
    bytes.append(reinterpret_cast<const char*>(row), size);
  });
  return bytes;
}

static_assert(std::endian::native == std::endian::little,
              "codes are written as they lie in memory");

std::optional<TileChange> normal_change(const NormalMap& before, const NormalMap& after,
                                        std::size_t tile) {
  const auto was = before.tile(tile);
  const auto is = after.tile(tile);
  if (same_normals(was.get(), is.get())) return std::nullopt;
  return TileChange{{}, {}, pack(normals_as_bytes(is ? *is : NormalTile{}))};
}

std::optional<TileChange> color_change(const ColorMap& before, const ColorMap& after,
                                       std::size_t tile) {
  std::string was = colors_as_bytes(before.codes(), tile);
  const std::string is = colors_as_bytes(after.codes(), tile);
  if (was == is) return std::nullopt;
  return TileChange{{}, pack(was), pack(is)};
}

/// change(tile) of each of `count` tiles, on all cores; those there are, in order.
template <class Change>
void collect(std::uint32_t set, Attribute attribute, std::size_t count, const Change& change,
             std::vector<TileChange>& out) {
  std::vector<std::optional<TileChange>> found(count);
  parallel_for(count, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) found[i] = change(i);
  });
  for (std::size_t i = 0; i < count; ++i) {
    if (!found[i]) continue;
    found[i]->place = {set, attribute, static_cast<std::uint32_t>(i)};
    out.push_back(std::move(*found[i]));
  }
}

std::shared_ptr<NormalTile> unpack_normals(const PackedTile& tile) {
  if (tile.bytes.empty()) return nullptr;
  return normals_from_bytes(unpack(tile.bytes, largest_normals));
}

/// The tile's codes, of the type that they have while they are edited.
std::string unpack_colors(const PackedTile& tile, const RawImage& codes) {
  std::string bytes = unpack(tile.bytes, largest_colors);
  const Rect rect = tile_rect(tile.place.tile, codes.width(), codes.height());
  const int code_bytes = codes.type() == CodeType::F32 ? 4 : 2;
  const int size = rect.width() * rect.height() * codes.channels() * code_bytes;
  if (bytes.size() != static_cast<std::size_t>(size)) {
    throw InvalidInput("is damaged: its length is not that of its texels");
  }
  return bytes;
}

bool holds_normals(const PackedTile& tile) { return tile.place.attribute == Attribute::Normals; }

void check_place(const TilePlace& place, const StorageAtlas& storage) {
  if (place.set >= storage.sets.size()) throw InvalidInput("is of no texture set");
  const StorageSet& set = storage.sets[place.set];
  const std::size_t count = place.attribute == Attribute::Normals ? set.normals.tile_count()
                                                                  : tile_count(set.albedo.codes());
  if (place.tile >= count) throw InvalidInput("lies outside of its map");
}

}  // namespace

MapsBefore::MapsBefore(const StorageAtlas& storage, bool with_colors) {
  for (const StorageSet& set : storage.sets) {
    normals.push_back(set.normals);
    if (with_colors) colors.push_back(set.albedo);
  }
}

void MapsBefore::restore(StorageAtlas& storage) const {
  for (std::size_t i = 0; i < storage.sets.size(); ++i) {
    storage.sets[i].normals = normals[i];
    if (!colors.empty()) storage.sets[i].albedo = colors[i];
  }
}

std::vector<TileChange> changed_tiles(const MapsBefore& before, const StorageAtlas& storage) {
  std::vector<TileChange> out;
  for (std::size_t i = 0; i < storage.sets.size(); ++i) {
    const StorageSet& set = storage.sets[i];
    const auto index = static_cast<std::uint32_t>(i);
    collect(
        index, Attribute::Normals, set.normals.tile_count(),
        [&](std::size_t t) { return normal_change(before.normals[i], set.normals, t); }, out);
    if (before.colors.empty() || !set.albedo.has_edits()) continue;
    ColorMap was = before.colors[i];
    was.begin_edits();
    collect(
        index, Attribute::Colors, tile_count(set.albedo.codes()),
        [&](std::size_t t) { return color_change(was, set.albedo, t); }, out);
  }
  return out;
}

void check_tile(const PackedTile& tile) {
  if (holds_normals(tile)) {
    unpack_normals(tile);
  } else {
    unpack(tile.bytes, largest_colors);
  }
}

void check_fits(const PackedTile& tile, const StorageAtlas& storage) {
  check_place(tile.place, storage);
  if (holds_normals(tile)) {
    unpack_normals(tile);
  } else {
    unpack_colors(tile, storage.sets[tile.place.set].albedo.codes());
  }
}

void put_tile(const PackedTile& tile, StorageAtlas& storage) {
  check_place(tile.place, storage);
  StorageSet& set = storage.sets[tile.place.set];
  if (holds_normals(tile)) {
    set.normals.set_tile(tile.place.tile, unpack_normals(tile));
    return;
  }
  const std::string bytes = unpack_colors(tile, set.albedo.codes());
  set.albedo.begin_edits();
  const RawImage& codes = set.albedo.codes();
  set.albedo.write_codes(tile_rect(tile.place.tile, codes.width(), codes.height()),
                         reinterpret_cast<const std::uint8_t*>(bytes.data()));
}

}  // namespace normalshop
