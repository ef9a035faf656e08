#pragma once

#include <cstddef>
#include <functional>

namespace normalshop {

/// Calls body(begin, end) for disjoint ranges that cover [0, count), on all cores. Which thread
/// gets which range is unspecified, so results may not depend on it. `grain`: smallest range worth
/// a task. Exceptions of the body are rethrown.
void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t, std::size_t)>& body);

/// body(y) for rows 0 to height - 1, a few of them a task.
template <class Body>
void parallel_rows(int height, const Body& body) {
  constexpr std::size_t rows_per_task = 16;
  parallel_for(static_cast<std::size_t>(height), rows_per_task,
               [&](std::size_t begin, std::size_t end) {
                 for (std::size_t y = begin; y < end; ++y) body(static_cast<int>(y));
               });
}

/// Threads that parallel_for uses at present.
int thread_count();

/// Limits parallel_for to `threads` threads while it lives (tests of determinism, benchmarks).
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  void* control_;
};

}  // namespace normalshop
