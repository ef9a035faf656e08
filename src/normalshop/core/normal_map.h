#pragma once

#include <array>
#include <bitset>
#include <memory>
#include <string_view>
#include <vector>

#include "normalshop/core/raw_image.h"

namespace normalshop {

struct WrappedTaps;

/// What a stored normal's components refer to. Object is the space of the mesh in its file,
/// world the same after the file's node transforms (which are applied when a mesh is loaded).
enum class NormalSpace { Tangent, Object, World };
constexpr auto names_of(NormalSpace) {
  return std::array<std::string_view, 3>{"tangent", "object", "world"};
}

/// How codes stand for a normal. Tangent space: x along T, y along B (green up).
struct NormalConvention {
  NormalSpace space = NormalSpace::Tangent;
  bool green_down = false;    ///< y is stored negated ("DirectX")
  bool two_channel = false;   ///< only x and y are stored; z = sqrt(1 - x^2 - y^2)
  bool centred_code = false;  ///< integer codes: 128 (32768) stands for 0 exactly, not 127.5
  bool signed_float = false;  ///< float codes are components themselves, not (n + 1) / 2
  /// Multiplies x and y of what the codes say (glTF's normalTexture.scale). Not 0; below 0.25 and
  /// above 4 codes of 8 bits can't hold every direction well.
  float scale = 1.0F;

  bool operator==(const NormalConvention&) const = default;
};

/// component = code * scale + offset.
struct CodeRange {
  float scale;
  float offset;
};
CodeRange code_range(CodeType type, const NormalConvention& convention);

/// A map of normals: the codes as they were imported, never changed, and tiles of edited normals
/// above them. A texel that no edit reached is exported with its imported code, bit for bit.
///
/// Copies share codes and tiles until one of them edits a tile, so that a copy keeps the state of
/// now for little. None may be let go of by another thread while one of them is edited. Normals are
/// given in the map's own space with y up. Texel (x, y) counts from the top left.
class NormalMap {
 public:
  static constexpr int tile_size = 64;
  static constexpr int tiles_along(int texels) { return (texels + tile_size - 1) / tile_size; }
  static std::size_t index_in_tile(int x, int y) {
    return static_cast<std::size_t>((y % tile_size) * tile_size + x % tile_size);
  }

  /// Of texels that are not edited the normals mean nothing.
  struct Tile {
    std::array<Vec3f, tile_size * tile_size> normals;
    std::bitset<tile_size * tile_size> edited;
  };

  NormalMap() = default;
  /// Codes with 2 to 4 channels (3 to 4 unless two_channel). Throws InvalidInput otherwise.
  NormalMap(RawImage codes, const NormalConvention& convention);

  int width() const { return width_; }
  int height() const { return height_; }
  bool empty() const { return width_ == 0; }
  const NormalConvention& convention() const { return convention_; }
  const RawImage& codes() const { return *codes_; }

  /// Edited normal where there is one, else the decoded code; unit. Zero where the code holds no
  /// direction (not finite, shorter than 0.25 or longer than 1e18).
  Vec3f normal(int x, int y) const;
  /// Like normal(), but as the code's vector with its own length: what a renderer interpolates.
  Vec3f vector(int x, int y) const;
  /// normal() and vector() of a whole row, width() of them: faster than one by one.
  void read_normals(int y, Vec3f* normals) const;
  void read_vectors(int y, Vec3f* vectors) const { read_vectors(0, width(), y, vectors); }
  /// vector() of `count` texels from (x, y) on to the right.
  void read_vectors(int x, int count, int y, Vec3f* vectors) const;
  /// Bilinear, not normalised, wrapping around; (0, 0) is the corner of the first texel and
  /// (1, 1) that of the last.
  Vec3f sample(const Vec2f& uv) const;
  /// sample() at `count` places, faster. All arrays have sample_padding (sample.h) entries more, in
  /// which anything may be left.
  void sample(const float* u, const float* v, int count, float* x, float* y, float* z) const;

