#include "normalshop/surface/seam_fit.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "normalshop/core/parallel.h"
#include "normalshop/core/sample.h"
#include "normalshop/core/slope.h"
#include "normalshop/surface/frames.h"
#include "normalshop/surface/texel_map.h"

namespace normalshop {

namespace {

constexpr std::uint32_t fixed = 0xFFFFFFFFU;
constexpr int rounds = 8;           // Gauss-Newton steps
constexpr int steps = 60;           // conjugate gradients in each
constexpr double stiffness = 0.01;  // of texels against leaving their normal
constexpr double largest_step = 0.4;
/// Places between two samples, so that both sides also agree where nobody measures.
constexpr int between_count = 3;
constexpr float between_weight = 0.3F;
/// Degrees between both sides' base normals: up to the first they show one surface, from the second
/// on (hard_edge_degrees) an edge of it.
constexpr float same_surface = 5.0F;
constexpr std::size_t fit_grain = 512;

using Plane = Eigen::Matrix<double, 3, 2>;

struct Read {
  Vec3d normal{0.0, 0.0, 0.0};
  double length = 0.0;
};

SeamSample between(const SeamSample& from, const SeamSample& to, float t) {
  const auto mix = [t](const SurfacePoint& p, const SurfacePoint& q) {
    return SurfacePoint{p.triangle, p.b1 + t * (q.b1 - p.b1), p.b2 + t * (q.b2 - p.b2)};
  };
  return {from.edge, mix(from.a, to.a), mix(from.b, to.b)};
}

/// Two unit vectors that span the plane of a unit vector.
Plane plane_of(const Vec3d& n) {
  Eigen::Index axis = 0;
  n.cwiseAbs().minCoeff(&axis);
  Plane plane;
  plane.col(0) = Vec3d::Unit(axis).cross(n).normalized();
  plane.col(1) = n.cross(plane.col(0));
  return plane;
}

}  // namespace

/// The least-squares problem of the samples that read a changed texel.
class SeamFit::Solver {
 public:
  Solver(const SeamFit& fit, std::span<NormalMap* const> maps);
  std::size_t run(std::span<NormalMap* const> maps);

 private:
  /// How a sample's difference answers to a free texel's two numbers.
  struct Block {
    std::uint32_t free;
    Plane by;
  };
  struct Row {
    std::array<Block, 8> blocks;
    int count = 0;
    Vec3d residual;
  };
  struct Use {
    std::uint32_t row;
    std::uint32_t block;
  };

  Read read(const Side& side) const;
  Vec3d target(const Sample& sample) const;
  void linearise();
  void linearise(std::size_t row);
  std::vector<Vec2d> solve() const;
  std::vector<Vec2d> transposed(const std::vector<Vec3d>& v) const;
  std::vector<Vec2d> normal_product(const std::vector<Vec2d>& x) const;
  void index_uses();

