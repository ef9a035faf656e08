#include "shade_styles.h"

#include "normalshop/document/option_values.h"
#include "normalshop/rgbn/shade_curvature.h"
#include "normalshop/rgbn/shade_exaggerated.h"
#include "normalshop/rgbn/shade_lines.h"
#include "normalshop/rgbn/shade_toon.h"

namespace normalshop::cli {

namespace {

template <class Options>
Value style(std::string_view name, std::string_view summary) {
  return Value::Object{
      {"style", name}, {"summary", summary}, {"options", describe_fields<Options>()}};
}

}  // namespace

Value describe_styles() {
  return Value::Array{
      style<ToonOptions>("toon", "Colours in a few tones"),
      style<LineOptions>("lines", "Contours, suggestive contours, ridges and valleys"),
      style<CurvatureShadeOptions>("curvature", "Light ridges and dark valleys"),
      style<ExaggeratedOptions>("exaggerated", "Every scale of the relief lit at its best")};
}

}  // namespace normalshop::cli
