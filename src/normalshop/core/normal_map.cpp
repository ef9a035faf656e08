#include "normalshop/core/normal_map.h"

#include <cmath>
#include <cstring>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/sample.h"
#include "normalshop/core/slope.h"

namespace normalshop {

namespace {

constexpr float shortest_normal = 0.25F;
constexpr std::size_t rows_per_task = 16;

float largest_code(CodeType type) {
  return type == CodeType::U8 ? 255.0F : type == CodeType::U16 ? 65535.0F : 1.0F;
}

void store(RawImage& image, int x, int y, int channel, float code) {
  const int i = x * image.channels() + channel;
  if (image.type() == CodeType::F32) {
    image.row<float>(y)[i] = code;
    return;
  }
  const float rounded = std::floor(std::clamp(code, 0.0F, largest_code(image.type())) + 0.5F);
  if (image.type() == CodeType::U8) {
    image.row<std::uint8_t>(y)[i] = static_cast<std::uint8_t>(rounded);
  } else {
    image.row<std::uint16_t>(y)[i] = static_cast<std::uint16_t>(rounded);
  }
}

void encode_texel(RawImage& image, int x, int y, const Vec3f& n, const NormalConvention& convention,
                  const CodeRange& range) {
  const Vec3f stored(n.x(), convention.green_down ? -n.y() : n.y(), n.z());
  const int channels = convention.two_channel ? 2 : 3;
  for (int c = 0; c < channels; ++c) {
    store(image, x, y, c, (stored[c] - range.offset) / range.scale);
  }
}

/// Channels that hold no normal (blue of a two-channel map, alpha) go over by value.
void copy_other_channels(const RawImage& from, RawImage& to, int x, int y, int first) {
  const float scale = largest_code(to.type()) / largest_code(from.type());
  for (int c = first; c < to.channels(); ++c) {
    const bool present = c < from.channels();
    store(to, x, y, c, present ? from.code(x, y, c) * scale : largest_code(to.type()));
  }
}

}  // namespace

CodeRange code_range(CodeType type, const NormalConvention& convention) {
  if (type == CodeType::F32) return convention.signed_float ? CodeRange{1, 0} : CodeRange{2, -1};
  const float top = largest_code(type);
  if (!convention.centred_code) return {2.0F / top, -1.0F};
  const float centre = (top + 1.0F) / 2.0F;
  return {1.0F / (top - centre), -centre / (top - centre)};
}

NormalMap::NormalMap(RawImage codes, const NormalConvention& convention)
    : codes_(std::move(codes)), convention_(convention) {
  if (codes_.channels() < (convention.two_channel ? 2 : 3)) {
    throw InvalidInput(
        "a normal map needs 3 channels, or 2 when only x and y are stored; this has " +
        std::to_string(codes_.channels()));
  }
  range_ = code_range(codes_.type(), convention_);
  tile_columns_ = (codes_.width() + tile_size - 1) / tile_size;
  const int tile_rows = (codes_.height() + tile_size - 1) / tile_size;
  tiles_.resize(static_cast<std::size_t>(tile_columns_) * static_cast<std::size_t>(tile_rows));
}

NormalMap::NormalMap(const NormalMap& other)
    : codes_(other.codes_),
      convention_(other.convention_),
      range_(other.range_),
      tile_columns_(other.tile_columns_),
      tiles_(other.tiles_.size()) {
  for (std::size_t i = 0; i < tiles_.size(); ++i) {
    if (other.tiles_[i]) tiles_[i] = std::make_unique<Tile>(*other.tiles_[i]);
  }
}

NormalMap& NormalMap::operator=(const NormalMap& other) {
  if (this != &other) *this = NormalMap(other);
  return *this;
}

const NormalMap::Tile* NormalMap::tile(int x, int y) const {
  return tiles_[static_cast<std::size_t>((y / tile_size) * tile_columns_ + x / tile_size)].get();
}

Vec3f NormalMap::decode(int x, int y) const {
  Vec3f v(codes_.code(x, y, 0), codes_.code(x, y, 1), 0.0F);
  v.x() = v.x() * range_.scale + range_.offset;
  v.y() = v.y() * range_.scale + range_.offset;
  if (convention_.green_down) v.y() = -v.y();
  if (convention_.two_channel) {
    v.z() = std::sqrt(std::max(0.0F, 1.0F - v.x() * v.x() - v.y() * v.y()));
  } else {
    v.z() = codes_.code(x, y, 2) * range_.scale + range_.offset;
  }
  return v;
}

Vec3f NormalMap::vector(int x, int y) const {
  const Tile* t = tile(x, y);
  if (t != nullptr && t->edited[index_in_tile(x, y)]) return t->normals[index_in_tile(x, y)];
  return decode(x, y);
}

Vec3f NormalMap::normal(int x, int y) const {
  const Vec3f v = vector(x, y);
  const float length = v.norm();
  if (!(length >= shortest_normal) || !std::isfinite(length)) return Vec3f::Zero();
  return v / length;
}

Vec3f NormalMap::sample(const Vec2f& uv) const {
  const float x = (uv.x() - std::floor(uv.x())) * static_cast<float>(width()) - 0.5F;
  const float y = (uv.y() - std::floor(uv.y())) * static_cast<float>(height()) - 0.5F;
  const float left = std::floor(x);
  const float top = std::floor(y);
  const int x0 = left < 0.0F ? width() - 1 : static_cast<int>(left);
  const int y0 = top < 0.0F ? height() - 1 : static_cast<int>(top);
  const int x1 = x0 + 1 == width() ? 0 : x0 + 1;
  const int y1 = y0 + 1 == height() ? 0 : y0 + 1;
  const float fx = x - left;
  const float fy = y - top;
  const Vec3f upper = vector(x0, y0) * (1.0F - fx) + vector(x1, y0) * fx;
  const Vec3f lower = vector(x0, y1) * (1.0F - fx) + vector(x1, y1) * fx;
  return upper * (1.0F - fy) + lower * fy;
}

bool NormalMap::edited(int x, int y) const {
  const Tile* t = tile(x, y);
  return t != nullptr && t->edited[index_in_tile(x, y)];
}

bool NormalMap::has_edits() const {
  for (const auto& t : tiles_) {
    if (t && t->edited.any()) return true;
  }
  return false;
}

std::size_t NormalMap::edited_count() const {
  std::size_t count = 0;
  for (const auto& t : tiles_) {
    if (t) count += t->edited.count();
  }
  return count;
}

void NormalMap::set_normal(int x, int y, const Vec3f& n) {
  auto& t = tiles_[static_cast<std::size_t>((y / tile_size) * tile_columns_ + x / tile_size)];
  if (!t) t = std::make_unique<Tile>();
  t->normals[index_in_tile(x, y)] = n;
  t->edited.set(index_in_tile(x, y));
}

RawImage NormalMap::encode(CodeType type, const NormalConvention& convention) const {
  const bool same = type == codes_.type() && convention == convention_;
  const int normal_channels = convention.two_channel ? 2 : 3;
  RawImage out(width(), height(), std::max(codes_.channels(), normal_channels), type);
  const CodeRange range = code_range(type, convention);
  if (same) std::memcpy(out.data(), codes_.data(), codes_.size_bytes());
  parallel_for(static_cast<std::size_t>(height()), rows_per_task,
               [&](std::size_t a, std::size_t b) {
                 for (int y = static_cast<int>(a); y < static_cast<int>(b); ++y) {
                   for (int x = 0; x < width(); ++x) {
                     if (same && !edited(x, y)) continue;
                     encode_texel(out, x, y, vector(x, y), convention, range);
                     if (!same) copy_other_channels(codes_, out, x, y, normal_channels);
                   }
                 }
               });
  return out;
}

namespace {

/// What is resampled: slopes in tangent space (details stay slopes), vectors elsewhere.
Vec3f to_linear(const Vec3f& n, bool tangent) {
  if (!tangent) return n;
  if (n.isZero()) return {0.0F, 0.0F, 1.0F};
  const Vec2f s = slope_from_normal(n);
  return {s.x(), s.y(), 1.0F};
}

Vec3f from_linear(const Vec3f& v, bool tangent) {
  if (tangent) return normal_from_slope({v.x(), v.y()});
  return v.isZero() ? v : Vec3f(v.normalized());
}

Image<Vec3f> linear_image(const NormalMap& map, bool tangent) {
  Image<Vec3f> image(map.width(), map.height());
  parallel_for(static_cast<std::size_t>(map.height()), rows_per_task,
               [&](std::size_t a, std::size_t b) {
                 for (int y = static_cast<int>(a); y < static_cast<int>(b); ++y) {
                   for (int x = 0; x < map.width(); ++x) {
                     image(x, y) = to_linear(map.normal(x, y), tangent);
                   }
                 }
               });
  return image;
}

/// Pixels and weights of the sources of one target coordinate: 4 cubic taps when growing, the
/// covered span when shrinking.
struct Taps {
  int first = 0;
  std::vector<float> weights;
};

std::vector<Taps> make_taps(int from, int to) {
  std::vector<Taps> taps(static_cast<std::size_t>(to));
  const double step = static_cast<double>(from) / to;
  for (int i = 0; i < to; ++i) {
    Taps& t = taps[static_cast<std::size_t>(i)];
    if (step <= 1.0) {
      const double centre = (i + 0.5) * step - 0.5;
      const int base = static_cast<int>(std::floor(centre));
      const auto w = cubic_weights(static_cast<float>(centre - base));
      t.first = base - 1;
      t.weights.assign(w.begin(), w.end());
      continue;
    }
    const double begin = i * step;
    const double end = begin + step;
    t.first = static_cast<int>(begin);
    for (int j = t.first; j < std::min(from, static_cast<int>(std::ceil(end))); ++j) {
      t.weights.push_back(
          static_cast<float>((std::min(end, j + 1.0) - std::max(begin, double(j))) / step));
    }
  }
  return taps;
}

Image<Vec3f> resample_rows(const Image<Vec3f>& in, int width) {
  const std::vector<Taps> taps = make_taps(in.width(), width);
  Image<Vec3f> out(width, in.height());
  parallel_for(static_cast<std::size_t>(in.height()), rows_per_task,
               [&](std::size_t a, std::size_t b) {
                 for (int y = static_cast<int>(a); y < static_cast<int>(b); ++y) {
                   const Vec3f* row = in.row(y);
                   Vec3f* target = out.row(y);
                   for (int x = 0; x < width; ++x) {
                     const Taps& t = taps[static_cast<std::size_t>(x)];
                     Vec3f sum = Vec3f::Zero();
                     for (std::size_t k = 0; k < t.weights.size(); ++k) {
                       const int i = t.first + static_cast<int>(k);
                       sum += t.weights[k] * row[std::clamp(i, 0, in.width() - 1)];
                     }
                     target[x] = sum;
                   }
                 }
               });
  return out;
}

}  // namespace

NormalMap resize(const NormalMap& map, int width, int height, CodeType type) {
  const bool tangent = map.convention().space == NormalSpace::Tangent;
  const Image<Vec3f> rows = resample_rows(linear_image(map, tangent), width);
  const std::vector<Taps> taps = make_taps(map.height(), height);
  const NormalConvention& convention = map.convention();
  RawImage codes(width, height, map.codes().channels(), type);
  const CodeRange range = code_range(type, convention);
  parallel_for(static_cast<std::size_t>(height), rows_per_task, [&](std::size_t a, std::size_t b) {
    for (int y = static_cast<int>(a); y < static_cast<int>(b); ++y) {
      const Taps& t = taps[static_cast<std::size_t>(y)];
      for (int x = 0; x < width; ++x) {
        Vec3f sum = Vec3f::Zero();
        for (std::size_t k = 0; k < t.weights.size(); ++k) {
          const int j = std::clamp(t.first + static_cast<int>(k), 0, map.height() - 1);
          sum += t.weights[k] * rows(x, j);
        }
        encode_texel(codes, x, y, from_linear(sum, tangent), convention, range);
        const float scale = largest_code(type) / largest_code(map.codes().type());
        for (int c = convention.two_channel ? 2 : 3; c < codes.channels(); ++c) {
          const int sx = std::min(map.width() - 1, x * map.width() / width);
          const int sy = std::min(map.height() - 1, y * map.height() / height);
          store(codes, x, y, c, map.codes().code(sx, sy, c) * scale);
        }
      }
    }
  });
  return {std::move(codes), convention};
}

NormalMap flat_normal_map(int width, int height, CodeType type) {
  NormalConvention convention;
  convention.centred_code = true;
  convention.signed_float = true;
  RawImage codes(width, height, 3, type);
  const CodeRange range = code_range(type, convention);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) encode_texel(codes, x, y, Vec3f::UnitZ(), convention, range);
  }
  return {std::move(codes), convention};
}

}  // namespace normalshop
