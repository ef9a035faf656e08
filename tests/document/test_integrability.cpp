#include "document/picture_fixture.h"

#include "normalshop/rgbn/curl.h"

/// Edits that the thesis proves conservative (2.2, 2.4, 2.5) leave slopes of a surface slopes of a
/// surface: all that is linear and everywhere the same, sketches, and warps by gradients. The
/// strokes here are wider than they are bent: at a medial axis slopes jump, and pixels cannot tell.
namespace normalshop::test {
namespace {

struct Conservative {
  const char* name;
  const char* fields;
  int size = 256;
};

constexpr Conservative conservative[]{
    {"smooth", R"("operator": "smooth", "options": {"sigma": 12})"},
    {"sharpen", R"("operator": "sharpen", "options": {"sigma": 15, "noise_sigma": 3})"},
    {"high_pass", R"("operator": "filter", "options": {"kind": "high_pass", "sigma": 30})"},
    {"band_pass",
     R"("operator": "filter", "options": {"kind": "band_pass", "sigma": 30, "noise_sigma": 8})"},
    {"laplacian",
     R"("operator": "filter", "options": {"kind": "laplacian_of_gaussian", "sigma": 20})"},
    {"unsharp", R"("operator": "filter", "options": {"kind": "unsharp", "sigma": 20})"},
    {"edge_enhance",
     R"("operator": "filter", "options": {"kind": "edge_enhance", "sigma": 20, "noise_sigma": 4})"},
    {"scale", R"("operator": "filter", "options": {"kind": "scale", "amount": 2.5})"},
    {"convolve", R"("operator": "convolve", "options": {"kernel": "blur.json", "pixel": 6,
        "normalize": true})"},
    {"equalize", R"("operator": "equalize", "options": {"sigma": 8, "gains": [0, 2, 0.5]})"},
    {"balance", R"("operator": "balance")"},
    {"combine", R"("operator": "combine", "options": {"image": "wave.png", "size": 128,
        "repeat": true, "relief": 0.5})"},
    {"transplant", R"("operator": "transplant", "options": {"image": "wave.png", "size": 128,
        "repeat": true, "sigma": 30})"},
    {"bump", R"("operator": "pen", "options": {"profile": "bump", "width": 130, "height": 14},
        "strokes": [[[-100, -10], [0, 10], [100, -10]]])",
     512},
    {"step", R"("operator": "pen", "options": {"profile": "step", "width": 170, "height": 20,
        "closed": true}, "strokes": [[[-140, 0], [-99, -99], [0, -140], [99, -99], [140, 0], [99, 99],
        [0, 140], [-99, 99]]])",
     512},
    {"twirl", R"("operator": "warp", "options": {"kind": "twirl", "radius": 110, "amount": 0.4},
        "strokes": [[[5, -3]]])"},
    {"pinch", R"("operator": "warp", "options": {"kind": "pinch", "radius": 110, "amount": 0.4},
        "strokes": [[[5, -3]]])"}};

class Integrability : public testing::TestWithParam<Conservative> {};

INSTANTIATE_TEST_SUITE_P(Edits, Integrability, testing::ValuesIn(conservative),
                         [](const auto& tried) { return tried.param.name; });

TEST_P(Integrability, SlopesOfASurfaceStayThat) {
  const auto share = [](const ImageDocument& document) {
    return curl_share(slopes_of(document).slopes, {}, {Border::Wrap});
  };
  const int size = GetParam().size;
  const SlopeImage level = waves(size, size, size / 128, 0.2F);
  const SlopeImage before = sum_of(level, SlopeImage(size, size, Vec2f(0.1F, -0.05F)));
  ImageDocument document = picture(before, Border::Wrap);
  ASSERT_LT(share(document), 1e-9);
  document.apply(edit(GetParam().fields + std::string(R"(, "view": "front")")));
  EXPECT_GT(farthest(document, before), 1e-3F);
  EXPECT_LT(share(document), 1e-6);
}

/// What such a test can see.
TEST(IntegrabilityOfOtherEdits, TurnsAndMasksLeaveCurl) {
  for (const std::string fields :
       {R"("operator": "rotate", "options": {"angle": 20})",
        R"("operator": "filter", "options": {"kind": "scale", "amount": 2.5, "area": "brush",
            "brush": 90}, "strokes": [[[-40, -20], [45, 5]]])"}) {
    ImageDocument document = picture(waves(256, 256, 2, 0.2F), Border::Wrap);
    document.apply(edit(fields + R"(, "view": "front")"));
    EXPECT_GT(curl_share(slopes_of(document).slopes, {}, {Border::Wrap}), 1e-3) << fields;
    document.apply(edit(R"("operator": "project", "view": "front")"));
    EXPECT_LT(curl_share(slopes_of(document).slopes, {}, {Border::Wrap}), 1e-8) << fields;
  }
}

}  // namespace
}  // namespace normalshop::test
