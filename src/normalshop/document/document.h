#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "normalshop/chart/cover.h"
#include "normalshop/chart/curvature_term.h"
#include "normalshop/chart/push.h"
#include "normalshop/chart/storage.h"
#include "normalshop/chart/transfer.h"
#include "normalshop/core/progress.h"
#include "normalshop/document/document_file.h"
#include "normalshop/document/edit.h"
#include "normalshop/surface/seams.h"

namespace normalshop {

/// Seconds that an edit spent in each stage.
struct EditTimes {
  double pull = 0.0;
  double operate = 0.0;
  double push = 0.0;
};

/// What an edit did.
struct EditReport {
  int chart_width = 0;
  int chart_height = 0;
  float pixel = 0.0F;  ///< object units
  /// Of the finest texels along a pixel's side. Above 1 where they are more than the largest chart
  /// has pixels, and take an interpolated change.
  float texels_per_pixel = 0.0F;
  int tiles = 1;      ///< that the chart was cut into
  int views = 0;      ///< that the edit looked from; the chart above is that of the largest
  PushResult pushed;  ///< of a mirrored edit both sides' one after the other: overlaps count twice
  std::size_t colors_changed = 0;  ///< texels (of a picture: pixels) of the colours, likewise
  /// How high a relief along the base normals is beside their curvature; else 0.
  ReliefReach relief;
  EditTimes times;
  TransferOptions transfer = {};
  /// Texels that the edit reached and the update did not write: 0 with Update::Gather.
  std::size_t lost = 0;

  bool coarser_than_texels() const { return texels_per_pixel > 1.01F; }
};

class LiveEdit;

/// A model, its storage atlas and the edits made to it, in memory or kept in a file. All changes go
/// through apply() and begin(), undo() and redo(): the command line, the studio and scripts use
/// this facade and nothing else.
class Document {
 public:
  /// One texture set's maps.
  struct Maps {
    NormalMap normals;
    ColorMap albedo;
  };

  /// One Maps per entry of mesh.texture_set_names. Computes MikkTSpace tangents when the mesh has
  /// none, and which triangle each texel shows. Throws InvalidInput when the numbers don't fit.
  Document(Mesh mesh, std::vector<Maps> maps, const Progress& progress = {});

  const Mesh& mesh() const { return mesh_; }
  const StorageAtlas& storage() const { return storage_; }
  /// Of the mesh.
  const std::vector<SeamEdge>& seams() const { return seams_; }
  /// All edits that are not undone; of a document on file those that are enabled, in layers that
  /// are not hidden, from the lowest on: it reads them anew, which takes a while.
  std::vector<Edit> log() const;

  /// What loads the files that edits name, given these.
  using AssetsOf = std::function<std::unique_ptr<Assets>(std::vector<NamedFile>)>;
  /// Makes the maps, still as they were imported, what they are in the file, and keeps every edit
  /// there from now on. Throws DocumentError for a damaged tile, or one that does not fit.
  void keep_in(std::shared_ptr<DocumentFile> file, AssetsOf assets);
  /// Null in memory.
  const DocumentFile* file() const { return file_.get(); }

  /// Applies an edit and adds it to the log, and to the file. Throws InvalidInput when a stroke
  /// does not meet the surface that its view shows, or for another transfer than the usual one
  /// where there is a file, and DocumentError when that cannot be written; the document is
  /// unchanged then.
  EditReport apply(const Edit& edit, const TransferOptions& transfer = {});

  /// Opens an edit whose strokes are still to be drawn: see live_edit.h. Its window is the view.
  /// Throws InvalidInput when the view shows no surface, and for the view "surface".
  std::unique_ptr<LiveEdit> begin(Edit edit);

  /// A document on file goes a step back or forward, without limit and whenever the step was made.
  /// False where there is none. Takes as long as the tiles are that the step changed. Throws
  /// DocumentError, and nothing has changed then.
  bool undo();
  bool redo();
  /// Goes to any step of any branch; none: to the imported maps. Throws InvalidInput where there is
  /// no such step, and DocumentError.
  void jump(std::optional<std::int64_t> step);

  /// The layers of a document on file.
  const EditStack& stack() const { return stack_; }
  /// The layer that edits go to: the topmost that shows, unless another is chosen.
  std::int64_t active_layer() const;
  /// Throws InvalidInput where there is no such layer.
  void choose_layer(std::int64_t layer);
  /// Layers, or which edits count, of a document on file: an undoable step. Edits that stood on
  /// what changes are made again. Throws InvalidInput for what the stack cannot take and for an
  /// edit that cannot be made any more, DocumentError, and Cancelled; nothing has changed then.
  void change(const StackChange& change, const Progress& progress = {});
  /// Gives an edit of a document on file another recipe. Throws like change().
  void change_edit(std::int64_t edit, const Edit& recipe, const Progress& progress = {});

 private:
  friend class LiveEdit;
  /// Adds an edit that the maps hold already. Where that fails they become what they were.
  void record(Edit edit, const EditReport& report, const MapsBefore* before);
  /// Adds a step to the file, and makes the layers anew that it changes.
  EditReport restack(const NewStep& step, const Progress& progress);
  Edit load_edit(std::int64_t step) const;
  /// Throws InvalidInput for a hidden layer.
  void check_seen(std::int64_t layer) const;
  /// Can an edit be made on what the maps show?
  bool shows_active_layer() const;
  void take_stack(EditStack stack);
  void follow(const HistoryMove& move);
  void show_all();
  void show(const TilePlace& place, const std::vector<PackedTile>& tiles);
  /// Codes of colours are those that came until an edit moves one, so that an edit reads the same
  /// whether the document was closed before it or not.
  void end_color_edits();
  Mesh mesh_;
  StorageAtlas storage_;
  std::vector<SeamEdge> seams_;
  SurfaceCover cover_;
  std::shared_ptr<DocumentFile> file_;
  AssetsOf assets_of_;  // of a document on file
  EditStack stack_;
  std::optional<std::int64_t> active_layer_;
  std::vector<Edit> log_;  // of one in memory
  bool live_ = false;      // an edit is being drawn
};

}  // namespace normalshop
