#include "progress_bar.h"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>

#include <unistd.h>

namespace normalshop::cli {

namespace {

/// One line that is drawn over.
class Bar {
 public:
  Bar() = default;
  Bar(const Bar&) = delete;
  Bar& operator=(const Bar&) = delete;
  ~Bar() { std::fputs("\r\033[K", stderr); }

  void draw(double fraction, std::string_view stage) {
    constexpr std::size_t width = 40;
    const auto done = static_cast<std::size_t>(fraction * width);
    const std::string bar = std::string(done, '#') + std::string(width - done, '.');
    std::fprintf(stderr, "\r\033[K%s %3.0f %% %.*s", bar.c_str(), 100.0 * fraction,
                 static_cast<int>(stage.size()), stage.data());
    std::fflush(stderr);
  }
};

}  // namespace

Progress progress_bar() {
  if (::isatty(STDERR_FILENO) == 0) return {};
  const auto bar = std::make_shared<Bar>();
  return {[bar](double fraction, std::string_view stage) {
    bar->draw(std::min(1.0, std::max(0.0, fraction)), stage);
    return true;
  }};
}

}  // namespace normalshop::cli
