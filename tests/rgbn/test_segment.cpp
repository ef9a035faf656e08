#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "support/nan.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/random.h"
#include "normalshop/core/slope.h"
#include "normalshop/rgbn/segment.h"

namespace normalshop::test {
namespace {

struct Scene {
  SlopeImage slopes;
  ColorImage color;
  MaskImage validity;

  Scene(int width, int height)
      : slopes(width, height, Vec2f::Zero()), color(width, height, Vec3f::Zero()) {}
  RgbnView view() const { return {slopes, color, validity}; }
};

/// Noise whose strength differs from patch to patch, some levels met more than once, and holes.
Scene random_scene(int width, int height, std::uint64_t seed) {
  Scene scene(width, height);
  scene.validity = MaskImage(width, height, 1.0F);
  Random random(seed);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float noise = (x / 13 + y / 9) % 3 == 0 ? 0.02F : 0.3F;
      const float level = (x / 20 + y / 17) % 2 == 0 ? 0.2F : 0.5F;
      const auto value = [&] { return random.uniform(-noise, noise); };
      scene.slopes(x, y) = {level + value(), value()};
      scene.color(x, y) = {level, std::round(8.0F * value()) * 0.125F, 0.1F};
      if (random.uniform() < 0.03F) scene.validity(x, y) = 0.0F;
    }
  }
  return scene;
}

/// The paper's algorithm, edge by edge, in pixels that are not smoothed.
class Reference {
 public:
  Reference(const Scene& scene, const SegmentOptions& options)
      : width_(scene.slopes.width()), height_(scene.slopes.height()), scene_(scene) {
    constexpr int ways[4][2] = {{1, 0}, {-1, 1}, {0, 1}, {1, 1}};
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        for (const auto& way : ways) add_edge(x, y, x + way[0], y + way[1], options);
      }
    }
    std::stable_sort(edges_.begin(), edges_.end(),
                     [](const Edge& a, const Edge& b) { return a.weight < b.weight; });
  }

  std::vector<std::uint32_t> segment(float coarseness, int min_size) {
    std::vector<int> set(static_cast<std::size_t>(width_ * height_));
    std::iota(set.begin(), set.end(), 0);
    std::vector<std::vector<int>> members(set.size());
    for (const int i : set) members[at(i)] = {i};
    std::vector<float> internal(set.size(), 0.0F);
    const auto limit = [&](int i) {
      return internal[at(i)] + coarseness / static_cast<float>(members[at(i)].size());
    };
    const auto join = [&](int a, int b, float weight) {
      for (const int i : members[at(b)]) set[at(i)] = a;
      members[at(a)].insert(members[at(a)].end(), members[at(b)].begin(), members[at(b)].end());
      internal[at(a)] = weight;
    };
    for (const Edge& edge : edges_) {
      const int a = set[at(edge.a)];
      const int b = set[at(edge.b)];
      if (a != b && edge.weight <= std::min(limit(a), limit(b))) join(a, b, edge.weight);
    }
    for (const Edge& edge : edges_) {
      const int a = set[at(edge.a)];
      const int b = set[at(edge.b)];
      const auto smaller = std::min(members[at(a)].size(), members[at(b)].size());
      if (a != b && static_cast<int>(smaller) < min_size) join(a, b, edge.weight);
    }
    return number(set);
  }

 private:
  struct Edge {
    float weight;
    int a;
    int b;
  };
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }

  /// 11 bits after the leading one.
  static float rounded_down(float weight) {
    int exponent = 0;
    const float mantissa = std::frexp(weight, &exponent);
    return std::ldexp(std::floor(std::ldexp(mantissa, 12)), exponent - 12);
  }

  bool usable(int x, int y) const { return scene_.validity(x, y) > 0.0F; }

  void add_edge(int x0, int y0, int x1, int y1, const SegmentOptions& options) {
    if (x1 < 0 || x1 >= width_ || y1 >= height_ || !usable(x0, y0) || !usable(x1, y1)) return;
    const Vec3f n = normal_from_slope(scene_.slopes(x0, y0));
    const Vec3f m = normal_from_slope(scene_.slopes(x1, y1));
    const float weight = std::sqrt(options.normal_weight * (n - m).squaredNorm() +
                                   options.color_weight *
                                       (scene_.color(x0, y0) - scene_.color(x1, y1)).squaredNorm());
    edges_.push_back({rounded_down(weight), y0 * width_ + x0, y1 * width_ + x1});
  }

  std::vector<std::uint32_t> number(const std::vector<int>& set) const {
    std::vector<std::uint32_t> numbers(set.size(), no_label);
    std::vector<std::uint32_t> labels(set.size(), no_label);
    std::uint32_t count = 0;
    for (std::size_t i = 0; i < set.size(); ++i) {
      if (!(scene_.validity.data()[i] > 0.0F)) continue;
      std::uint32_t& wanted = numbers[at(set[i])];
      if (wanted == no_label) wanted = count++;
      labels[i] = wanted;
    }
    return labels;
  }

  int width_;
  int height_;
  const Scene& scene_;
  std::vector<Edge> edges_;
};

