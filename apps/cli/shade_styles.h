#pragma once

#include "normalshop/document/value.h"

namespace normalshop::cli {

/// The styles of `shade` that have options of their own, and these: one object a style with the
/// fields style, summary and options, as describe_operators() has them.
Value describe_styles();

}  // namespace normalshop::cli
