#include "document/picture_fixture.h"

#include "normalshop/core/error.h"
#include "normalshop/document/kernel_text.h"
#include "normalshop/rgbn/resample_kernel.h"

namespace normalshop::test {
namespace {

Edit convolving(const std::string& options, const std::string& rest = "") {
  return edit(R"("operator": "convolve", "view": "front", "options": {)" + options + "}" + rest);
}

/// What the kernel [1, 2, 1] / 4 leaves of such a wave.
float blurred(int periods, int pixels) {
  const float w = 6.2831853F * static_cast<float>(periods) / static_cast<float>(pixels);
  return 0.5F * (1.0F + std::cos(w));
}

TEST(ConvolveOperator, MovesAPictureByAPixelsWeight) {
  const SlopeImage source = waves(48, 40, 3, 0.4F);
  ImageDocument document = picture(source, Border::Wrap);
  document.apply(convolving(R"("kernel": "shift.json")"));
  SlopeImage moved(48, 40);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 48; ++x) moved((x + 2) % 48, y) = source(x, y);
  }
  EXPECT_LT(farthest(document, moved), 1e-6F);
}

TEST(ConvolveOperator, FiltersAWaveAsItsKernelDoes) {
  for (const int periods : {1, 5, 13, 31}) {
    ImageDocument normalized = picture(waves(64, 64, periods, 0.02F), Border::Wrap);
    ImageDocument plain = picture(waves(64, 64, periods, 0.02F), Border::Wrap);
    normalized.apply(convolving(R"("kernel": "blur.json", "normalize": true)"));
    plain.apply(convolving(R"("kernel": "blur.json")"));
    const float factor = blurred(periods, 64);
    EXPECT_LT(farthest(normalized, waves(64, 64, periods, 0.02F * factor)), 1e-6F);
    EXPECT_LT(farthest(plain, waves(64, 64, periods, 0.32F * factor)), 1e-5F);
  }
}

TEST(ConvolveOperator, APixelOfOneIsThePicturesOwn) {
  const SlopeImage source = waves(48, 40, 7, 0.4F);
  ImageDocument own = picture(source);
  ImageDocument given = picture(source);
  own.apply(convolving(R"("kernel": "blur.json", "normalize": true)"));
  given.apply(convolving(R"("kernel": "blur.json", "normalize": true, "pixel": 1)"));
  EXPECT_GT(own.normals().edited_count(), 1000U);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 48; ++x) {
      EXPECT_EQ(own.normals().normal(x, y), given.normals().normal(x, y));
    }
  }
}

TEST(ConvolveOperator, LongPixelsResampleTheKernel) {
  const SlopeImage source = waves(64, 48, 5, 0.4F);
  ImageDocument document = picture(source);
  document.apply(convolving(R"("kernel": "edge.json", "pixel": 2.6)"));
  SlopeImage expected(64, 48);
  FakeAssets assets;
  convolve(source, {}, resample_kernel(assets.kernel("edge.json"), 2.6F), expected,
           expected.rect());
  EXPECT_LT(farthest(document, expected), 1e-6F);
}

/// The part of the picture that an edit looks at is as wide as the kernel reads.
TEST(ConvolveOperator, APartIsThatOfTheWhole) {
  const SlopeImage source = waves(64, 64, 13, 0.3F);
  for (const std::string pixel : {"0", "0.4", "5.3"}) {
    const std::string options = R"("kernel": "blur.json", "normalize": true, "pixel": )" + pixel;
    ImageDocument whole = picture(source);
    ImageDocument part = picture(source);
    whole.apply(convolving(options));
    part.apply(convolving(options + R"(, "area": "inside", "feather": 1)",
                          R"(, "strokes": [[[-6, -6], [6, -6], [6, 6], [-6, 6]]])"));
    for (int y = 28; y < 36; ++y) {
      for (int x = 28; x < 36; ++x) {
        ASSERT_EQ(part.normals().normal(x, y), whole.normals().normal(x, y))
            << pixel << " " << x << ", " << y;
      }
    }
    EXPECT_FALSE(part.normals().edited(10, 10));
  }
}

/// A pixel's length on a mesh counts in its units, whatever the size of its texels: [1, 2, 1] / 4
/// with tents of that length leaves (1 + cos) / 2 sinc^2 of a wave.
TEST(ConvolveOperator, LengthsOnAMeshDoNotDependOnItsTexels) {
  constexpr float length = 0.05F;
  constexpr int periods = 4;
  for (const int size : {128, 256}) {
    const SlopeImage slopes = waves(size, size, periods, 0.3F);
    RawImage codes(size, size, 3, CodeType::F32);
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        const Vec3f n = normal_from_slope(slopes(x, y));
        std::copy_n(n.data(), 3, codes.row<float>(y) + static_cast<std::ptrdiff_t>(3 * x));
      }
    }
    Document mesh = document(plane_grid(2), NormalMap(std::move(codes), {.signed_float = true}));
    mesh.apply(convolving(R"("kernel": "blur.json", "normalize": true, "pixel": 0.05)"));
    const float w = 6.2831853F * periods * length;
    const float sinc = std::sin(0.5F * w) / (0.5F * w);
    const float factor = 0.5F * (1.0F + std::cos(w)) * sinc * sinc;
    const int margin = size / 8;
    for (int y = margin; y < size - margin; ++y) {
      for (int x = margin; x < size - margin; ++x) {
        const Vec2f after = slope_from_normal(map_of(mesh).normal(x, y));
        ASSERT_LT((after - factor * slopes(x, y)).norm(), 4e-3F) << size << " " << x << ", " << y;
      }
    }
  }
}

