#pragma once

#include "document/edit_fixture.h"

#include "normalshop/core/slope.h"
#include "normalshop/document/image_document.h"

namespace normalshop::test {

/// Slopes as a picture of floats: there an edit is nothing but the operator.
inline ImageDocument picture(SlopeView slopes, Border border = Border::Clamp, MaskImage mask = {}) {
  RawImage codes(slopes.width(), slopes.height(), 3, CodeType::F32);
  for (int y = 0; y < slopes.height(); ++y) {
    for (int x = 0; x < slopes.width(); ++x) {
      const Vec3f n = normal_from_slope(slopes(x, y));
      for (int c = 0; c < 3; ++c) codes.row<float>(y)[3 * x + c] = n[c];
    }
  }
  ImageDocument::Images images;
  images.normals = NormalMap(std::move(codes), NormalConvention{.signed_float = true});
  images.mask = std::move(mask);
  images.border = border;
  return ImageDocument(std::move(images));
}

/// amplitude (cos(w x), sin(w y)) with whole periods along each side.
inline SlopeImage waves(int width, int height, int periods, float amplitude) {
  SlopeImage slopes(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float turn = 6.2831853F * static_cast<float>(periods);
      slopes(x, y) =
          amplitude * Vec2f(std::cos(turn * static_cast<float>(x) / static_cast<float>(width)),
                            std::sin(turn * static_cast<float>(y) / static_cast<float>(height)));
    }
  }
  return slopes;
}

inline SlopeImage sum_of(SlopeImage a, SlopeView b) {
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) a(x, y) += b(x, y);
  }
  return a;
}

/// The largest distance between the slopes of a picture and these.
inline float farthest(const ImageDocument& document, SlopeView expected) {
  const PictureSlopes after = slopes_of(document);
  float most = 0.0F;
  for (int y = 0; y < expected.height(); ++y) {
    for (int x = 0; x < expected.width(); ++x) {
      const float distance = (after.slopes(x, y) - expected(x, y)).norm();
      if (!(distance <= most)) most = distance;
      if (std::isnan(most)) return most;
    }
  }
  return most;
}

}  // namespace normalshop::test