  const SeamFit& fit_;
  std::vector<std::uint32_t> free_of_;  // per texel: index of its unknowns, or fixed
  std::vector<std::uint32_t> texel_of_;
  std::vector<Vec3d> normals_;  // per texel, now
  std::vector<Plane> planes_;   // per free texel
  std::vector<const Sample*> samples_;
  std::vector<Vec3d> targets_;  // per sample: normal of side 0 minus that of side 1
  std::vector<Row> rows_;
  std::vector<std::size_t> first_use_;  // per free texel, into uses_
  std::vector<Use> uses_;
};

SeamFit::Solver::Solver(const SeamFit& fit, std::span<NormalMap* const> maps) : fit_(fit) {
  for (const Texel& t : fit.texels_) {
    const NormalMap& map = *maps[t.set];
    const auto [x, y] = texel_place(t.texel, map.width());
    const Vec3f now = map.vector(x, y);
    const bool moves = map.edited(x, y) && now != t.before;
    free_of_.push_back(moves ? static_cast<std::uint32_t>(texel_of_.size()) : fixed);
    if (moves) texel_of_.push_back(static_cast<std::uint32_t>(normals_.size()));
    normals_.push_back(now.cast<double>());
  }
  for (const Sample& s : fit.samples_) {
    const auto reads_free = [&](const Side& side) {
      return std::any_of(side.texels.begin(), side.texels.end(),
                         [&](std::uint32_t t) { return free_of_[t] != fixed; });
    };
    if (reads_free(s.sides[0]) || reads_free(s.sides[1])) samples_.push_back(&s);
  }
  for (const Sample* s : samples_) targets_.push_back(target(*s));
}

Read SeamFit::Solver::read(const Side& side) const {
  Vec3d sum(0.0, 0.0, 0.0);
  for (std::size_t i = 0; i < 4; ++i) {
    sum += static_cast<double>(side.weights[i]) * normals_[side.texels[i]];
  }
  const Vec3d v = side.to_object.cast<double>() * sum;
  Read out;
  out.length = v.norm();
  if (out.length > 1e-6) out.normal = v / out.length;
  return out;
}

/// The present difference, cut to the size of the old one.
Vec3d SeamFit::Solver::target(const Sample& sample) const {
  const Vec3d difference = read(sample.sides[0]).normal - read(sample.sides[1]).normal;
  const double size = difference.norm();
  const auto allowed = static_cast<double>(sample.allowed);
  return size > allowed ? Vec3d(allowed / size * difference) : difference;
}

void SeamFit::Solver::linearise(std::size_t index) {
  const Sample& sample = *samples_[index];
  Row& row = rows_[index];
  row.count = 0;
  row.residual.setZero();
  const std::array<Read, 2> reads{read(sample.sides[0]), read(sample.sides[1])};
  if (reads[0].normal.isZero() || reads[1].normal.isZero()) return;
  const auto weight = static_cast<double>(sample.weight);
  row.residual = weight * (reads[0].normal - reads[1].normal - targets_[index]);
  for (std::size_t k = 0; k < 2; ++k) {
    const Side& side = sample.sides[k];
    const Vec3d& n = reads[k].normal;
    const double scale = (k == 0 ? weight : -weight) / reads[k].length;
    const Eigen::Matrix3d by =
        scale * (Eigen::Matrix3d::Identity() - n * n.transpose()) * side.to_object.cast<double>();
    for (std::size_t i = 0; i < 4; ++i) {
      const std::uint32_t free = free_of_[side.texels[i]];
      if (free == fixed || side.weights[i] == 0.0F) continue;
      row.blocks[static_cast<std::size_t>(row.count++)] = {
          free, static_cast<double>(side.weights[i]) * by * planes_[free]};
    }
  }
}

void SeamFit::Solver::linearise() {
  planes_.resize(texel_of_.size());
  for (std::size_t i = 0; i < planes_.size(); ++i) planes_[i] = plane_of(normals_[texel_of_[i]]);
  rows_.resize(samples_.size());
  parallel_for(rows_.size(), fit_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) linearise(i);
  });
  index_uses();
}

/// Which rows read each free texel, so that sums run in one order on any number of threads.
void SeamFit::Solver::index_uses() {
  first_use_.assign(texel_of_.size() + 1, 0);
  for (const Row& row : rows_) {
    for (int i = 0; i < row.count; ++i) {
      ++first_use_[row.blocks[static_cast<std::size_t>(i)].free + 1];
    }
  }
  for (std::size_t i = 1; i < first_use_.size(); ++i) first_use_[i] += first_use_[i - 1];
  uses_.resize(first_use_.back());
  std::vector<std::size_t> next(first_use_.begin(), first_use_.end() - 1);
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    for (int i = 0; i < rows_[r].count; ++i) {
      const auto block = static_cast<std::uint32_t>(i);
      uses_[next[rows_[r].blocks[block].free]++] = {static_cast<std::uint32_t>(r), block};
    }
  }
}

