#pragma once

#include <string>

#include "normalshop/rgbn/emboss.h"
#include "normalshop/rgbn/stamp.h"

namespace normalshop {

/// What edits name but don't hold: files and fonts. io reads them; document only asks.
class Assets {
 public:
  Assets() = default;
  Assets(const Assets&) = delete;
  Assets& operator=(const Assets&) = delete;
  virtual ~Assets() = default;

  /// A patch from a normal map file, with its alpha as opacity; names are relative to the recipe.
  virtual Patch patch(const std::string& file) = 0;
  /// A kernel (kernel_text.h) from a JSON file.
  virtual Image<float> kernel(const std::string& file) = 0;
  /// The outlines of a text; an empty font name: the default font.
  virtual Outline text(const std::string& text, const std::string& font) = 0;
};

}  // namespace normalshop
