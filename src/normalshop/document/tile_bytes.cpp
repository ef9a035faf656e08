#include "normalshop/document/tile_bytes.h"

#include <bit>

#include "normalshop/core/error.h"
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

static_assert(std::endian::native == std::endian::little,
              "codes are written as they lie in memory");

}  // namespace

std::string pack_normals(const NormalTile& tile) { return pack(normals_as_bytes(tile)); }

std::shared_ptr<NormalTile> unpack_normals(const PackedTile& tile) {
  if (tile.bytes.empty()) return nullptr;
  return normals_from_bytes(unpack(tile.bytes, largest_normals));
}

std::size_t color_tile_count(const RawImage& image) {
  return static_cast<std::size_t>(NormalMap::tiles_along(image.width())) *
         static_cast<std::size_t>(NormalMap::tiles_along(image.height()));
}

std::string color_bytes(const RawImage& image, std::size_t tile) {
  std::string bytes;
  for_tile_rows(image, tile, [&](const std::uint8_t* row, std::size_t size) {
    bytes.append(reinterpret_cast<const char*>(row), size);
  });
  return bytes;
}

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

void write_color_bytes(const std::string& bytes, std::size_t tile, ColorMap& map) {
  map.write_codes(tile_rect(tile, map.codes().width(), map.codes().height()),
                  reinterpret_cast<const std::uint8_t*>(bytes.data()));
}

void check_tile(const PackedTile& tile) {
  if (tile.bytes.empty()) return;
  if (tile.place.attribute == Attribute::Normals) {
    unpack_normals(tile);
  } else {
    unpack(tile.bytes, largest_colors);
  }
}

}  // namespace normalshop
