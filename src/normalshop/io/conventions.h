#pragma once

#include <optional>
#include <string>

#include "normalshop/core/normal_map.h"
#include "normalshop/core/raw_image.h"

namespace normalshop {

/// Lengths of a map's vectors as they are coded (unit normals have 1).
struct LengthStatistics {
  double mean = 0.0;
  double min = 0.0;
  double max = 0.0;
};

/// What a map's codes probably mean, and how sure that is.
struct ConventionGuess {
  NormalConvention convention;
  /// Curl of the slopes with the other sign of green against the chosen one, from 1 (no difference)
  /// up. Below 2 it is undecided, and OpenGL (green up) is assumed.
  double green_ratio = 1.0;
  double green_confidence = 0.0;  ///< 1 - 1 / green_ratio
  double space_confidence = 0.0;  ///< 0 (either is possible) to 1
  LengthStatistics lengths;
  std::string sentence;  ///< for the user
};

/// Space from the spread of directions (tangent: nearly all towards +z; object: all over the
/// sphere), green from the curl, two channels from a missing blue or one that is constant and no
/// normal's, the code of zero from the code of flat areas, signed floats from negative values.
/// A space that is known already is not guessed, and green is judged with it. Reads at most about
/// 1,024 rows. Needs 2 to 4 channels; throws InvalidInput otherwise.
ConventionGuess guess_convention(const RawImage& codes,
                                 std::optional<NormalSpace> known_space = {});

/// Three or more channels, coloured, and most vectors near unit length: a map of normals rather
/// than of heights or colours.
bool looks_like_normal_map(const RawImage& codes);

}  // namespace normalshop
