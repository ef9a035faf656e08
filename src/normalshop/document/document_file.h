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
#include "normalshop/document/edit_stack.h"
#include "normalshop/document/map_tiles.h"
#include "normalshop/document/value.h"

namespace normalshop {

struct StoredStep;

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
  std::optional<std::int64_t> parent;  ///< the step that it was made on; none: the imported maps
  StackChange change;
  std::string operation;  ///< of an edit, or of what it is changed to
  std::size_t texels_changed = 0;
  bool undone = false;
};
/// "pen in layer 2", "pen: changes edit 3", "sets layer 2: hidden".
std::string sentence(const HistoryEntry& entry);

/// A step to be added.
struct NewStep {
  StackChange change;
  const Edit* edit = nullptr;  ///< of StackStep::Edit and Change
  std::size_t texels_changed = 0;
};

/// What has become different by going through the history.
struct HistoryMove {
  std::vector<TilePlace> places;
  std::vector<HistoryEntry> back;  ///< steps taken back, in that order
  std::vector<HistoryEntry> on;    ///< and taken after that
  bool restacked = false;          ///< any of them is no edit: any place may have changed
};

/// A document's file (docs/document.md): what was imported, byte for byte, every edit as a recipe,
/// the tiles that each step made, and where in the history the document is. What a call has written
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

  /// From the first step on; those that redo() would bring back at the end.
  std::vector<HistoryEntry> history() const;
  /// Every step that was ever made, in that order; undone: not on the way to the present one.
  std::vector<HistoryEntry> all_steps() const;
  /// The layers as they are now.
  EditStack stack() const;
  /// The recipe of its own that a step holds, and the one edit in it.
  Value recipe(std::int64_t step) const;
  Value edit(std::int64_t step) const;
  /// All edits that are enabled in layers that are not hidden, from the lowest on, as one recipe.
  Value recipe() const;
  /// What the options of a step's edit name.
  std::vector<NamedFile> files_of(std::int64_t step) const;

  /// The tiles of all layers, and imported colours where they have changed, by their places.
  std::vector<PackedTile> tiles() const;
  std::vector<PackedTile> tiles_at(const TilePlace& place) const;
  /// The layers that have tiles of a texture set's colours.
  std::vector<std::int64_t> color_layers(std::uint32_t set) const;
  /// The tiles of a layer that have changed since a step on the way to the present one, as they
  /// were after it.
  std::vector<PackedTile> tiles_after(std::int64_t step, std::int64_t layer) const;
  /// The latest step on the way to the present one after which a layer held the first of these
  /// recipes, more than `least`, above the same lower layers; how many it held.
  struct Snapshot {
    std::int64_t step = 0;
    std::size_t recipes = 0;
  };
  std::optional<Snapshot> find_snapshot(const EditStack& wanted, std::size_t layer,
                                        std::size_t least) const;

  /// Adds a step behind the present one. Those that were undone stay in the file.
  /// Returns its number.
  std::int64_t add(const NewStep& step, const std::vector<TileChange>& changes);
  /// The number of the step that add() makes next.
  std::int64_t next_step() const;
  /// Takes a step back, or brings the one that was here last back, or goes to any other; none:
  /// there is nothing to undo or redo. Before anything changes, `check` may throw InvalidInput for
  /// a tile. jump() throws InvalidInput when there is no such step; none: the imported maps.
  using TileCheck = std::function<void(const PackedTile&)>;
  std::optional<HistoryMove> undo(const TileCheck& check = check_tile);
  std::optional<HistoryMove> redo(const TileCheck& check = check_tile);
  HistoryMove jump(std::optional<std::int64_t> step, const TileCheck& check = check_tile);

  /// Reads everything; what is wrong, in a sentence each.
  std::vector<std::string> check() const;
  /// Version, size, texture sets and history, for people and programs.
  Value summary() const;
  /// Throws DocumentError for a tile that is damaged as `what` says.
  [[noreturn]] void fail_at(const TilePlace& place, const char* what) const;
  /// "the tile 3, 5 of the normals of 'skin'".
  std::string name_of_tile(const TilePlace& place) const;

 private:
  struct State;
  void read_head();
  HistoryMove walk(std::optional<std::int64_t> to, const TileCheck& check);
  void check_revealed(const HistoryMove& move, const TileCheck& check) const;
  EditStack fold(const std::vector<StoredStep>& path) const;

  bool recovered_;
  std::unique_ptr<State> state_;
  Value import_;
  std::vector<StoredSet> sets_;
};

}  // namespace normalshop
