#include "normalshop/io/outline_font.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>

#include <ft2build.h>

#include FT_FREETYPE_H
#include FT_OUTLINE_H

#include "normalshop/core/error.h"
#include "normalshop/io/atomic_file.h"

namespace normalshop {

namespace {

namespace fs = std::filesystem;

using Outlines = std::vector<std::vector<Vec2f>>;

constexpr float tolerance = 1.0F / 4000.0F;

std::vector<char32_t> decode_utf8(std::string_view text) {
  std::vector<char32_t> points;
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const std::size_t length = lead < 0x80   ? 1
                               : lead < 0xC2 ? 0
                               : lead < 0xE0 ? 2
                               : lead < 0xF0 ? 3
                               : lead < 0xF5 ? 4
                                             : 0;
    bool good = length > 0 && i + length <= text.size();
    char32_t point = length == 1 ? lead : lead & (0xFFU >> (length + 1));
    for (std::size_t k = 1; good && k < length; ++k) {
      const auto next = static_cast<unsigned char>(text[i + k]);
      good = (next & 0xC0U) == 0x80U;
      point = point << 6 | (next & 0x3FU);
    }
    if (!good) throw InvalidInput("the text is not UTF-8 (at byte " + std::to_string(i) + ")");
    points.push_back(point);
    i += length;
  }
  return points;
}

std::optional<fs::path> find_in(const fs::path& folder, const std::string& name) {
  std::error_code error;
  auto it = fs::recursive_directory_iterator(folder, fs::directory_options::skip_permission_denied,
                                             error);
  std::optional<fs::path> best;
  for (; !error && it != fs::recursive_directory_iterator(); it.increment(error)) {
    const fs::path& path = it->path();
    const std::string extension = path.extension().string();
    if (path.stem() != name || (extension != ".ttf" && extension != ".otf")) continue;
    if (!best || path < *best) best = path;
  }
  return best;
}

class Font {
 public:
  /// The bytes must live as long.
  Font(std::string_view bytes, const std::string& path) {
    if (FT_Init_FreeType(&library_) != 0) throw IoError("the font library cannot start");
    const auto* data = reinterpret_cast<const FT_Byte*>(bytes.data());
    const auto size = static_cast<FT_Long>(bytes.size());
    if (FT_New_Memory_Face(library_, data, size, 0, &face_) != 0) {
      FT_Done_FreeType(library_);
      throw InvalidInput("'" + path + "' is no font file; accepted are .ttf and .otf");
    }
    if (!FT_IS_SCALABLE(face_)) {
      close();
      throw InvalidInput("the font '" + path + "' has no outlines");
    }
    em_ = static_cast<float>(std::max<int>(face_->units_per_EM, 1));
  }
  Font(const Font&) = delete;
  Font& operator=(const Font&) = delete;
  ~Font() { close(); }

  FT_Face face() const { return face_; }
  float em() const { return em_; }

  /// Height of the capital H in em; 0.7 where the font has none.
  float cap_height() const {
    FT_BBox box;
    if (FT_Load_Char(face_, 'H', FT_LOAD_NO_SCALE) != 0) return 0.7F;
    if (face_->glyph->format != FT_GLYPH_FORMAT_OUTLINE) return 0.7F;
    FT_Outline_Get_CBox(&face_->glyph->outline, &box);
    return box.yMax > 0 ? static_cast<float>(box.yMax) / em_ : 0.7F;
  }

 private:
  void close() {
    FT_Done_Face(face_);
    FT_Done_FreeType(library_);
  }
  FT_Library library_ = nullptr;
  FT_Face face_ = nullptr;
  float em_ = 1.0F;
};

/// Receives one glyph's outline.
struct Pen {
  Outlines* outlines;
  float em;
  Vec2f origin;
  Vec2f last{0.0F, 0.0F};

