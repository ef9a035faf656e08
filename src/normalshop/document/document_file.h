#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "normalshop/core/normal_map.h"
#include "normalshop/document/edit.h"
#include "normalshop/document/map_tiles.h"
#include "normalshop/document/value.h"

namespace normalshop {

/// A texture set as it was imported.
struct StoredSet {
  std::string name;
  int width = 0;  ///< of its normals
  int height = 0;
  NormalConvention convention;
};

/// A line of the history.
struct HistoryEntry {
  std::int64_t id = 0;
  std::string operation;
  std::size_t texels_changed = 0;
  bool undone = false;
};

/// A document's file (docs/document.md): what was imported, byte for byte, every edit as a recipe,
/// the tiles that each edit made, and where in the history the document is. What a call has written
/// is on the disk when it returns, and all of it or nothing, whatever happens to program or power.
/// No other program can have the file open meanwhile. Everything throws DocumentError naming the
/// file.
class DocumentFile {
 public:
  /// What a document begins with.
  struct Contents {
    Value import;                  ///< how it was imported: whoever imports reads it again
    std::vector<NamedFile> files;  ///< by different names
    std::vector<StoredSet> sets;
  };
  /// Makes a document in a file that is empty or missing.
  static void create(const std::filesystem::path& path, const Contents& contents);

  /// Does the file begin like one? Never throws.
  static bool is_one(const std::filesystem::path& path);

  /// Opens a document; older ones are brought up to date.
  explicit DocumentFile(const std::filesystem::path& path);
  ~DocumentFile();
  DocumentFile(const DocumentFile&) = delete;
  DocumentFile& operator=(const DocumentFile&) = delete;

  const std::filesystem::path& path() const;
  /// Then nothing but reading works.
  bool read_only() const;
  /// The program that had it open last was broken off; every finished edit is here.
  bool recovered() const { return recovered_; }
  /// That as a sentence for the user, if so.
  std::vector<std::string> notes() const;

  const Value& import() const { return import_; }
  const std::vector<StoredSet>& sets() const { return sets_; }
  bool has_file(const std::string& name) const;
  /// An imported file.
  std::string read_file(const std::string& name) const;

  /// From the first edit on; those that redo() would bring back at the end.
  std::vector<HistoryEntry> history() const;
  /// The edit as a recipe of its own.
  Value recipe(std::int64_t edit) const;
  /// All edits that are not undone as one recipe.
  Value recipe() const;
  /// What the edit's options name.
  std::vector<NamedFile> files_of(std::int64_t edit) const;

  /// The tiles that differ from the imported maps.
  std::vector<PackedTile> tiles() const;
  /// Does the texture set have tiles of edited colours?
  bool has_colors(std::uint32_t set) const;
  /// Adds an edit behind the present one. Those that were undone stay in the file.
  void add(const Edit& edit, std::size_t texels_changed, const std::vector<TileChange>& changes);
  /// Takes an edit back, or brings the next one (the youngest, where there are several) back.
  /// Returns what becomes of the tiles that it changed; none: there is nothing to undo or redo.
  /// Before anything changes, `check` may throw InvalidInput for a tile.
  using TileCheck = std::function<void(const PackedTile&)>;
  std::optional<std::vector<PackedTile>> undo(const TileCheck& check = check_tile);
  std::optional<std::vector<PackedTile>> redo(const TileCheck& check = check_tile);

  /// Reads everything; what is wrong, in a sentence each.
  std::vector<std::string> check() const;
  /// Version, size, texture sets and history, for people and programs.
  Value summary() const;
  /// "the tile 3, 5 of the normals of 'skin'".
  std::string name_of_tile(const TilePlace& place) const;

 private:
  struct State;
  void read_head();
  void check_tiles(const std::vector<PackedTile>& tiles, const TileCheck& check) const;

  bool recovered_;
  std::unique_ptr<State> state_;
  Value import_;
  std::vector<StoredSet> sets_;
};

}  // namespace normalshop
