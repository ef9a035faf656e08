#pragma once

#include "normalshop/document/edit.h"
#include "normalshop/surface/geodesic.h"

namespace normalshop {

/// A point on the way of a stroke on the surface.
struct TracePoint {
  Vec3f position;
  Vec3f normal;                ///< unit base normal
  Vec3f facing;                ///< unit mean of the base normals around it
  std::uint32_t triangle = 0;  ///< that the way goes on in
  float pressure = 1.0F;
  float along = 0.0F;  ///< length of the way before it, in object units
};

/// The way of one stroke, in points not far from each other.
using Trace = std::vector<TracePoint>;

/// How ways are sampled, in object units.
struct TraceOptions {
  float step = 0.01F;    ///< from point to point at most
  float around = 0.01F;  ///< of the way before and after a point counts for `facing`
};

/// The geodesics through an edit's surface strokes. Throws InvalidInput, naming the stroke and the
/// point, for points further from the surface than a twentieth of the model's size, and where no
/// way leads from one to the next.
std::vector<Trace> trace_strokes(const Edit& edit, const Mesh& mesh, const Topology& topology,
                                 const TraceOptions& options);

/// The surface point nearest to one that a field of an edit gives. Throws InvalidInput, naming the
/// field, where it is further away than a twentieth of the model's size.
SurfacePoint surface_point_near(const Mesh& mesh, const Vec3f& position, const std::string& field);

}  // namespace normalshop
