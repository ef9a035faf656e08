#pragma once

#include <memory>
#include <vector>

#include "normalshop/chart/cover.h"
#include "normalshop/chart/curvature_term.h"
#include "normalshop/chart/push.h"
#include "normalshop/chart/storage.h"
#include "normalshop/chart/transfer.h"
#include "normalshop/core/progress.h"
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

/// A model, its storage atlas and the edits made to it. All changes go through apply() and begin():
/// the command line, the studio and scripts use this facade and nothing else.
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
  const std::vector<Edit>& log() const { return log_; }

  /// Applies an edit and adds it to the log. Throws InvalidInput when a stroke does not meet the
  /// surface that its view shows; the document is unchanged then.
  EditReport apply(const Edit& edit, const TransferOptions& transfer = {});

  /// Opens an edit whose strokes are still to be drawn: see live_edit.h. Its window is the view.
  /// Throws InvalidInput when the view shows no surface, and for the view "surface".
  std::unique_ptr<LiveEdit> begin(Edit edit);

 private:
  friend class LiveEdit;
  Mesh mesh_;
  StorageAtlas storage_;
  std::vector<SeamEdge> seams_;
  SurfaceCover cover_;
  std::vector<Edit> log_;
  bool live_ = false;  // an edit is being drawn
};

}  // namespace normalshop