std::vector<Vec2d> SeamFit::Solver::transposed(const std::vector<Vec3d>& v) const {
  std::vector<Vec2d> out(texel_of_.size());
  parallel_for(out.size(), fit_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Vec2d sum(0.0, 0.0);
      for (std::size_t u = first_use_[i]; u < first_use_[i + 1]; ++u) {
        sum += rows_[uses_[u].row].blocks[uses_[u].block].by.transpose() * v[uses_[u].row];
      }
      out[i] = sum;
    }
  });
  return out;
}

/// (J^T J + stiffness) x
std::vector<Vec2d> SeamFit::Solver::normal_product(const std::vector<Vec2d>& x) const {
  std::vector<Vec3d> v(rows_.size());
  parallel_for(v.size(), fit_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      Vec3d sum(0.0, 0.0, 0.0);
      for (int i = 0; i < rows_[r].count; ++i) {
        const Block& block = rows_[r].blocks[static_cast<std::size_t>(i)];
        sum += block.by * x[block.free];
      }
      v[r] = sum;
    }
  });
  std::vector<Vec2d> out = transposed(v);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] += stiffness * x[i];
  return out;
}

namespace {

double dot(const std::vector<Vec2d>& a, const std::vector<Vec2d>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

void add(std::vector<Vec2d>& to, double factor, const std::vector<Vec2d>& v) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += factor * v[i];
}

}  // namespace

/// Conjugate gradients on the normal equations.
std::vector<Vec2d> SeamFit::Solver::solve() const {
  std::vector<Vec3d> wanted(rows_.size());
  for (std::size_t r = 0; r < rows_.size(); ++r) wanted[r] = -rows_[r].residual;
  std::vector<Vec2d> rest = transposed(wanted);
  std::vector<Vec2d> direction = rest;
  std::vector<Vec2d> x(rest.size(), Vec2d(0.0, 0.0));
  double size = dot(rest, rest);
  const double enough = 1e-8 * size;
  for (int step = 0; step < steps && size > enough; ++step) {
    const std::vector<Vec2d> product = normal_product(direction);
    const double factor = size / dot(direction, product);
    add(x, factor, direction);
    add(rest, -factor, product);
    const double next = dot(rest, rest);
    for (std::size_t i = 0; i < rest.size(); ++i) {
      direction[i] = rest[i] + (next / size) * direction[i];
    }
    size = next;
  }
  return x;
}

std::size_t SeamFit::Solver::run(std::span<NormalMap* const> maps) {
  if (samples_.empty()) return 0;
  for (int round = 0; round < rounds; ++round) {
    linearise();
    const std::vector<Vec2d> moves = solve();
    for (std::size_t i = 0; i < moves.size(); ++i) {
      const double length = moves[i].norm();
      if (!(length > 0.0)) continue;
      const Vec2d move = moves[i] * std::min(1.0, largest_step / length);
      Vec3d& n = normals_[texel_of_[i]];
      n = (n + planes_[i] * move).normalized();
    }
  }
  for (const std::uint32_t index : texel_of_) {
    const Texel& t = fit_.texels_[index];
    NormalMap& map = *maps[t.set];
    const auto [x, y] = texel_place(t.texel, map.width());
    map.set_normal(x, y, normals_[index].cast<float>().normalized());
  }
  return texel_of_.size();
}

SeamFit::SeamFit(const Mesh& mesh, std::span<const SeamEdge> edges, NormalMaps maps, float kept) {
  std::vector<std::uint64_t> keys;
  const std::vector<SeamSample> places = sample_seams(mesh, edges, maps);
  for (std::size_t i = 0; i < places.size(); ++i) {
    add_sample(mesh, places[i], 1.0F, maps, keys);
    if (i + 1 < places.size() && places[i + 1].edge == places[i].edge) {
      for (int k = 1; k <= between_count; ++k) {
        const float t = static_cast<float>(k) / static_cast<float>(between_count + 1);
        add_sample(mesh, between(places[i], places[i + 1], t), between_weight, maps, keys);
      }
    }
  }
  collect_texels(keys, maps);
  remember_reads(kept);
}

