#include "normalshop/document/store/stored_history.h"

#include <algorithm>
#include <map>

#include "normalshop/core/error.h"
#include "normalshop/core/options.h"

namespace normalshop {

namespace {

constexpr const char* step_columns = "SELECT id, parent, step, target, details, operator, texels ";

}  // namespace

StoredHistory::Step StoredHistory::position() const {
  Statement row(database_, "SELECT position FROM document");
  if (!row.step()) database_.fail("is damaged: its head is missing");
  return row.optional_integer(0);
}

StoredHistory::Step StoredHistory::parent(std::int64_t step) const {
  return this->step(step).parent;
}

StoredHistory::Step StoredHistory::next(Step step) const {
  Statement row(database_,
                step ? "SELECT next FROM steps WHERE id = ?" : "SELECT first FROM document");
  if (step) row.bind(1, *step);
  const Step next = row.step() ? row.optional_integer(0) : std::nullopt;
  if (next && parent(*next) != step) {
    database_.fail("is damaged: its step " + std::to_string(*next) +
                   " was not made on the one before it");
  }
  return next;
}

StoredStep StoredHistory::read_step(const Statement& row) const {
  StoredStep step;
  step.id = row.integer(0);
  step.parent = row.optional_integer(1);
  step.change.target = row.integer(3);
  step.operation = std::string(row.bytes(5));
  step.texels_changed = static_cast<std::size_t>(row.integer(6));
  const std::string name = "its step " + std::to_string(step.id);
  // Otherwise a history could run in circles.
  if (step.parent && *step.parent >= step.id) {
    database_.fail("is damaged: " + name + " is older than the one that it was made on");
  }
  if (!from_name(row.bytes(2), step.change.step)) {
    database_.fail("is damaged: " + name + " is of no kind that this program knows");
  }
  if (row.is_null(4)) return step;
  try {
    read_details(parse_json(row.bytes(4), name), step.change);
  } catch (const InvalidInput& error) {
    database_.fail("is damaged: " + name + ": " + error.what());
  }
  return step;
}

StoredStep StoredHistory::step(std::int64_t id) const {
  Statement row(database_, std::string(step_columns) + "FROM steps WHERE id = ?");
  row.bind(1, id);
  if (!row.step()) database_.fail("is damaged: its step " + std::to_string(id) + " is missing");
  return read_step(row);
}

std::vector<StoredStep> StoredHistory::path_to(Step step) const {
  std::vector<StoredStep> path;
  Statement row(database_, std::string(step_columns) + "FROM steps WHERE id = ?");
  for (Step at = step; at; at = path.back().parent) {
    row.bind(1, *at);
    if (!row.step()) database_.fail("is damaged: its step " + std::to_string(*at) + " is missing");
    path.push_back(read_step(row));
    row.reset();
  }
  std::reverse(path.begin(), path.end());
  return path;
}

std::vector<StoredStep> StoredHistory::all() const {
  std::vector<StoredStep> steps;
  Statement row(database_, std::string(step_columns) + "FROM steps ORDER BY id");
  while (row.step()) steps.push_back(read_step(row));
  return steps;
}

void StoredHistory::set_next(Step step, Step next) const {
  Statement row(database_,
                step ? "UPDATE steps SET next = ? WHERE id = ?" : "UPDATE document SET first = ?");
  row.bind(1, next);
  if (step) row.bind(2, *step);
  row.run();
}

void StoredHistory::go_to(Step step, Step earlier, Step later) const {
  set_next(earlier, later);
  Statement(database_, "UPDATE document SET position = ?").bind(1, step).run();
}

StoredHistory::Step StoredHistory::present_version(const TilePlace& place,
                                                   std::int64_t layer) const {
  Statement row(
      database_,
      "SELECT version FROM tiles WHERE texture_set = ? AND attribute = ? AND tile = ? AND "
      "layer = ?");
  row.bind(1, std::int64_t{place.set}).bind(2, name_of(place.attribute));
  row.bind(3, std::int64_t{place.tile}).bind(4, layer);
  return row.step() ? row.optional_integer(0) : std::nullopt;
}

std::int64_t StoredHistory::add_version(Step step, const PackedTile& tile, Step previous) const {
  Statement row(
      database_,
      "INSERT INTO tile_versions(step, layer, texture_set, attribute, tile, previous, bytes) "
      "VALUES(?, ?, ?, ?, ?, ?, ?)");
  const TilePlace& place = tile.place;
  row.bind(1, step).bind(2, tile.layer).bind(3, std::int64_t{place.set});
  row.bind(4, name_of(place.attribute)).bind(5, std::int64_t{place.tile}).bind(6, previous);
  if (tile.bytes.empty()) {
    row.bind_null(7);
  } else {
    row.bind_blob(7, tile.bytes);
  }
  row.run();
  return database_.last_id();
}

void StoredHistory::set_present(const TilePlace& place, std::int64_t layer, Step version) const {
  Statement row(database_,
                version ? "INSERT OR REPLACE INTO tiles(texture_set, attribute, tile, layer, "
                          "version) VALUES(?, ?, ?, ?, ?)"
                        : "DELETE FROM tiles WHERE texture_set = ? AND attribute = ? AND "
                          "tile = ? AND layer = ?");
  row.bind(1, std::int64_t{place.set}).bind(2, name_of(place.attribute));
  row.bind(3, std::int64_t{place.tile}).bind(4, layer);
  if (version) row.bind(5, version);
  row.run();
}

std::int64_t StoredHistory::next_id() const {
  Statement row(database_, "SELECT coalesce(max(id), 0) + 1 FROM steps");
  row.step();
  return row.integer(0);
}

std::int64_t StoredHistory::add(const StackChange& change, std::string_view operation,
                                std::size_t texels, std::string_view packed_recipe,
                                const std::vector<TileChange>& changes) const {
  const Step before = position();
  const std::string details = to_json(details_of(change));
  Statement row(database_,
                "INSERT INTO steps(parent, step, target, details, operator, texels, recipe) "
                "VALUES(?, ?, ?, ?, ?, ?, ?)");
  row.bind(1, before).bind(2, name_of(change.step)).bind(3, change.target);
  row.bind(4, std::string_view(details)).bind(5, operation);
  row.bind(6, static_cast<std::int64_t>(texels));
  if (packed_recipe.empty()) {
    row.bind_null(7);
  } else {
    row.bind_blob(7, packed_recipe);
  }
  row.run();
  const std::int64_t step = database_.last_id();
  for (const TileChange& tile : changes) {
    // What colours were imported as is known from the first change on.
    if (!tile.before.empty() && !present_version(tile.place, imported_layer)) {
      const PackedTile imported{tile.place, imported_layer, tile.before};
      set_present(tile.place, imported_layer, add_version(std::nullopt, imported, std::nullopt));
    }
    const Step previous = present_version(tile.place, tile.layer);
    const std::int64_t version = add_version(step, {tile.place, tile.layer, tile.after}, previous);
    set_present(tile.place, tile.layer, version);
  }
  go_to(step, before, step);
  return step;
}

TilePlace StoredHistory::place(const Statement& row, int column) const {
  TilePlace place;
  const std::int64_t set = row.integer(column);
  const std::int64_t tile = row.integer(column + 2);
  constexpr std::int64_t most = 1 << 30;
  if (set < 0 || set > most || tile < 0 || tile > most ||
      !from_name(row.bytes(column + 1), place.attribute)) {
    database_.fail("is damaged: a tile has no place");
  }
  place.set = static_cast<std::uint32_t>(set);
  place.tile = static_cast<std::uint32_t>(tile);
  return place;
}

std::string StoredHistory::bytes_of(std::int64_t version) const {
  Statement row(database_, "SELECT bytes FROM tile_versions WHERE id = ?");
  row.bind(1, version);
  if (!row.step()) database_.fail("is damaged: a version of a tile is missing");
  return std::string(row.bytes(0));
}

std::vector<PackedTile> StoredHistory::step_back(std::int64_t from) const {
  const Step to = parent(from);
  std::vector<PackedTile> tiles;
  Statement row(
      database_,
      "SELECT texture_set, attribute, tile, layer, previous FROM tile_versions WHERE step = ?");
  row.bind(1, from);
  while (row.step()) {
    const Step version = row.optional_integer(4);
    tiles.push_back({place(row, 0), row.integer(3), version ? bytes_of(*version) : std::string()});
    set_present(tiles.back().place, tiles.back().layer, version);
  }
  go_to(to, to, from);
  return tiles;
}

std::vector<PackedTile> StoredHistory::step_on(std::int64_t to) const {
  std::vector<PackedTile> tiles;
  Statement row(
      database_,
      "SELECT texture_set, attribute, tile, layer, bytes, id FROM tile_versions WHERE step = ?");
  row.bind(1, to);
  while (row.step()) {
    tiles.push_back({place(row, 0), row.integer(3), std::string(row.bytes(4))});
    set_present(tiles.back().place, tiles.back().layer, row.integer(5));
  }
  go_to(to, parent(to), to);
  return tiles;
}

void StoredHistory::visit_tiles(const Visit& visit) const {
  Statement row(database_,
                "SELECT t.texture_set, t.attribute, t.tile, t.layer, v.bytes, v.id, v.step "
                "FROM tiles t LEFT JOIN tile_versions v ON v.id = t.version AND v.texture_set = "
                "t.texture_set AND v.attribute = t.attribute AND v.tile = t.tile AND v.layer = "
                "t.layer ORDER BY t.texture_set, t.attribute, t.tile");
  while (row.step()) {
    if (row.is_null(5)) database_.fail("is damaged: a version of a tile is missing");
    visit({row.integer(5), {place(row, 0), row.integer(3), std::string(row.bytes(4))}},
          row.optional_integer(6));
  }
}

void StoredHistory::visit_versions(const Visit& visit) const {
  Statement row(database_,
                "SELECT texture_set, attribute, tile, layer, bytes, id, step FROM tile_versions");
  while (row.step()) {
    visit({row.integer(5), {place(row, 0), row.integer(3), std::string(row.bytes(4))}},
          row.optional_integer(6));
  }
}

std::vector<PackedTile> StoredHistory::tiles_after(std::int64_t step, std::int64_t layer) const {
  std::map<TilePlace, Step> versions;
  Statement row(
      database_,
      "SELECT texture_set, attribute, tile, previous FROM tile_versions WHERE step = ? AND "
      "layer = ?");
  // Backwards, so that the version before the first change stays.
  for (Step at = position(); at && *at > step; at = parent(*at)) {
    row.bind(1, *at).bind(2, layer);
    while (row.step()) versions[place(row, 0)] = row.optional_integer(3);
    row.reset();
  }
  std::vector<PackedTile> tiles;
  tiles.reserve(versions.size());
  for (const auto& [where, version] : versions) {
    tiles.push_back({where, layer, version ? bytes_of(*version) : std::string()});
  }
  return tiles;
}

std::vector<PackedTile> StoredHistory::tiles_at(const TilePlace& where) const {
  Statement row(
      database_,
      "SELECT t.layer, v.bytes FROM tiles t JOIN tile_versions v ON v.id = t.version WHERE "
      "t.texture_set = ? AND t.attribute = ? AND t.tile = ?");
  row.bind(1, std::int64_t{where.set}).bind(2, name_of(where.attribute));
  row.bind(3, std::int64_t{where.tile});
  std::vector<PackedTile> tiles;
  while (row.step()) tiles.push_back({where, row.integer(0), std::string(row.bytes(1))});
  return tiles;
}

}  // namespace normalshop