TEST(ConvolveOperator, WithoutALengthAPixelOfTheChartIsATexel) {
  Document mesh = document(plane_grid(2), noise_map(64, CodeType::U16));
  const NormalMap before = noise_map(64, CodeType::U16);
  mesh.apply(convolving(R"("kernel": "shift.json")"));
  // Pixels are near texels, but not quite: the pattern is there, two texels to the right.
  double here = 0.0;
  double moved = 0.0;
  for (int y = 8; y < 56; ++y) {
    for (int x = 8; x < 56; ++x) {
      const Vec2f after = slope_from_normal(map_of(mesh).normal(x, y));
      here += static_cast<double>(after.dot(slope_from_normal(before.normal(x, y))));
      moved += static_cast<double>(after.dot(slope_from_normal(before.normal(x - 2, y))));
    }
  }
  EXPECT_GT(moved, here + 5.0);
}

std::string failure(const std::string& options) {
  try {
    ImageDocument document = picture(waves(16, 16, 1, 0.1F));
    document.apply(convolving(options));
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "applied";
}

TEST(ConvolveOperator, NamesWhatIsWrong) {
  const std::string options = "r.json: edits[0].options";
  EXPECT_EQ(failure(""), options + ".kernel is missing; it must be a text");
  EXPECT_EQ(failure(R"("kernel": "")"),
            options + ".kernel must be the name of a file, not the text \"\"");
  EXPECT_EQ(failure(R"("kernel": "none.json")"),
            options + ".kernel: none.json: cannot be read: there is no such file");
  EXPECT_EQ(
      failure(R"("kernel": "broken.json")"),
      options + ".kernel: broken.json: row 2 must have as many numbers as the first row, 3, not 2");
  EXPECT_EQ(failure(R"("kernel": "edge.json", "normalize": true)"),
            options +
                ".kernel: convolve: a kernel that is to be normalised must have a sum other than "
                "0");
  EXPECT_EQ(failure(R"("kernel": "edge.json", "pixel": 5000)"),
            "r.json: edits[0]: convolve: with pixels that long the kernel would be more than 511 "
            "pixels of the image wide or high");
  EXPECT_EQ(failure(R"("kernel": "edge.json", "pixel": 1e-30)"), "applied");
}

std::string kernel_failure(const std::string& json) {
  try {
    parse_kernel(json, "k.json");
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "parsed";
}

std::string ones(int count) {
  std::string text = "[1";
  for (int i = 1; i < count; ++i) text += ", 1";
  return text + "]";
}

TEST(KernelText, IsRowsOfNumbers) {
  const Image<float> kernel = parse_kernel("[[1, 2.5, -3], [0, 0, 0], [4, 5, 1e6]]", "k.json");
  ASSERT_EQ(kernel.rect(), (Rect{0, 0, 3, 3}));
  EXPECT_EQ(kernel(1, 0), 2.5F);
  EXPECT_EQ(kernel(2, 0), -3.0F);
  EXPECT_EQ(kernel(0, 2), 4.0F);
  EXPECT_EQ(parse_kernel("[" + ones(255) + "]", "k.json").width(), 255);
}

TEST(KernelText, NamesTheFileAndTheRow) {
  EXPECT_EQ(kernel_failure("7"), "k.json: must be a list of rows of numbers, not the number 7");
  EXPECT_EQ(kernel_failure("[[1, 2, 1]").substr(0, 27), "k.json: line 1: not valid J");
  const std::string rows = "k.json: the kernel must have an odd number of rows, at most 255, not ";
  EXPECT_EQ(kernel_failure("[]"), rows + "0");
  EXPECT_EQ(kernel_failure("[[1], [2]]"), rows + "2");
  const std::string numbers = "k.json: row 1 must have an odd number of numbers, at most 255, not ";
  EXPECT_EQ(kernel_failure("[[]]"), numbers + "0");
  EXPECT_EQ(kernel_failure("[[1, 2]]"), numbers + "2");
  EXPECT_EQ(kernel_failure("[" + ones(257) + "]"), numbers + "257");
  EXPECT_EQ(kernel_failure("[[1], [2], 3]"),
            "k.json: row 3 must be a list of numbers, not the number 3");
  EXPECT_EQ(kernel_failure("[[1], [1, 2, 3], [1]]"),
            "k.json: row 2 must have as many numbers as the first row, 1, not 3");
  EXPECT_EQ(kernel_failure("[[1, \"x\", 2]]"),
            "k.json: row 1, number 2 must be a number from -1000000 to 1000000, not the text "
            "\"x\"");
  EXPECT_EQ(kernel_failure("[[1, 2, 1e300]]"),
            "k.json: row 1, number 3 must be a number from -1000000 to 1000000, not the number "
            "1e+300");
}

}  // namespace
}  // namespace normalshop::test
