#pragma once

#include <string>

namespace normalshop::demo {

/// The demo's edits as the JSON that a user would write.
std::string recipe_text();

}  // namespace normalshop::demo