std::vector<std::uint32_t> list(const Segments& segments) {
  return {segments.labels.data(), segments.labels.data() + segments.labels.size()};
}

TEST(Segment, IsTheAlgorithmOfThePaper) {
  std::vector<std::uint32_t> counts;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const Scene scene = random_scene(61, 47, seed);
    SegmentOptions options;
    options.sigma = 0.0F;
    options.normal_weight = 0.7F;
    options.color_weight = seed % 3 == 0 ? 0.0F : 1.3F;
    Reference reference(scene, options);
    for (const float coarseness : {0.0F, 0.02F, 0.2F, 1.0F, 6.0F}) {
      for (const int min_size : {0, 7, 40}) {
        options.coarseness = coarseness;
        options.min_size = min_size;
        const Segments segments = segment(scene.view(), options);
        ASSERT_EQ(list(segments), reference.segment(coarseness, min_size))
            << seed << " " << coarseness << " " << min_size;
        counts.push_back(segments.count);
      }
    }
  }
  std::sort(counts.begin(), counts.end());
  EXPECT_GT(std::unique(counts.begin(), counts.end()) - counts.begin(), 40) << "no trivial cases";
}

// A heavier edge can join two sets that the tree of the lightest edges holds apart, because a set
// between them has stopped growing. So the graph keeps such edges, too.
TEST(Segment, TheGraphGivesWhatTheFunctionGives) {
  for (std::uint64_t seed = 20; seed < 23; ++seed) {
    const Scene scene = random_scene(110, 90, seed);
    SegmentOptions options;
    options.sigma = 0.0F;
    for (const float built_for : {0.0F, 1.0F, 20.0F}) {
      options.coarseness = built_for;
      const SegmentGraph graph(scene.view(), options);
      for (const float coarseness : {0.01F, 0.06F, 0.3F, 1.0F, 30.0F}) {
        SegmentOptions other = options;
        other.coarseness = coarseness;
        for (const int min_size : {0, 20}) {
          other.min_size = min_size;
          const Segments expected = segment(scene.view(), other);
          const Segments again = graph.segment(coarseness, min_size);
          ASSERT_EQ(again.count, expected.count);
          ASSERT_EQ(list(again), list(expected)) << seed << " " << built_for << " " << coarseness;
        }
      }
    }
  }
}

TEST(Segment, TheNumberOfThreadsChangesNothing) {
  const Scene scene = random_scene(333, 517, 3);
  const auto both = [&] {
    auto labels = list(segment(scene.view(), {.coarseness = 0.5F}));
    const auto again = list(SegmentGraph(scene.view()).segment(0.5F, 10));
    labels.insert(labels.end(), again.begin(), again.end());
    return labels;
  };
  const auto many = both();
  const ThreadLimit limit(1);
  EXPECT_EQ(many, both());
}

TEST(Segment, FindsPatchesOfColorInNoise) {
  Scene scene(120, 90);
  Random random(4);
  const auto patch = [](int x, int y) { return (x >= 40 ? 1 : 0) + (y >= 30 ? 2 : 0); };
  const Vec3f colors[4] = {
      {0.2F, 0.2F, 0.2F}, {0.5F, 0.3F, 0.1F}, {0.1F, 0.5F, 0.4F}, {0.6F, 0.6F, 0.7F}};
  for (int y = 0; y < 90; ++y) {
    for (int x = 0; x < 120; ++x) {
      const auto noise = [&] { return random.uniform(-0.03F, 0.03F); };
      scene.color(x, y) = colors[patch(x, y)] + Vec3f(noise(), noise(), noise());
      scene.slopes(x, y) = {noise(), noise()};
    }
  }
  const Segments segments = segment(scene.view(), {.sigma = 0.0F});
  ASSERT_EQ(segments.count, 4U);
  for (int y = 0; y < 90; ++y) {
    for (int x = 0; x < 120; ++x) {
      ASSERT_EQ(segments.labels(x, y), static_cast<std::uint32_t>(patch(x, y))) << x << " " << y;
    }
  }
  EXPECT_EQ(segment(scene.view(), {.color_weight = 0.0F}).count, 1U);
}