  bool edited(int x, int y) const;
  /// Any texel edited at all?
  bool has_edits() const;
  /// Texels that set_normal() has reached.
  std::size_t edited_count() const;
  /// Different tiles may be written by different threads at once. n is unit.
  void set_normal(int x, int y, const Vec3f& n) {
    auto& t = tiles_[tile_index(x, y)];
    if (t.use_count() != 1) t = own_tile(t.get());
    t->normals[index_in_tile(x, y)] = convention_.scale == 1.0F ? n : with_coded_length(n);
    t->edited[index_in_tile(x, y)] = true;
  }

  /// Tiles count in rows from the top left.
  std::size_t tile_count() const { return tiles_.size(); }
  /// Null where nothing was ever edited. While somebody holds it, edits go to a copy.
  std::shared_ptr<const Tile> tile(std::size_t index) const { return tiles_[index]; }
  void set_tile(std::size_t index, std::shared_ptr<Tile> tile) { tiles_[index] = std::move(tile); }

  /// Makes the texel what it was in an earlier copy of this map. False where it cannot be anything
  /// else. Threads as in set_normal().
  bool restore(int x, int y, const NormalMap& earlier);

  /// set_normal() and restore() of one tile's texels, by index_in_tile(), without looking for the
  /// tile again and again. Meanwhile nobody else edits or copies the map.
  class TileWriter {
   public:
    TileWriter(NormalMap& map, std::size_t tile, const NormalMap& earlier)
        : map_(map), tile_(map.tiles_[tile]), was_(earlier.tiles_[tile].get()) {}
    void set_normal(std::size_t i, const Vec3f& n) {
      if (own_ == nullptr) own();
      own_->normals[i] = map_.convention_.scale == 1.0F ? n : map_.with_coded_length(n);
      own_->edited[i] = true;
    }
    bool restore(std::size_t i) {
      const bool was_edited = was_ != nullptr && was_->edited[i];
      if (tile_.get() == was_ || (!tile_->edited[i] && !was_edited)) return false;
      if (own_ == nullptr) own();
      own_->edited[i] = was_edited;
      if (was_edited) own_->normals[i] = was_->normals[i];
      return true;
    }

   private:
    void own();

    NormalMap& map_;
    std::shared_ptr<Tile>& tile_;
    const Tile* was_;
    Tile* own_ = nullptr;
  };

  /// Codes of the edited map. With the map's own type and convention every unedited texel keeps its
  /// code, and channels beyond the normal's (alpha) keep theirs always. The space is not converted.
  RawImage encode(CodeType type, const NormalConvention& convention) const {
    return encode_rows(0, height(), type, convention);
  }
  /// `count` rows of encode() from row `first` on, for who writes them out piece by piece.
  RawImage encode_rows(int first, int count, CodeType type,
                       const NormalConvention& convention) const;
  RawImage encode() const { return encode(codes_->type(), convention_); }

 private:
  static std::shared_ptr<Tile> own_tile(const Tile* shared);
  Vec3f with_coded_length(const Vec3f& n) const;
  void encode_edits(int y, RawImage& out, int out_y) const;
  template <class Code>
  Vec3f sample_codes(const WrappedTaps& tap) const;
  std::size_t tile_index(int x, int y) const {
    return static_cast<std::size_t>((y / tile_size) * tile_columns_ + x / tile_size);
  }
  const Tile* tile_of(int x, int y) const;
  bool may_read_edits(const float* u, const float* v, int count) const;

  static const std::shared_ptr<const RawImage>& no_codes();

  std::shared_ptr<const RawImage> codes_ = no_codes();
  int width_ = 0;
  int height_ = 0;
  NormalConvention convention_;
  CodeRange range_{1.0F, 0.0F};
  int tile_columns_ = 0;
  std::vector<std::shared_ptr<Tile>> tiles_;
};

/// The map at another size: slopes (tangent space) or vectors (other spaces) resampled bicubically
/// when growing and by area when shrinking, coded in `type` with the map's own convention. Further
/// channels take the nearest texel. Throws InvalidInput unless both sizes are at least 1.
NormalMap resize(const NormalMap& map, int width, int height, CodeType type);

/// A map without details, of 3 channels: every tangent-space code stands for (0, 0, 1) exactly.
NormalMap flat_normal_map(int width, int height, CodeType type);

}  // namespace normalshop
