#pragma once

#include <vector>

#include "normalshop/core/border.h"
#include "normalshop/core/normal_map.h"
#include "normalshop/document/document.h"

namespace normalshop {

/// A picture with normals (an RGBN image) and the edits made to it. Its base surface is the plane
/// of the picture, so that its editing chart is the picture itself and pull and push are the
/// identity.
///
/// Edits are those of meshes. Their lengths are in pixels, their points count from the picture's
/// middle, x right and y up (its sides are at -width / 2 and width / 2). They look from the front:
/// at the whole picture, or at a part around a `center` or the point that they are `facing`.
class ImageDocument {
 public:
  struct Images {
    NormalMap normals;  ///< tangent space
    ColorImage colors;  ///< linear; empty: none
    MaskImage mask;     ///< 0 to 1: how far an edit arrives; empty: everywhere
    /// Wrap: the picture is a tile. Whatever leaves it at one side enters at the other.
    Border border = Border::Clamp;
  };

  /// Throws InvalidInput when sizes differ, or for normals in another space.
  explicit ImageDocument(Images images);

  const NormalMap& normals() const { return images_.normals; }
  const ColorImage& colors() const { return images_.colors; }
  /// Empty: edits arrive everywhere.
  const MaskImage& mask() const { return images_.mask; }
  Border border() const { return images_.border; }
  const std::vector<Edit>& log() const { return log_; }

  /// Applies an edit and adds it to the log. Throws InvalidInput, and nothing has changed then, for
  /// a view that does not look from the front and for strokes beside the picture.
  EditReport apply(const Edit& edit);

 private:
  Images images_;
  std::vector<Edit> log_;
};

/// The slopes of a picture, and where they count: 1 inside the mask where there is a normal.
struct PictureSlopes {
  SlopeImage slopes;
  MaskImage validity;
};
PictureSlopes slopes_of(const ImageDocument& document);

}  // namespace normalshop
