#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>

#include "../io/temp_folder.h"
#include "document/edit_fixture.h"
#include "support/same_codes.h"

#include "normalshop/document/document_file.h"

namespace normalshop::test {

/// A square of noise with a colour map, and its document in a folder that ends with the test.
class StoredSquare : public ::testing::Test {
 protected:
  static constexpr int map_side = 320;  // 5 x 5 tiles

  StoredSquare() { make(path_); }

  /// As it is imported.
  static Document imported() {
    RawImage colors(map_side, map_side, 3, CodeType::U8);
    for (int y = 0; y < map_side; ++y) {
      for (int x = 0; x < map_side; ++x) {
        for (int c = 0; c < 3; ++c) {
          colors.row<std::uint8_t>(y)[3 * x + c] =
              static_cast<std::uint8_t>((x * (c + 1) + 2 * y) % 256);
        }
      }
    }
    std::vector<Document::Maps> maps;
    maps.push_back({noise_map(map_side, CodeType::U8), ColorMap(std::move(colors))});
    return {plane_grid(2), std::move(maps)};
  }
  static void make(const std::filesystem::path& path) {
    const Document document = imported();
    DocumentFile::Contents contents;
    contents.import = Value::Object{{"model", "square"}};
    contents.files.push_back({"square", std::make_shared<const std::string>("a square")});
    contents.sets.push_back({"skin", map_side, map_side, map_of(document).convention()});
    std::ofstream(path).close();
    DocumentFile::create(path, contents);
  }
  static Document open(const std::filesystem::path& path) {
    Document document = imported();
    document.keep_in(std::make_shared<DocumentFile>(path),
                     [](const std::vector<NamedFile>&) { return std::make_unique<FakeAssets>(); });
    return document;
  }
  Document open() const { return open(path_); }

  /// A stroke of the pen through these points.
  static Edit pen(const std::string& points) {
    return edit(R"("operator": "pen", "view": "front",
        "options": {"width": 0.05, "height": 0.02}, "strokes": [[)" +
                points + "]]");
  }
  /// Three edits of different kinds; the second moves colours.
  static std::vector<Edit> some_edits() {
    return {
        pen("[-0.4, 0.4], [-0.3, 0.3]"), edit(R"("operator": "warp", "view": "front",
                "options": {"kind": "grab", "radius": 0.2}, "strokes": [[[-0.3, 0.3], [-0.2, 0.2]]])"),
        edit(
            R"("operator": "smooth", "view": "front", "options": {"sigma": 0.01, "area": "brush", "brush": 0.1},
                "strokes": [[[-0.3, 0.3], [0.1, 0.1]]])")};
  }

  std::filesystem::path path_of(const std::string& name) const { return folder_ / name; }

  TempFolder folder_;
  std::filesystem::path path_ = folder_ / "square.nshop";
};

/// Equal in every bit that an edit or an export could read.
inline bool same_maps(const Document& a, const Document& b) {
  const NormalMap& p = map_of(a);
  const NormalMap& q = map_of(b);
  const ColorMap& c = a.storage().sets.at(0).albedo;
  const ColorMap& d = b.storage().sets.at(0).albedo;
  bool same = same_codes(c.codes(), d.codes()) && c.has_edits() == d.has_edits();
  for (int y = 0; same && y < p.height(); ++y) {
    for (int x = 0; same && x < p.width(); ++x) {
      const Vec3f m = p.vector(x, y);
      const Vec3f n = q.vector(x, y);
      same = p.edited(x, y) == q.edited(x, y) && std::memcmp(&m, &n, sizeof(Vec3f)) == 0;
    }
  }
  return same;
}

inline std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline void write_bytes(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// What the document says is wrong when it is opened; empty: nothing.
inline std::string complaint_of(const std::filesystem::path& path) {
  try {
    const DocumentFile file(path);
  } catch (const DocumentError& error) {
    return error.what();
  }
  return {};
}

}  // namespace normalshop::test
