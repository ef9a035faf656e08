#include "normalshop/io/udim.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "normalshop/core/error.h"
#include "normalshop/io/detail/model_source.h"
#include "normalshop/surface/tangents.h"

namespace normalshop {

namespace {

/// UVs may leave their tile by this much, which files' digits do.
constexpr float tile_slack = 1e-3F;

constexpr std::array<std::string_view, 2> tile_marks{"<UDIM>", "<UVTILE>"};

std::string text_of(std::string_view mark, int tile) {
  if (mark == tile_marks[0]) return std::to_string(tile);
  const int column = (tile - first_tile_number) % 10;
  const int row = (tile - first_tile_number) / 10;
  return "u" + std::to_string(column + 1) + "_v" + std::to_string(row + 1);
}

/// The tile's upper left corner in the mesh's UVs, whose v runs down.
Vec2f corner_of(int tile) {
  const int column = (tile - first_tile_number) % 10;
  const int row = (tile - first_tile_number) / 10;
  return {static_cast<float>(column), -static_cast<float>(row)};
}

class TileSplit {
 public:
  TileSplit(Model& model, const std::vector<bool>& tiled) : model_(model), tiled_(tiled) {}

  std::vector<std::size_t> run() {
    Mesh& mesh = model_.mesh;
    if (mesh.tangents.empty()) compute_tangents(mesh);
    std::vector<int> tiles(mesh.triangle_count(), 0);
    std::set<std::pair<std::uint32_t, int>> used;
    for (std::size_t set = 0; set < tiled_.size(); ++set) {
      if (!tiled_[set]) used.emplace(static_cast<std::uint32_t>(set), 0);
    }
    for (std::size_t t = 0; t < tiles.size(); ++t) {
      if (tiled_[mesh.texture_sets[t]]) tiles[t] = move_home(t);
      used.emplace(mesh.texture_sets[t], tiles[t]);
    }
    const std::vector<std::pair<std::uint32_t, int>> keys(used.begin(), used.end());
    for (std::size_t t = 0; t < tiles.size(); ++t) {
      const auto key = std::pair(mesh.texture_sets[t], tiles[t]);
      mesh.texture_sets[t] = static_cast<std::uint32_t>(
          std::lower_bound(keys.begin(), keys.end(), key) - keys.begin());
    }
    std::vector<std::size_t> old;
    std::vector<TextureSet> before = std::move(model_.texture_sets);
    model_.texture_sets.clear();
    mesh.texture_set_names.clear();
    mesh.single_maps.clear();
    for (const auto& [set, tile] : keys) {
      old.push_back(set);
      model_.texture_sets.push_back(tile == 0 ? before[set] : tile_set(before[set], tile));
      mesh.texture_set_names.push_back(model_.texture_sets.back().name);
      mesh.single_maps.push_back(tile == 0 ? 0 : 1);
    }
    return old;
  }

 private:
  [[noreturn]] void fail(std::size_t triangle, const std::string& what) const {
    throw InvalidInput("'" + model_.path.string() + "': triangle " + std::to_string(triangle) +
                       " of the texture set '" +
                       model_.texture_sets[model_.mesh.texture_sets[triangle]].name + "' " + what);
  }

  /// Moves the triangle's UVs to 0..1 and returns the tile that they were in.
  int move_home(std::size_t triangle) {
    Vec2f* uv = &model_.mesh.uvs[3 * triangle];
    const Vec2f middle = (uv[0] + uv[1] + uv[2]) / 3.0F;
    const float column = std::floor(middle.x());
    const float row = -std::floor(middle.y());
    if (!(column >= 0.0F && column <= 9.0F && row >= 0.0F && row <= 99.0F)) {
      fail(triangle, "lies beyond the UDIM tiles 1001 to 2000");
    }
    const int tile = first_tile_number + static_cast<int>(column) + 10 * static_cast<int>(row);
    for (int k = 0; k < 3; ++k) {
      const Vec2f home = uv[k] - corner_of(tile);
      if (home.minCoeff() < -tile_slack || home.maxCoeff() > 1.0F + tile_slack) {
        fail(triangle, "crosses the border of the UDIM tile " + std::to_string(tile) +
                           "; every triangle must lie in one tile");
      }
      uv[k] = home.cwiseMax(0.0F).cwiseMin(1.0F);
    }
    return tile;
  }

  TextureSet tile_set(const TextureSet& set, int tile) const {
    TextureSet out = set;
    out.tile = tile;
    out.tiled_name = set.name;
    out.name = file_safe_name(set.name + "." + std::to_string(tile), model_.texture_sets);
    for (auto* map : {&out.normal_map, &out.albedo}) {
      if (!*map || !names_tiles((*map)->path)) continue;
      (*map)->path = tile_path((*map)->path, tile);
      (*map)->name = tile_path((*map)->name, tile).string();
    }
    return out;
  }

  Model& model_;
  const std::vector<bool>& tiled_;
};

}  // namespace

bool names_tiles(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  return std::any_of(tile_marks.begin(), tile_marks.end(),
                     [&](std::string_view mark) { return name.find(mark) != std::string::npos; });
}

std::filesystem::path tile_path(const std::filesystem::path& pattern, int tile) {
  std::string name = pattern.filename().string();
  for (const std::string_view mark : tile_marks) {
    const std::size_t at = name.find(mark);
    if (at != std::string::npos) name.replace(at, mark.size(), text_of(mark, tile));
  }
  return pattern.parent_path() / name;
}

std::optional<std::filesystem::path> first_tile(const std::filesystem::path& pattern,
                                                const FileSource& files) {
  for (int tile = first_tile_number; tile <= last_tile_number; ++tile) {
    std::filesystem::path path = tile_path(pattern, tile);
    if (files.has(path)) return path;
  }
  return std::nullopt;
}

std::vector<std::size_t> split_tiles(Model& model, const std::vector<bool>& tiled) {
  if (model.source && model.source->format != ModelFormat::Obj &&
      std::find(tiled.begin(), tiled.end(), true) != tiled.end()) {
    throw InvalidInput("'" + model.path.string() +
                       "': glTF has no UDIM tiles; give each tile its own material, or an OBJ");
  }
  return TileSplit(model, tiled).run();
}

}  // namespace normalshop
