#pragma once

#include <cstddef>
#include <functional>

namespace normalshop {

/// Calls body(begin, end) for disjoint ranges that cover [0, count), on all cores. Which thread
/// gets which range is unspecified, so results may not depend on it. `grain`: smallest range worth
/// a task. Exceptions of the body are rethrown.
void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t, std::size_t)>& body);

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