/// The side's texels become places in `keys`; collect_texels() makes them indices.
SeamFit::Side SeamFit::side(const Mesh& mesh, const SurfacePoint& point, NormalMaps maps,
                            std::vector<std::uint64_t>& keys) const {
  const std::uint32_t set = mesh.texture_sets[point.triangle];
  const NormalMap& map = *maps[set];
  const std::size_t corner = 3 * static_cast<std::size_t>(point.triangle);
  const Vec2f uv = interpolate<Vec2f>(mesh.uvs[corner], mesh.uvs[corner + 1], mesh.uvs[corner + 2],
                                      point.b1, point.b2);
  const WrappedTaps tap(reading_place(mesh, set, uv, map.width(), map.height()), map.width(),
                        map.height());
  Side out;
  out.to_object = frame_at(mesh, point, map.convention().space).to_object;
  out.weights = {(1.0F - tap.fx) * (1.0F - tap.fy), tap.fx * (1.0F - tap.fy),
                 (1.0F - tap.fx) * tap.fy, tap.fx * tap.fy};
  const std::array<int, 4> xs{tap.x0, tap.x1, tap.x0, tap.x1};
  const std::array<int, 4> ys{tap.y0, tap.y0, tap.y1, tap.y1};
  for (std::size_t i = 0; i < 4; ++i) {
    out.texels[i] = static_cast<std::uint32_t>(keys.size());
    const std::size_t texel =
        static_cast<std::size_t>(ys[i]) * static_cast<std::size_t>(map.width()) +
        static_cast<std::size_t>(xs[i]);
    keys.push_back((std::uint64_t{set} << 32U) | texel);
  }
  return out;
}

void SeamFit::add_sample(const Mesh& mesh, const SeamSample& place, float weight, NormalMaps maps,
                         std::vector<std::uint64_t>& keys) {
  const auto bend = static_cast<float>(
      angle_degrees(base_normal_at(mesh, place.a), base_normal_at(mesh, place.b)));
  if (!(bend < hard_edge_degrees)) return;
  Sample s;
  s.sides[0] = side(mesh, place.a, maps, keys);
  s.sides[1] = side(mesh, place.b, maps, keys);
  s.weight = weight * (1.0F - smoothstep(same_surface, hard_edge_degrees, bend));
  samples_.push_back(s);
}

void SeamFit::collect_texels(const std::vector<std::uint64_t>& keys, NormalMaps maps) {
  std::vector<std::uint64_t> unique = keys;
  std::sort(unique.begin(), unique.end());
  unique.erase(std::unique(unique.begin(), unique.end()), unique.end());
  for (Sample& s : samples_) {
    for (Side& side : s.sides) {
      for (std::uint32_t& t : side.texels) {
        t = static_cast<std::uint32_t>(std::lower_bound(unique.begin(), unique.end(), keys[t]) -
                                       unique.begin());
      }
    }
  }
  for (const std::uint64_t key : unique) {
    const auto set = static_cast<std::uint32_t>(key >> 32U);
    const auto texel = static_cast<std::uint32_t>(key);
    const auto [x, y] = texel_place(texel, maps[set]->width());
    texels_.push_back({set, texel, maps[set]->vector(x, y)});
  }
}

void SeamFit::remember_reads(float kept) {
  for (Sample& s : samples_) {
    std::array<Vec3f, 2> normals{Vec3f::Zero(), Vec3f::Zero()};
    for (std::size_t k = 0; k < 2; ++k) {
      Vec3f sum(0.0F, 0.0F, 0.0F);
      for (std::size_t i = 0; i < 4; ++i) {
        sum += s.sides[k].weights[i] * texels_[s.sides[k].texels[i]].before;
      }
      normals[k] = TangentFrame{s.sides[k].to_object}.object_normal(sum);
    }
    s.allowed = kept * (normals[0] - normals[1]).norm();
  }
}

std::size_t SeamFit::apply(std::span<NormalMap* const> maps) const {
  return Solver(*this, maps).run(maps);
}

}  // namespace normalshop
