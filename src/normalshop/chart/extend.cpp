#include "normalshop/chart/extend.h"

#include <algorithm>
#include <vector>

#include "normalshop/core/parallel.h"

namespace normalshop {

namespace {

template <class T>
struct Level {
  Image<T> value;
  Image<float> weight;
};

/// Half the size: weighted means of 2 x 2 pixels, the weight saturating at 1.
template <class T>
Level<T> pull_level(ImageView<T> value, MaskView weight) {
  Level<T> out;
  const int width = (value.width() + 1) / 2;
  const int height = (value.height() + 1) / 2;
  out.value.resize(width, height);
  out.weight.resize(width, height);
  parallel_for(static_cast<std::size_t>(height), 32, [&](std::size_t a, std::size_t b) {
    for (int y = static_cast<int>(a); y < static_cast<int>(b); ++y) {
      for (int x = 0; x < width; ++x) {
        T sum = T::Zero();
        float total = 0.0F;
        for (int j = 2 * y; j < std::min(2 * y + 2, value.height()); ++j) {
          for (int i = 2 * x; i < std::min(2 * x + 2, value.width()); ++i) {
            const float w = std::min(1.0F, weight(i, j));
            sum += w * value(i, j);
            total += w;
          }
        }
        out.value(x, y) = total > 0.0F ? T(sum / total) : T(T::Zero());
        out.weight(x, y) = std::min(1.0F, total);
      }
    }
  });
  return out;
}

/// Fills pixels of weight below 1 from the next coarser, already full level (bilinear).
template <class T>
void push_level(const Image<T>& coarse, MaskView weight, ImageSpan<T> value) {
  parallel_for(static_cast<std::size_t>(value.height()), 32, [&](std::size_t a, std::size_t b) {
    for (int y = static_cast<int>(a); y < static_cast<int>(b); ++y) {
      for (int x = 0; x < value.width(); ++x) {
        const float w = std::min(1.0F, weight(x, y));
        if (w >= 1.0F) continue;
        const int cx = x / 2;
        const int cy = y / 2;
        const int nx = std::clamp(cx + ((x & 1) != 0 ? 1 : -1), 0, coarse.width() - 1);
        const int ny = std::clamp(cy + ((y & 1) != 0 ? 1 : -1), 0, coarse.height() - 1);
        const T up = 0.75F * (0.75F * coarse(cx, cy) + 0.25F * coarse(nx, cy)) +
                     0.25F * (0.75F * coarse(cx, ny) + 0.25F * coarse(nx, ny));
        value(x, y) = w * value(x, y) + (1.0F - w) * up;
      }
    }
  });
}

template <class T>
void extend_values(MaskView validity, ImageSpan<T> values) {
  if (values.empty()) return;
  // Validity may be a soft weight; here a pixel is valid or not.
  Image<float> weight(values.width(), values.height());
  bool holes = false;
  for (int y = 0; y < values.height(); ++y) {
    for (int x = 0; x < values.width(); ++x) {
      weight(x, y) = validity(x, y) > 0.0F ? 1.0F : 0.0F;
      holes = holes || weight(x, y) == 0.0F;
    }
  }
  if (!holes) return;
  std::vector<Level<T>> levels;
  levels.push_back(pull_level<T>(values, weight));
  while (levels.back().value.width() > 1 || levels.back().value.height() > 1) {
    const Level<T>& last = levels.back();
    levels.push_back(pull_level<T>(last.value, last.weight));
  }
  for (std::size_t i = levels.size() - 1; i > 0; --i) {
    push_level<T>(levels[i].value, levels[i - 1].weight, levels[i - 1].value);
  }
  push_level<T>(levels[0].value, weight, values);
}

}  // namespace

void extend(MaskView validity, SlopeSpan values) { extend_values(validity, values); }
void extend(MaskView validity, ColorSpan values) { extend_values(validity, values); }

}  // namespace normalshop
