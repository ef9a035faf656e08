#include "normalshop/document/store/stored_history.h"

#include "normalshop/core/error.h"
#include "normalshop/core/options.h"

namespace normalshop {

StoredHistory::Edit StoredHistory::position() const {
  Statement row(database_, "SELECT position FROM document");
  if (!row.step()) database_.fail("is damaged: its head is missing");
  return row.optional_integer(0);
}

void StoredHistory::set_position(Edit edit) const {
  Statement(database_, "UPDATE document SET position = ?").bind(1, edit).run();
}

StoredHistory::Edit StoredHistory::parent(std::int64_t edit) const {
  Statement row(database_, "SELECT parent FROM edits WHERE id = ?");
  row.bind(1, edit);
  if (!row.step()) database_.fail("is damaged: its edit " + std::to_string(edit) + " is missing");
  const Edit parent = row.optional_integer(0);
  // Otherwise a history could run in circles.
  if (parent && *parent >= edit) {
    database_.fail("is damaged: its edit " + std::to_string(edit) + " is older than the one that " +
                   "it was made on");
  }
  return parent;
}

StoredHistory::Edit StoredHistory::next(Edit edit) const {
  Statement row(database_, "SELECT max(id) FROM edits WHERE parent IS ?");
  row.bind(1, edit);
  const Edit found = row.step() ? row.optional_integer(0) : std::nullopt;
  if (found && edit && *found <= *edit) parent(*found);  // says what is wrong
  return found;
}

StoredEdit StoredHistory::edit(std::int64_t id) const {
  Statement row(database_, "SELECT operator, texels FROM edits WHERE id = ?");
  row.bind(1, id);
  if (!row.step()) database_.fail("is damaged: its edit " + std::to_string(id) + " is missing");
  return {id, std::string(row.bytes(0)), static_cast<std::size_t>(row.integer(1))};
}

StoredHistory::Edit StoredHistory::present_version(const TilePlace& place) const {
  Statement row(database_,
                "SELECT version FROM tiles WHERE texture_set = ? AND attribute = ? AND tile = ?");
  row.bind(1, std::int64_t{place.set}).bind(2, name_of(place.attribute));
  row.bind(3, std::int64_t{place.tile});
  return row.step() ? row.optional_integer(0) : std::nullopt;
}

std::int64_t StoredHistory::add_version(Edit edit, const TilePlace& place, Edit previous,
                                        std::string_view bytes) const {
  Statement row(database_,
                "INSERT INTO tile_versions(edit, texture_set, attribute, tile, previous, bytes) "
                "VALUES(?, ?, ?, ?, ?, ?)");
  row.bind(1, edit).bind(2, std::int64_t{place.set}).bind(3, name_of(place.attribute));
  row.bind(4, std::int64_t{place.tile}).bind(5, previous).bind_blob(6, bytes).run();
  return database_.last_id();
}

void StoredHistory::set_present(const TilePlace& place, Edit version) const {
  Statement row(database_,
                version ? "INSERT OR REPLACE INTO tiles(texture_set, attribute, tile, version) "
                          "VALUES(?, ?, ?, ?)"
                        : "DELETE FROM tiles WHERE texture_set = ? AND attribute = ? AND tile = ?");
  row.bind(1, std::int64_t{place.set}).bind(2, name_of(place.attribute));
  row.bind(3, std::int64_t{place.tile});
  if (version) row.bind(4, version);
  row.run();
}

std::int64_t StoredHistory::add(std::string_view operation, std::size_t texels,
                                std::string_view packed_recipe,
                                const std::vector<TileChange>& changes) const {
  Statement row(database_, "INSERT INTO edits(parent, operator, texels, edit) VALUES(?, ?, ?, ?)");
  row.bind(1, position()).bind(2, operation).bind(3, static_cast<std::int64_t>(texels));
  row.bind_blob(4, packed_recipe).run();
  const std::int64_t edit = database_.last_id();
  for (const TileChange& change : changes) {
    Edit previous = present_version(change.place);
    if (!previous && !change.before.empty()) {
      previous = add_version(std::nullopt, change.place, std::nullopt, change.before);
    }
    set_present(change.place, add_version(edit, change.place, previous, change.after));
  }
  set_position(edit);
  return edit;
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
  const Edit to = parent(from);
  std::vector<PackedTile> tiles;
  Statement row(database_,
                "SELECT texture_set, attribute, tile, previous FROM tile_versions WHERE edit = ?");
  row.bind(1, from);
  while (row.step()) {
    const Edit version = row.optional_integer(3);
    tiles.push_back({place(row, 0), version ? bytes_of(*version) : std::string()});
    set_present(tiles.back().place, version);
  }
  set_position(to);
  return tiles;
}

std::vector<PackedTile> StoredHistory::step_on(std::int64_t to) const {
  std::vector<PackedTile> tiles;
  Statement row(database_,
                "SELECT texture_set, attribute, tile, id, bytes FROM tile_versions WHERE edit = ?");
  row.bind(1, to);
  while (row.step()) {
    tiles.push_back({place(row, 0), std::string(row.bytes(4))});
    set_present(tiles.back().place, row.integer(3));
  }
  set_position(to);
  return tiles;
}

void StoredHistory::visit_tiles(const Visit& visit) const {
  Statement row(database_,
                "SELECT t.texture_set, t.attribute, t.tile, v.id, v.bytes, v.edit "
                "FROM tiles t LEFT JOIN tile_versions v ON v.id = t.version AND v.texture_set = "
                "t.texture_set AND v.attribute = t.attribute AND v.tile = t.tile");
  while (row.step()) {
    if (row.is_null(3)) database_.fail("is damaged: a version of a tile is missing");
    visit({row.integer(3), {place(row, 0), std::string(row.bytes(4))}}, row.optional_integer(5));
  }
}

void StoredHistory::visit_versions(const Visit& visit) const {
  Statement row(database_,
                "SELECT texture_set, attribute, tile, id, bytes, edit FROM tile_versions");
  while (row.step()) {
    visit({row.integer(3), {place(row, 0), std::string(row.bytes(4))}}, row.optional_integer(5));
  }
}

}  // namespace normalshop
