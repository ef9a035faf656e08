#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "normalshop/core/vec.h"

namespace normalshop {

/// DejaVu Sans Bold of Debian's fonts-dejavu-core.
inline constexpr std::string_view default_font = "DejaVuSans-Bold";

/// Closed outlines of a text, without the first point repeated at the end; holes run the other way
/// round (non-zero winding fills them right). Unit: the em (the font's size) is 1; y runs up.
/// Every line is centred on x = 0; the middle between the first line's baseline and its capitals'
/// height (several lines: the middle of the block) lies on y = 0. "\n" starts a new line. Curves
/// are cut into chords that are off by less than 1/4,000 em.
///
/// `font` is a font file, or the name of one without extension in the system's font folders; empty
/// for default_font. Throws IoError (no such font), InvalidInput (no UTF-8, no outlines).
std::vector<std::vector<Vec2f>> text_outlines(std::string_view utf8,
                                              const std::filesystem::path& font = {});
/// The file that a font's name means. Throws IoError.
std::filesystem::path font_file(const std::filesystem::path& font);
/// The same of a font's bytes; `name` stands for it in messages.
std::vector<std::vector<Vec2f>> text_outlines(std::string_view utf8, std::string_view font_bytes,
                                              const std::string& name);

}  // namespace normalshop
