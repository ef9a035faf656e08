#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "normalshop/core/error.h"
#include "normalshop/document/edit.h"

namespace {

/// Names of files and fonts lead nowhere: only the recipe is under test.
class NoAssets : public normalshop::Assets {
 public:
  normalshop::Patch patch(const std::string&) override {
    return {normalshop::SlopeImage(1, 1, normalshop::Vec2f(0.0F, 0.0F)), {}, {}};
  }
  normalshop::MaskImage mask(const std::string&) override { return {1, 1, 1.0F}; }
  normalshop::Image<float> kernel(const std::string&) override { return {1, 1, 1.0F}; }
  normalshop::Outline text(const std::string&, const std::string&) override { return {}; }
};

}  // namespace

/// A recipe is refused in one sentence, or reads back from what is written of it as the same.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace normalshop;
  NoAssets assets;
  Recipe recipe;
  try {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    recipe = parse_recipe(text, "recipe.json", assets);
  } catch (const InvalidInput& e) {
    const std::string_view message = e.what();
    if (!message.starts_with("recipe.json: ") || message.find('\n') != std::string_view::npos) {
      std::abort();
    }
    return 0;
  }
  const std::string once = to_json(to_value(recipe));
  if (to_json(to_value(parse_recipe(once, "written", assets))) != once) std::abort();
  return 0;
}
