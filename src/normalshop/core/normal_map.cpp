#include "normalshop/core/normal_map.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <numeric>
#include <string>

#include "normalshop/core/error.h"
#include "normalshop/core/normal_codes.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/sample.h"
#include "normalshop/core/sample_bytes.h"

namespace normalshop {

namespace {

constexpr std::size_t rows_per_task = 16;

}  // namespace

NormalMap::NormalMap(RawImage codes, const NormalConvention& convention)
    : codes_(std::make_shared<const RawImage>(std::move(codes))),
      width_(codes_->width()),
      height_(codes_->height()),
      convention_(convention) {
  if (codes_->channels() < (convention.two_channel ? 2 : 3)) {
    throw InvalidInput(
        "a normal map needs 3 channels, or 2 when only x and y are stored; this has " +
        std::to_string(codes_->channels()));
  }
  range_ = code_range(codes_->type(), convention_);
  tile_columns_ = tiles_along(width_);
  const int tile_rows = tiles_along(height_);
  tiles_.resize(static_cast<std::size_t>(tile_columns_) * static_cast<std::size_t>(tile_rows));
}

/// As long as the unit vector that its code will hold becomes once it is scaled: what a renderer
/// interpolates.
Vec3f NormalMap::with_coded_length(const Vec3f& n) const {
  const float per_scale = 1.0F / convention_.scale;
  return n / Vec3f(n.x() * per_scale, n.y() * per_scale, n.z()).norm();
}

const std::shared_ptr<const RawImage>& NormalMap::no_codes() {
  static const auto none = std::make_shared<const RawImage>();
  return none;
}

std::shared_ptr<NormalMap::Tile> NormalMap::own_tile(const Tile* shared) {
  return shared == nullptr ? std::make_shared<Tile>() : std::make_shared<Tile>(*shared);
}

const NormalMap::Tile* NormalMap::tile_of(int x, int y) const {
  return tiles_[tile_index(x, y)].get();
}

Vec3f NormalMap::vector(int x, int y) const {
  const Tile* t = tile_of(x, y);
  if (t != nullptr && t->edited[index_in_tile(x, y)]) return t->normals[index_in_tile(x, y)];
  return codes::decode_texel(*codes_, convention_, range_, x, y);
}

Vec3f NormalMap::normal(int x, int y) const { return codes::direction_of(vector(x, y)); }

void NormalMap::read_vectors(int x, int count, int y, Vec3f* vectors) const {
  codes::decode_row(*codes_, convention_, x, count, y, vectors);
  const int end = x + count;
  while (x < end) {
    const int next = std::min(end, (x / tile_size + 1) * tile_size);
    const Tile* t = tile_of(x, y);
    for (std::size_t i = index_in_tile(x, y); x < next; ++x, ++i, ++vectors) {
      if (t != nullptr && t->edited[i]) *vectors = t->normals[i];
    }
  }
}

void NormalMap::read_normals(int y, Vec3f* normals) const {
  read_vectors(y, normals);
  for (int x = 0; x < width(); ++x) normals[x] = codes::direction_of(normals[x]);
}

Vec3f NormalMap::sample(const Vec2f& uv) const {
  const WrappedTaps tap(uv, width(), height());
  const bool one_tile = (tap.x0 ^ tap.x1) < tile_size && (tap.y0 ^ tap.y1) < tile_size;
  const bool plain = one_tile && tile_of(tap.x0, tap.y0) == nullptr && !convention_.two_channel;
  if (plain && codes_->type() == CodeType::U8) return sample_codes<std::uint8_t>(tap);
  if (plain && codes_->type() == CodeType::U16) return sample_codes<std::uint16_t>(tap);
  const Vec3f upper = vector(tap.x0, tap.y0) * (1.0F - tap.fx) + vector(tap.x1, tap.y0) * tap.fx;
  const Vec3f lower = vector(tap.x0, tap.y1) * (1.0F - tap.fx) + vector(tap.x1, tap.y1) * tap.fx;
  return upper * (1.0F - tap.fy) + lower * tap.fy;
}

/// Bilinear over unedited integer codes: the codes' mean decodes to the vectors' mean.
template <class Code>
Vec3f NormalMap::sample_codes(const WrappedTaps& tap) const {
  const int channels = codes_->channels();
  const Code* upper = codes_->row<Code>(tap.y0);
  const Code* lower = codes_->row<Code>(tap.y1);
  const int left = tap.x0 * channels;
  const int right = tap.x1 * channels;
  const float w11 = tap.fx * tap.fy;
  const float w10 = tap.fx - w11;
  const float w01 = tap.fy - w11;
  const float w00 = 1.0F - tap.fx - w01;
  const auto mean = [&](int c) {
    return w00 * static_cast<float>(upper[left + c]) + w10 * static_cast<float>(upper[right + c]) +
           w01 * static_cast<float>(lower[left + c]) + w11 * static_cast<float>(lower[right + c]);
  };
  const float y = (mean(1) * range_.scale + range_.offset) * convention_.scale;
  return {(mean(0) * range_.scale + range_.offset) * convention_.scale,
          convention_.green_down ? -y : y, mean(2) * range_.scale + range_.offset};
}

/// Is any tile edited that these places may read? Also true where finding out would take long.
bool NormalMap::may_read_edits(const float* u, const float* v, int count) const {
  const auto [u0, u1] = std::minmax_element(u, u + count);
  const auto [v0, v1] = std::minmax_element(v, v + count);
  const Vec2f size(static_cast<float>(width()), static_cast<float>(height()));
  const int x0 = floor_to_int(*u0 * size.x() - 0.5F);
  const int x1 = floor_to_int(*u1 * size.x() - 0.5F) + 1;
  const int y0 = floor_to_int(*v0 * size.y() - 0.5F);
  const int y1 = floor_to_int(*v1 * size.y() - 0.5F) + 1;
  if (x0 < 0 || y0 < 0 || x1 >= width() || y1 >= height()) return true;  // wraps around
  if ((x1 / tile_size - x0 / tile_size + 1) * (y1 / tile_size - y0 / tile_size + 1) > 2 * count) {
    return true;
  }
  for (int ty = y0 / tile_size; ty <= y1 / tile_size; ++ty) {
    for (int tx = x0 / tile_size; tx <= x1 / tile_size; ++tx) {
      if (tiles_[static_cast<std::size_t>(ty * tile_columns_ + tx)]) return true;
    }
  }
  return false;
}

void NormalMap::sample(const float* u, const float* v, int count, float* x, float* y,
                       float* z) const {
  if (count <= 0) return;
  if (!convention_.two_channel && !may_read_edits(u, v, count) &&
      sample_bytes(*codes_, nullptr, u, v, count, x, y, z)) {
    const float right = convention_.scale;
    const float up = convention_.green_down ? -right : right;
    for (int i = 0; i < count; ++i) {
      x[i] = right * (x[i] * range_.scale + range_.offset);
      y[i] = up * (y[i] * range_.scale + range_.offset);
      z[i] = z[i] * range_.scale + range_.offset;
    }
    return;
  }
  for (int i = 0; i < count; ++i) {
    const Vec3f n = sample({u[i], v[i]});
    x[i] = n.x();
    y[i] = n.y();
    z[i] = n.z();
  }
}

bool NormalMap::restore(int x, int y, const NormalMap& earlier) {
  return TileWriter(*this, tile_index(x, y), earlier).restore(index_in_tile(x, y));
}

void NormalMap::TileWriter::own() {
  if (tile_.use_count() != 1) tile_ = own_tile(tile_.get());
  own_ = tile_.get();
}

bool NormalMap::edited(int x, int y) const {
  const Tile* t = tile_of(x, y);
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

void NormalMap::encode_edits(int y, RawImage& out, int out_y) const {
  for (int x = 0; x < width(); x += tile_size) {
    const Tile* t = tile_of(x, y);
    if (t == nullptr) continue;
    const std::size_t begin = index_in_tile(x, y);
    const int count = std::min(tile_size, width() - x);
    for (int i = 0; i < count; ++i) {
      const std::size_t at = begin + static_cast<std::size_t>(i);
      if (t->edited[at]) codes::encode_texels(&t->normals[at], 1, convention_, out, x + i, out_y);
    }
  }
}

RawImage NormalMap::encode_rows(int first, int count, CodeType type,
                                const NormalConvention& convention) const {
  const bool same = type == codes_->type() && convention == convention_;
  const int normal_channels = codes::normal_channels(convention);
  RawImage out(width(), count, std::max(codes_->channels(), normal_channels), type);
  std::vector<int> columns(same ? 0 : static_cast<std::size_t>(width()));
  std::iota(columns.begin(), columns.end(), 0);
  const auto encode_some = [&](std::size_t begin, std::size_t end) {
    std::vector<Vec3f> vectors(columns.size());
    for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row) {
      const int y = first + row;
      if (same) {
        std::memcpy(out.row_data(row), codes_->row_data(y), codes_->row_bytes());
        encode_edits(y, out, row);
        continue;
      }
      read_vectors(y, vectors.data());
      codes::encode_texels(vectors.data(), width(), convention, out, 0, row);
      codes::copy_other_channels(*codes_, y, columns, out, row, normal_channels);
    }
  };
  parallel_for(static_cast<std::size_t>(count), rows_per_task, encode_some);
  return out;
}

NormalMap flat_normal_map(int width, int height, CodeType type) {
  NormalConvention convention;
  convention.centred_code = true;
  convention.signed_float = true;
  RawImage image(width, height, 3, type);
  const std::vector<Vec3f> row(static_cast<std::size_t>(width), Vec3f(0.0F, 0.0F, 1.0F));
  for (int y = 0; y < height; ++y) {
    codes::encode_texels(row.data(), width, convention, image, 0, y);
  }
  return {std::move(image), convention};
}

}  // namespace normalshop
