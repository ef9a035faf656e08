#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "normalshop/chart/details.h"
#include "normalshop/chart/view.h"
#include "normalshop/document/edit_operator.h"

namespace normalshop {

/// A view as a recipe gives it; height 0: as high as wide.
struct FreeView {
  Vec3f direction = Vec3f::UnitZ();  ///< from the surface to the viewer
  Vec3f up = Vec3f::UnitY();
  std::optional<Vec3f> center;  ///< none: the view frames the whole model
  float width = 0.0F;
  float height = 0.0F;
};
struct FacingView {
  Vec3f point = Vec3f::Zero();
  float width = 0.0F;
  float height = 0.0F;
};
/// All of the surface, or what lies along strokes on it, from as many views as it takes: no mirror.
struct SurfaceView {
  int views = 0;  ///< at most; 0: chosen
};
/// A picture in the atlas's layout: how far an edit acts, 0 to 1.
struct AtlasMask {
  std::string set;  ///< the texture set that it is for; empty: each
  std::string file;
  std::shared_ptr<const MaskImage> image;
};
/// What of a surface an edit is for.
struct SurfacePart {
  /// The charts of the atlas (connected in it) that hold the surface points nearest to these;
  /// empty: all.
  std::vector<Vec3f> charts_at;
  std::vector<AtlasMask> masks;  ///< empty: all; texture sets without any are left out
  /// Width over which the masks' borders fade, across seams too: object units, or texels where
  /// these are above 0.
  float feather = 0.0F;
  float feather_texels = 0.0F;
};
using ViewSpec = std::variant<NamedView, FreeView, FacingView, SurfaceView>;
/// The one view that a spec means; not for SurfaceView.
View resolve(const ViewSpec& spec, const Mesh& mesh);

/// What happens to the details that exist under an edit.
enum class DetailsRule { Keep, Ignore };
constexpr auto names_of(DetailsRule) { return std::array<std::string_view, 2>{"keep", "ignore"}; }

/// What becomes of the curvature of the base surface under a relief along its normals.
enum class CurvatureRule {
  Drop,  ///< heights count as small beside its radius (thesis 4.3)
  Keep   ///< they are integrated, and normals are right for any height
};
constexpr auto names_of(CurvatureRule) { return std::array<std::string_view, 2>{"drop", "keep"}; }

/// Angles of the effective chart in degrees: full strength up to the first, none from the second.
struct EffectiveAngles {
  float full = 60.0F;
  float zero = 75.0F;
};

/// How much of the view the editing chart shows, in pixels as fine as its finest texels: what the
/// strokes reach, or all of it, so that the chart is there before the strokes are. Then, for
/// operators that read no details, texels count as long as they are where they face the viewer.
enum class ChartWindow { Strokes, View };
constexpr auto names_of(ChartWindow) { return std::array<std::string_view, 2>{"strokes", "view"}; }

/// A plane of symmetry: where an object-space coordinate has a value.
enum class Axis { X, Y, Z };
constexpr auto names_of(Axis) { return std::array<std::string_view, 3>{"x", "y", "z"}; }
struct MirrorPlane {
  Axis axis = Axis::X;
  float at = 0.0F;
};

/// A point of a stroke on the surface, in object space; the stroke goes through the surface point
/// nearest to it.
struct SurfaceStrokePoint {
  Vec3f position;
  float pressure = 1.0F;
};
/// Joined by the straightest ways on the surface (surface/geodesic.h).
using SurfaceStroke = std::vector<SurfaceStrokePoint>;

/// One recordable change: view + operator + options + strokes. No pixels.
struct Edit {
  std::shared_ptr<const EditOperator> operation;
  ViewSpec view = NamedView::Front;
  EditMode mode = EditMode::View;
  Vec3f along = Vec3f::UnitZ();  ///< of EditMode::Along: in object space, of any length
  CurvatureRule curvature = CurvatureRule::Drop;  ///< of EditMode::Base
  DetailsRule details = DetailsRule::Keep;
  float strength = 1.0F;
  EffectiveAngles effective;
  /// Of the normals that were there, details included, to the viewer: full strength up to the first
  /// angle, none from the second. None: they make no difference.
  std::optional<EffectiveAngles> spray;
  ChartWindow window = ChartWindow::Strokes;
  std::vector<UnitStroke> strokes;
  std::vector<SurfaceStroke> surface_strokes;  ///< of a SurfaceView alone, instead of strokes
  std::optional<SurfacePart> part;             ///< of a SurfaceView alone; none: all of it
  std::optional<MirrorPlane> mirror;           ///< makes the edit's mirror image, too
  std::vector<NamedFile> files;                ///< that the operator has loaded
  std::string path;  ///< where it was read from, for messages: "scar.json: edits[0]"
};

/// A list of edits; as JSON: docs/recipes.md.
struct Recipe {
  std::vector<Edit> edits;
};

/// `assets` loads what the edits name. Throws InvalidInput naming the file and field.
Recipe parse_recipe(std::string_view json, std::string_view file, Assets& assets);
/// One edit of a recipe; `path` stands for it in messages.
Edit read_edit(const Value& edit, const std::string& path, Assets& assets);
Value to_value(const Recipe& recipe);

}  // namespace normalshop
