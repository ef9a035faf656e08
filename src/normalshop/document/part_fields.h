#pragma once

#include "normalshop/document/edit.h"

/// The field "part" of an edit.
namespace normalshop {

/// `surface`: is the edit's view the surface? `assets` loads the masks. Throws InvalidInput naming
/// the field.
SurfacePart read_part(const FieldReader& reader, bool surface, Assets& assets);
Value part_value(const SurfacePart& part);

}  // namespace normalshop
