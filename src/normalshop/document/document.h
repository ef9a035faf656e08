#pragma once

#include <functional>
#include <memory>
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
  /// The edit covers more texels than the largest chart has pixels: the finest take an interpolated
  /// change.
  bool coarser_than_texels = false;
  int views = 0;      ///< that the edit looked from; the chart above is that of the largest
  PushResult pushed;  ///< of a mirrored edit both sides' one after the other: overlaps count twice
  std::size_t colors_changed = 0;  ///< texels (of a picture: pixels) of the colours, likewise
  /// How high a relief along the base normals is beside their curvature; else 0.
  ReliefReach relief;
  EditTimes times;
  TransferOptions transfer = {};
  /// Texels that the edit reached and the update did not write: 0 with Update::Gather.
  std::size_t lost = 0;
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
  /// All edits that are not undone. A document on file reads them anew, which takes a while.
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

  /// A document on file goes an edit back or forward, without limit and whenever the edit was made.
  /// False where there is none. Takes as long as the tiles are that the edit changed. Throws
  /// DocumentError, and nothing has changed then.
  bool undo();
  bool redo();

 private:
  friend class LiveEdit;
  /// Adds an edit that the maps hold already. Where that fails they become what they were.
  void record(Edit edit, const EditReport& report, const MapsBefore* before);
  void put(const std::vector<PackedTile>& tiles);
  void end_color_edits();
  Mesh mesh_;
  StorageAtlas storage_;
  std::vector<SeamEdge> seams_;
  SurfaceCover cover_;
  std::shared_ptr<DocumentFile> file_;
  AssetsOf assets_of_;     // of a document on file
  std::vector<Edit> log_;  // of one in memory
  bool live_ = false;      // an edit is being drawn
};

}  // namespace normalshop
