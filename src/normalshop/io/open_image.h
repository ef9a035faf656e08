#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "normalshop/document/image_document.h"
#include "normalshop/io/conventions.h"

namespace normalshop {

/// How a user opens a picture with normals.
struct OpenImageOptions {
  std::filesystem::path normals;
  std::filesystem::path color;     ///< empty: none
  std::filesystem::path mask;      ///< grey: where edits arrive; empty: everywhere
  std::optional<bool> green_down;  ///< none: guessed
  Border border = Border::Clamp;
};

struct OpenedImage {
  ImageDocument document;
  RawImage color_codes;  ///< as imported; empty: none
  ConventionGuess guess;
  std::vector<std::string> notes;
  bool half_float = false;  ///< the normals' F32 codes were 16-bit floats
};

/// Reads normals, colours and mask. Throws IoError, or InvalidInput for pictures that don't fit
/// together and for normals that are not in tangent space.
OpenedImage open_image(const OpenImageOptions& options);

/// The colours as codes of the imported type; a pixel that no edit moved keeps its codes. Alpha is
/// kept.
RawImage encode_colors(const OpenedImage& opened);

}  // namespace normalshop
