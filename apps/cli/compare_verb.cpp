#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>

#include "verbs.h"

#include "normalshop/core/error.h"
#include "normalshop/document/value.h"
#include "normalshop/io/conventions.h"
#include "normalshop/io/image_file.h"
#include "normalshop/rgbn/angular_error.h"
#include "normalshop/rgbn/heatmap.h"

namespace normalshop::cli {

namespace {

struct CompareFlags {
  std::filesystem::path a;
  std::filesystem::path b;
  std::filesystem::path mask;
  std::filesystem::path picture;
  double largest = 0.0;
  bool json = false;
};

RawImage read_codes(const std::filesystem::path& path) {
  RawImage codes = read_image(path);
  if (codes.channels() >= 2) return codes;
  throw InvalidInput("'" + path.string() + "': a normal map needs 2 to 4 channels; this one has 1");
}

/// Two maps of one kind: only how codes stand for numbers is guessed, not the signs, and alike for
/// codes of one type.
std::array<NormalConvention, 2> conventions_of(const RawImage& a, const RawImage& b) {
  std::array<NormalConvention, 2> each{guess_convention(a).convention,
                                       guess_convention(b).convention};
  const bool alike = a.type() == b.type() && a.channels() == b.channels();
  const auto either = [&](bool NormalConvention::*trait) {
    const bool any = each[0].*trait || each[1].*trait;
    if (alike) each[0].*trait = each[1].*trait = any;
  };
  either(&NormalConvention::two_channel);
  either(&NormalConvention::centred_code);
  either(&NormalConvention::signed_float);
  for (NormalConvention& convention : each) {
    convention.space = convention.two_channel ? NormalSpace::Tangent : NormalSpace::Object;
    convention.green_down = false;
  }
  return each;
}

Image<Vec3f> normals_of(RawImage codes, const NormalConvention& convention) {
  const NormalMap map(std::move(codes), convention);
  Image<Vec3f> normals(map.width(), map.height());
  for (int y = 0; y < map.height(); ++y) map.read_normals(y, normals.row(y));
  return normals;
}

std::string size_text(const std::filesystem::path& path, int width, int height) {
  return path.string() + " has " + std::to_string(width) + " x " + std::to_string(height);
}

void write_picture(const CompareFlags& flags, MaskView degrees, double scale) {
  ColorImage colors(degrees.width(), degrees.height());
  heatmap(degrees, static_cast<float>(scale), colors);
  write_png_codes(flags.picture, colors);
}

void run_compare(const CompareFlags& flags) {
  RawImage a_codes = read_codes(flags.a);
  RawImage b_codes = read_codes(flags.b);
  const auto conventions = conventions_of(a_codes, b_codes);
  const Image<Vec3f> a = normals_of(std::move(a_codes), conventions[0]);
  const Image<Vec3f> b = normals_of(std::move(b_codes), conventions[1]);
  if (a.width() != b.width() || a.height() != b.height()) {
    throw InvalidInput("maps of one size can be compared, but " +
                       size_text(flags.a, a.width(), a.height()) + " and " +
                       size_text(flags.b, b.width(), b.height()));
  }
  MaskImage mask;
  if (!flags.mask.empty()) {
    mask = read_mask(flags.mask);
    if (mask.width() != a.width() || mask.height() != a.height()) {
      throw InvalidInput("the mask must have the maps' size, but " +
                         size_text(flags.mask, mask.width(), mask.height()));
    }
  }
  MaskImage degrees(a.width(), a.height());
  angles_between(a, b, mask, degrees);
  const AngularError error = summarize(degrees);
  const double scale = flags.largest > 0.0 ? flags.largest : std::max(error.largest, 1e-3);
  if (!flags.picture.empty()) write_picture(flags, degrees, scale);
  if (flags.json) {
    Value::Object report{{"pixels", error.pixels},
                         {"mean", error.mean},
                         {"median", error.median},
                         {"p99", error.p99},
                         {"largest", error.largest}};
    if (!flags.picture.empty()) report.emplace_back("picture", flags.picture.string());
    std::fputs(to_json(report).c_str(), stdout);
    return;
  }
  std::printf("%zu pixels; degrees: mean %.4f, median %.4f, 99th percentile %.4f, largest %.4f\n",
              error.pixels, error.mean, error.median, error.p99, error.largest);
  if (!flags.picture.empty()) {
    std::printf("wrote %s (dark: 0, pale: %.3g degrees)\n", flags.picture.string().c_str(), scale);
  }
}

}  // namespace

void add_compare_verb(CommandLine& program) {
  Verb verb = program.verb("compare", "Measures the angles between two normal maps");
  CompareFlags& flags = verb.runs(run_compare);
  verb.takes("a", flags.a, "Normal map").required();
  verb.takes("b", flags.b, "Normal map of the same size and conventions").required();
  verb.takes("--mask", flags.mask, "Picture: only pixels that are not black count");
  verb.takes("-o,--output", flags.picture, "PNG picture of the angles in false colours");
  verb.takes("--max", flags.largest,
             "Angle in degrees of the brightest colour (the largest unless given)")
      .positive();
  verb.flag("--json", flags.json, "Print the result as JSON");
}

}  // namespace normalshop::cli
