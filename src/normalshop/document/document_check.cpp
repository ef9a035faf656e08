#include <map>
#include <set>
#include <system_error>
#include <utility>

#include "normalshop/core/error.h"
#include "normalshop/core/options.h"
#include "normalshop/document/document_file.h"
#include "normalshop/document/store/document_state.h"
#include "normalshop/document/store/schema.h"

namespace normalshop {

namespace {

using Faults = std::vector<std::string>;

/// What SQLite finds in the structure of its file.
void check_structure(const Database& database, Faults& faults) {
  Statement integrity(database, "PRAGMA integrity_check(20)");
  while (integrity.step()) {
    if (integrity.bytes(0) != "ok") faults.emplace_back(integrity.bytes(0));
  }
  Statement keys(database, "PRAGMA foreign_key_check");
  while (keys.step()) {
    faults.push_back("a row of the table " + std::string(keys.bytes(0)) +
                     " names something that is missing");
  }
}

/// `read` throws where something is wrong.
template <class Read>
void note_faults(const Read& read, Faults& faults) {
  try {
    read();
  } catch (const DocumentError& error) {
    faults.emplace_back(error.what());
  }
}

std::string sentence(const DocumentFile& file, const TilePlace& place,
                     const StoredHistory::Step& step, const std::string& what) {
  return file.name_of_tile(place) +
         (step ? " after step " + std::to_string(*step) : " as it was imported") + " " + what;
}

/// The version of a layer's tile that a step left.
struct LeftTile {
  std::int64_t step = 0;
  std::int64_t version = 0;
};
using LeftTiles = std::map<std::pair<TilePlace, std::int64_t>, LeftTile>;

/// By the steps that are not undone.
LeftTiles left_tiles(const DocumentFile& file, const StoredHistory& history) {
  std::set<std::int64_t> path;
  for (const HistoryEntry& entry : file.history()) {
    if (!entry.undone) path.insert(entry.id);
  }
  LeftTiles tiles;
  history.visit_versions([&](const TileVersion& version, const StoredHistory::Step& step) {
    if (!step || !path.contains(*step)) return;
    LeftTile& left = tiles[{version.tile.place, version.tile.layer}];
    if (*step > left.step) left = {*step, version.id};
  });
  return tiles;
}

/// Whether the present tiles are these.
void check_present(const DocumentFile& file, const StoredHistory& history, Faults& faults) {
  LeftTiles expected = left_tiles(file, history);
  history.visit_tiles([&](const TileVersion& version, const StoredHistory::Step& step) {
    const auto found = expected.find({version.tile.place, version.tile.layer});
    const bool known = found != expected.end();
    if (known ? found->second.version != version.id : step.has_value()) {
      faults.push_back(file.name_of_tile(version.tile.place) + " is not what the last step made");
    }
    if (known) expected.erase(found);
  });
  for (const auto& [key, left] : expected) {
    faults.push_back(file.name_of_tile(key.first) + " lacks what step " +
                     std::to_string(left.step) + " made");
  }
}

Value sets_value(const std::vector<StoredSet>& sets) {
  Value::Array out;
  for (const StoredSet& set : sets) {
    out.push_back(Value::Object{{"name", set.name},
                                {"size", Value::Array{set.width, set.height}},
                                {"space", name_of(set.convention.space)},
                                {"green", set.convention.green_down ? "down" : "up"}});
  }
  return out;
}

}  // namespace

std::string DocumentFile::name_of_tile(const TilePlace& place) const {
  std::string name = "tile " + std::to_string(place.tile);
  if (place.set >= sets_.size()) return name + " of no texture set";
  const StoredSet& set = sets_[place.set];
  if (place.attribute == Attribute::Normals) {
    const auto columns = static_cast<std::uint32_t>(NormalMap::tiles_along(set.width));
    name = "tile (" + std::to_string(place.tile % columns) + ", " +
           std::to_string(place.tile / columns) + ")";
  }
  return "the " + name + " of the " + std::string(normalshop::name_of(place.attribute)) + " of '" +
         set.name + "'";
}

std::vector<std::string> DocumentFile::check() const {
  Faults faults;
  const Database& database = state_->database;
  note_faults([&] { check_structure(database, faults); }, faults);
  note_faults(
      [&] {
        Statement row(database, "SELECT name FROM imported_files ORDER BY name");
        while (row.step()) {
          const std::string name(row.bytes(0));
          note_faults([&] { read_file(name); }, faults);
        }
      },
      faults);
  note_faults(
      [&] {
        Statement row(database, "SELECT id FROM steps WHERE recipe IS NOT NULL ORDER BY id");
        while (row.step()) {
          note_faults([&] { recipe(row.integer(0)); }, faults);
          note_faults([&] { files_of(row.integer(0)); }, faults);
        }
      },
      faults);
  note_faults(
      [&] {
        state_->history.visit_versions(
            [&](const TileVersion& version, const StoredHistory::Step& step) {
              const PackedTile& tile = version.tile;
              try {
                check_tile(tile);
              } catch (const InvalidInput& error) {
                faults.push_back(sentence(*this, tile.place, step, error.what()));
              }
            });
      },
      faults);
  note_faults([&] { check_present(*this, state_->history, faults); }, faults);
  return faults;
}

Value DocumentFile::summary() const {
  const Database& database = state_->database;
  const auto count = [&](const char* sql) {
    Statement row(database, sql);
    return row.step() ? static_cast<std::size_t>(row.integer(0)) : std::size_t{0};
  };
  std::size_t undone = 0;
  for (const HistoryEntry& entry : history()) undone += entry.undone ? 1 : 0;
  Statement head(database, "SELECT written_by FROM document");
  std::error_code error;
  return Value::Object{
      {"document version", document_version()},
      {"written by", head.step() ? std::string(head.bytes(0)) : std::string()},
      {"bytes", static_cast<std::size_t>(std::filesystem::file_size(path(), error))},
      {"imported files", count("SELECT count(*) FROM imported_files")},
      {"steps", count("SELECT count(*) FROM steps")},
      {"undone steps", undone},
      {"edited tiles",
       count("SELECT count(*) FROM tiles t JOIN tile_versions v ON v.id = t.version "
             "WHERE v.step IS NOT NULL AND v.bytes IS NOT NULL")},
      {"layer", layers_value(stack())},
      {"texture set", sets_value(sets_)}};
}

}  // namespace normalshop
