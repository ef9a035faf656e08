/// Smooths a tangent-space normal map: read, slopes, filter, normals, write. A map is an RGBN image
/// like any other here; its charts are not looked at.
///
///     example_smooth_image INPUT.png SIGMA OUTPUT.png

#include <cstdio>
#include <cstdlib>

#include "normalshop/core/normal_map.h"
#include "normalshop/core/slope.h"
#include "normalshop/io/conventions.h"
#include "normalshop/io/image_file.h"
#include "normalshop/rgbn/smooth.h"

using namespace normalshop;

namespace {

void smooth_file(const char* input, float sigma, const char* output) {
  RawImage codes = read_image(input);
  const NormalConvention convention = guess_convention(codes).convention;
  NormalMap map(std::move(codes), convention);

  SlopeImage slopes(map.width(), map.height());
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) slopes(x, y) = slope_from_normal(map.normal(x, y));
  }
  SmoothOptions options;
  options.sigma = sigma;
  smooth(slopes.view(), {}, slopes, slopes.rect(), options);

  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) map.set_normal(x, y, normal_from_slope(slopes(x, y)));
  }
  write_image(output, map.encode());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: example_smooth_image INPUT SIGMA OUTPUT\n");
    return 2;
  }
  try {
    smooth_file(argv[1], std::strtof(argv[2], nullptr), argv[3]);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
  return 0;
}
