#pragma once

#include <memory>
#include <string>
#include <vector>

#include "normalshop/rgbn/emboss.h"
#include "normalshop/rgbn/stamp.h"

namespace normalshop {

/// A file's bytes under the name that somebody gives it.
struct NamedFile {
  std::string name;
  std::shared_ptr<const std::string> bytes;
};

/// What edits name but don't hold: files and fonts. io reads them; document only asks.
class Assets {
 public:
  Assets() = default;
  Assets(const Assets&) = delete;
  Assets& operator=(const Assets&) = delete;
  virtual ~Assets() = default;

  /// A patch from a normal map file, with its alpha as opacity; names are relative to the recipe.
  virtual Patch patch(const std::string& file) = 0;
  /// A grey picture, 0 to 1.
  virtual MaskImage mask(const std::string& file) = 0;
  /// A kernel (kernel_text.h) from a JSON file.
  virtual Image<float> kernel(const std::string& file) = 0;
  /// The outlines of a text; an empty font name: the default font.
  virtual Outline text(const std::string& text, const std::string& font) = 0;
  /// The files that the calls since the last one of this have read, by the names that were asked
  /// for.
  virtual std::vector<NamedFile> take_files() { return {}; }
};

}  // namespace normalshop