/// Normals of a cube seen along its diagonal.
TEST(Segment, FindsTheFacesOfACube) {
  constexpr int size = 128;
  Scene scene(size, size);
  scene.validity = MaskImage(size, size, 1.0F);
  const float tilt = std::sqrt(2.0F);  // slope of each face
  const auto face = [&](int x, int y) {
    const double angle = std::atan2(63.5 - y, x - 63.5) * 180.0 / 3.14159265358979;
    return angle > -90.0 && angle <= 30.0 ? 0 : angle > 30.0 && angle <= 150.0 ? 1 : 2;
  };
  Random random(8);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const float middle = static_cast<float>(face(x, y) * 120 - 30) * 3.14159265F / 180.0F;
      scene.slopes(x, y) = -tilt * Vec2f(std::cos(middle), std::sin(middle)) +
                           Vec2f(random.uniform(-0.03F, 0.03F), random.uniform(-0.03F, 0.03F));
      if (std::hypot(x - 63.5, y - 63.5) > 60.0) scene.validity(x, y) = 0.0F;
    }
  }
  const Segments segments = segment({scene.slopes, {}, scene.validity}, {.sigma = 0.0F});
  ASSERT_EQ(segments.count, 3U);
  const std::array<std::uint32_t, 3> labels = {segments.labels(95, 80), segments.labels(63, 20),
                                               segments.labels(30, 80)};
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const bool valid = scene.validity(x, y) > 0.0F;
      ASSERT_EQ(segments.labels(x, y),
                valid ? labels[static_cast<std::size_t>(face(x, y))] : no_label);
    }
  }
}

TEST(Segment, PixelsWithoutDirectionBelongToNone) {
  Scene scene(20, 10);
  scene.slopes(3, 4).x() = nan;
  scene.color(8, 2).z() = std::numeric_limits<float>::infinity();
  const Segments segments = segment(scene.view());
  EXPECT_EQ(segments.count, 1U);
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 20; ++x) {
      const bool none = (x == 3 && y == 4) || (x == 8 && y == 2);
      EXPECT_EQ(segments.labels(x, y), none ? no_label : 0U);
    }
  }
  const Segments by_color = segment(scene.view(), {.normal_weight = 0.0F});
  EXPECT_EQ(by_color.labels(3, 4), 0U);
  EXPECT_EQ(by_color.labels(8, 2), no_label);
}

TEST(Segment, SmallPiecesStayWhereTheyTouchNothing) {
  Scene scene(9, 3);
  scene.validity = MaskImage(9, 3, 1.0F);
  for (int y = 0; y < 3; ++y) scene.validity(4, y) = 0.0F;
  const Segments segments = segment(scene.view(), {.min_size = 1000});
  EXPECT_EQ(segments.count, 2U);
  EXPECT_EQ(segments.labels(0, 0), 0U);
  EXPECT_EQ(segments.labels(8, 2), 1U);
}

TEST(Segment, TinyImages) {
  EXPECT_EQ(segment({}).count, 0U);
  EXPECT_TRUE(SegmentGraph({}).segment(1.0F, 5).labels.empty());
  const Scene one(1, 1);
  EXPECT_EQ(segment(one.view()).count, 1U);
  const Scene line(1, 7);
  EXPECT_EQ(SegmentGraph(line.view()).segment(1.0F, 0).count, 1U);
}

TEST(Segment, RejectsWhatIsNoNumber) {
  const Scene scene(4, 4);
  EXPECT_THROW(segment(scene.view(), {.coarseness = nan}), InvalidInput);
  EXPECT_THROW(segment(scene.view(), {.min_size = -1}), InvalidInput);
  EXPECT_THROW(segment(scene.view(), {.color_weight = -1.0F}), InvalidInput);
  EXPECT_THROW(segment(scene.view(), {.normal_weight = nan}), InvalidInput);
  EXPECT_THROW(segment(scene.view(), {.sigma = nan}), InvalidInput);
  EXPECT_THROW(SegmentGraph(scene.view()).segment(nan, 0), InvalidInput);
  EXPECT_THROW(SegmentGraph(scene.view()).segment(1.0F, -1), InvalidInput);
}

}  // namespace
}  // namespace normalshop::test
