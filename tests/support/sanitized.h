#pragma once

/// Is this a program with sanitizers?
#if defined(__SANITIZE_ADDRESS__)
#define NORMALSHOP_SANITIZED true
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define NORMALSHOP_SANITIZED true
#endif
#endif
#ifndef NORMALSHOP_SANITIZED
#define NORMALSHOP_SANITIZED false
#endif

namespace normalshop::test {

inline constexpr bool sanitized = NORMALSHOP_SANITIZED;

}  // namespace normalshop::test

/// In front of a test of figures that take long, of code that shorter tests run too: sanitizers,
/// which look at the code, see those alone.
#define NORMALSHOP_SKIP_FIGURES() \
  if (normalshop::test::sanitized) GTEST_SKIP() << "figures, of code that shorter tests run too"
