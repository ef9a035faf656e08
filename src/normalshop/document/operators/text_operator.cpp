#include <algorithm>
#include <array>

#include "normalshop/document/operators/operators.h"
#include "normalshop/document/operators/placed_operator.h"

namespace normalshop {

namespace {

struct TextEditOptions : EmbossOptions {
  std::string text;
  std::string font;

  static constexpr std::array<std::string_view, 1> required_fields{"text"};
  static constexpr auto fields() {
    return std::tuple_cat(
        std::tuple{field("text", &TextEditOptions::text, "What to write; \\n starts a new line"),
                   field("font", &TextEditOptions::font,
                         "Font file, relative to the recipe; empty: the default font")},
        EmbossOptions::fields());
  }
};

/// A shell hands over \n as two characters.
std::string with_line_breaks(std::string text) {
  for (std::size_t at = text.find("\\n"); at != std::string::npos; at = text.find("\\n", at)) {
    text.replace(at, 2, "\n");
  }
  return text;
}

class TextOperator : public PlacedOperator {
 public:
  explicit TextOperator(const FieldReader& options)
      : options_(read_options<TextEditOptions>(options)) {
    if (options_.text.empty()) options.required("text").fail("a text that is not empty");
    options_.text = with_line_breaks(options_.text);
    check_scales(options);
  }
  std::string_view name() const override { return "text"; }
  Value options() const override { return options_value(options_); }
  void load(Assets& assets) override { outline_ = assets.text(options_.text, options_.font); }
  std::string_view asset_field() const override { return "font"; }

  Extent extent(const std::vector<UnitStroke>& strokes) const override {
    const float fine = 1e-3F * std::max(options_.size, 1e-6F);
    const EmbossOptions scaled = scale_lengths<EmbossOptions>(options_, 1.0F / fine);
    return extent_of(strokes, static_cast<float>(normalshop::reach(scaled, outline_)) * fine);
  }

 protected:
  int copy_reach(float pixel) const override {
    return normalshop::reach(scale_lengths<EmbossOptions>(options_, 1.0F / pixel), outline_);
  }
  Rect place(const OperatorInput& input, SlopeSpan details, MaskSpan coverage, Rect region,
             const Vec2f& position) const override {
    return emboss(details, coverage, region, outline_, position,
                  scale_lengths<EmbossOptions>(options_, 1.0F / input.pixel));
  }

 private:
  TextEditOptions options_;
  Outline outline_;
};

}  // namespace

OperatorType text_operator() {
  return {"text", "Raises or imprints letters, sharp at any resolution",
          "Every point is the centre of one copy of the text", describe_fields<TextEditOptions>,
          [](const FieldReader& options) -> std::unique_ptr<EditOperator> {
            return std::make_unique<TextOperator>(options);
          }};
}

}  // namespace normalshop
