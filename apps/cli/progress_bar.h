#pragma once

#include "normalshop/core/progress.h"

namespace normalshop::cli {

/// A bar on the standard error where that is a terminal, else nothing. It is wiped at its end.
Progress progress_bar();

}  // namespace normalshop::cli