  Vec2f at(const FT_Vector* v) const {
    return origin + Vec2f(static_cast<float>(v->x), static_cast<float>(v->y)) / em;
  }
  void add(const Vec2f& point) {
    auto& outline = outlines->back();
    if (outline.empty() || outline.back() != point) outline.push_back(point);
    last = point;
  }
  /// Chords of a curve whose second differences are at most `bend`: error bend / (8 n^2).
  static int chords(float bend) {
    return std::clamp(static_cast<int>(std::ceil(std::sqrt(bend / (8.0F * tolerance)))), 1, 64);
  }
};

Pen& pen_of(void* user) { return *static_cast<Pen*>(user); }

int move_to(const FT_Vector* to, void* user) {
  pen_of(user).outlines->emplace_back();
  pen_of(user).add(pen_of(user).at(to));
  return 0;
}

int line_to(const FT_Vector* to, void* user) {
  pen_of(user).add(pen_of(user).at(to));
  return 0;
}

int conic_to(const FT_Vector* control, const FT_Vector* to, void* user) {
  Pen& pen = pen_of(user);
  const Vec2f a = pen.last;
  const Vec2f b = pen.at(control);
  const Vec2f c = pen.at(to);
  const int n = Pen::chords(2.0F * (a - 2.0F * b + c).norm());
  for (int i = 1; i <= n; ++i) {
    const float t = static_cast<float>(i) / static_cast<float>(n);
    const float s = 1.0F - t;
    pen.add(i == n ? c : Vec2f(s * s * a + 2.0F * s * t * b + t * t * c));
  }
  return 0;
}

int cubic_to(const FT_Vector* first, const FT_Vector* second, const FT_Vector* to, void* user) {
  Pen& pen = pen_of(user);
  const Vec2f a = pen.last;
  const Vec2f b = pen.at(first);
  const Vec2f c = pen.at(second);
  const Vec2f d = pen.at(to);
  const float bend = 6.0F * std::max((a - 2.0F * b + c).norm(), (b - 2.0F * c + d).norm());
  const int n = Pen::chords(bend);
  for (int i = 1; i <= n; ++i) {
    const float t = static_cast<float>(i) / static_cast<float>(n);
    const float s = 1.0F - t;
    const Vec2f p = s * s * s * a + 3.0F * s * s * t * b + 3.0F * s * t * t * c + t * t * t * d;
    pen.add(i == n ? d : p);
  }
  return 0;
}

void add_glyph(const Font& font, const Vec2f& origin, Outlines& outlines) {
  FT_GlyphSlot glyph = font.face()->glyph;
  if (glyph->format != FT_GLYPH_FORMAT_OUTLINE) return;
  Pen pen{&outlines, font.em(), origin};
  FT_Outline_Funcs functions{};
  functions.move_to = move_to;
  functions.line_to = line_to;
  functions.conic_to = conic_to;
  functions.cubic_to = cubic_to;
  FT_Outline_Decompose(&glyph->outline, &functions, &pen);
}

/// Outlines of one line, from x = 0 on the baseline y; returns its width.
float add_line(const Font& font, const std::vector<char32_t>& line, float y, Outlines& outlines) {
  float x = 0.0F;
  FT_UInt before = 0;
  for (const char32_t point : line) {
    const FT_UInt index = FT_Get_Char_Index(font.face(), point);
    FT_Vector kerning{};
    if (before != 0 && index != 0 &&
        FT_Get_Kerning(font.face(), before, index, FT_KERNING_UNSCALED, &kerning) == 0) {
      x += static_cast<float>(kerning.x) / font.em();
    }
    before = index;
    if (FT_Load_Glyph(font.face(), index, FT_LOAD_NO_SCALE) != 0) continue;
    add_glyph(font, {x, y}, outlines);
    x += static_cast<float>(font.face()->glyph->metrics.horiAdvance) / font.em();
  }
  return x;
}

}  // namespace

fs::path font_file(const fs::path& font) {
  fs::path wanted = font.empty() ? fs::path(default_font) : font;
  std::error_code error;
  if (fs::is_regular_file(wanted, error)) return wanted;
  if (!wanted.has_parent_path() && !wanted.has_extension()) {
    fs::path usual = "/usr/share/fonts/truetype/dejavu/" + wanted.string() + ".ttf";
    if (fs::is_regular_file(usual, error)) return usual;
    for (const char* folder : {"/usr/share/fonts", "/usr/local/share/fonts"}) {
      if (const auto found = find_in(folder, wanted.string())) return *found;
    }
  }
  throw IoError("there is no font '" + wanted.string() +
                "'; give a .ttf or .otf file, or a name like " + std::string(default_font) +
                " (Debian: apt install fonts-dejavu-core)");
}

std::vector<std::vector<Vec2f>> text_outlines(std::string_view utf8, const fs::path& font) {
  const fs::path file = font_file(font);
  return text_outlines(utf8, read_file(file), file.string());
}

std::vector<std::vector<Vec2f>> text_outlines(std::string_view utf8, std::string_view font_bytes,
                                              const std::string& name) {
  std::vector<std::vector<char32_t>> lines(1);
  for (const char32_t point : decode_utf8(utf8)) {
    if (point == U'\n') {
      lines.emplace_back();
    } else if (point >= 32) {
      lines.back().push_back(point);
    }
  }
  const Font font(font_bytes, name);
  const float step = static_cast<float>(font.face()->height) / font.em();
  const float block = step * static_cast<float>(lines.size() - 1);
  float y = 0.5F * block - 0.5F * font.cap_height();
  Outlines result;
  for (const auto& line : lines) {
    const std::size_t first = result.size();
    const float width = add_line(font, line, y, result);
    for (std::size_t i = first; i < result.size(); ++i) {
      for (Vec2f& point : result[i]) point.x() -= 0.5F * width;
    }
    y -= step;
  }
  for (auto& outline : result) {
    if (outline.size() > 1 && outline.front() == outline.back()) outline.pop_back();
  }
  std::erase_if(result, [](const auto& outline) { return outline.size() < 3; });
  return result;
}

}  // namespace normalshop
