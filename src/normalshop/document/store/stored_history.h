#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "normalshop/document/edit_stack.h"
#include "normalshop/document/map_tiles.h"
#include "normalshop/document/store/database.h"

namespace normalshop {

/// A tile of a layer as a step left it.
struct TileVersion {
  std::int64_t id = 0;
  PackedTile tile;
};

/// A step as it is kept.
struct StoredStep {
  std::int64_t id = 0;
  std::optional<std::int64_t> parent;
  StackChange change;
  std::string operation;  ///< of an edit, or of what it becomes
  std::size_t texels_changed = 0;
};

/// The steps of a document with the tiles that they made, and where in them it is. Each step knows
/// the one that it was made on, each version of a tile the one before: undo and redo cost what the
/// step touched, whatever the length of the history.
///
/// What changes something belongs into a transaction of the caller.
class StoredHistory {
 public:
  using Step = std::optional<std::int64_t>;  ///< none: the imported maps

  explicit StoredHistory(const Database& database) : database_(database) {}

  Step position() const;
  Step parent(std::int64_t step) const;
  /// Made on this one, and gone to last.
  Step next(Step step) const;
  StoredStep step(std::int64_t id) const;
  /// From the first one to this one.
  std::vector<StoredStep> path_to(Step step) const;
  /// All there are, in the order that they were made in.
  std::vector<StoredStep> all() const;

  /// Makes a step at the position, and it the position. Returns its id.
  std::int64_t add(const StackChange& change, std::string_view operation, std::size_t texels,
                   std::string_view packed_recipe, const std::vector<TileChange>& changes) const;
  /// The id that add() gives next.
  std::int64_t next_id() const;
  /// From the position to its parent, or to a step made on it: the tiles that change, as they
  /// become.
  std::vector<PackedTile> step_back(std::int64_t from) const;
  std::vector<PackedTile> step_on(std::int64_t to) const;

  /// Each tile of the present state by its place, or each version of each tile, with the step that
  /// made it.
  using Visit = std::function<void(const TileVersion&, const Step& step)>;
  void visit_tiles(const Visit& visit) const;
  void visit_versions(const Visit& visit) const;
  /// The tiles of a layer that steps after this one on the way to the present one have changed, as
  /// they were after it.
  std::vector<PackedTile> tiles_after(std::int64_t step, std::int64_t layer) const;
  /// The present tiles of all layers at a place.
  std::vector<PackedTile> tiles_at(const TilePlace& place) const;

 private:
  void go_to(Step from, Step to, Step next) const;
  void set_next(Step step, Step next) const;
  Step present_version(const TilePlace& place, std::int64_t layer) const;
  std::int64_t add_version(Step step, const PackedTile& tile, Step previous) const;
  void set_present(const TilePlace& place, std::int64_t layer, Step version) const;
  TilePlace place(const Statement& row, int column) const;
  std::string bytes_of(std::int64_t version) const;
  StoredStep read_step(const Statement& row) const;

  const Database& database_;
};

}  // namespace normalshop
