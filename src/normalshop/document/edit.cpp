#include "normalshop/document/edit.h"

namespace normalshop {

namespace {

View resolve_free(const FreeView& spec, const Mesh& mesh) {
  if (!spec.center) {
    View view = framing_view(mesh, spec.direction, spec.up);
    if (spec.width > 0.0F) view.width = view.height = spec.width;
    if (spec.height > 0.0F) view.height = spec.height;
    return view;
  }
  return make_view(spec.direction, spec.up, *spec.center, spec.width,
                   spec.height > 0.0F ? spec.height : spec.width);
}

}  // namespace

View resolve(const ViewSpec& spec, const Mesh& mesh) {
  if (const auto* named = std::get_if<NamedView>(&spec)) return named_view(mesh, *named);
  if (const auto* free = std::get_if<FreeView>(&spec)) return resolve_free(*free, mesh);
  const auto& facing = std::get<FacingView>(spec);
  return facing_view(mesh, facing.point, facing.width,
                     facing.height > 0.0F ? facing.height : facing.width);
}

}  // namespace normalshop
