#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <tuple>
#include <type_traits>

#include "normalshop/core/vec.h"

/// Option reflection. An options struct describes its fields once:
///
///     struct SmoothOptions {
///       float sigma = 1.0F;
///       static constexpr auto fields() {
///         return std::tuple{field("sigma", &SmoothOptions::sigma, "length", 0, 1e6,
///                                 "Standard deviation; 0 leaves the input as it is")};
///       }
///     };
///
/// Recipes, `describe`, command-line flags and later the studio's sliders come from it. Field
/// types: float, int, bool, std::string, Vec2f, Curve, std::vector<float> (the range is that of
/// each number), and enums with a `names_of(Enum)` found by ADL.
namespace normalshop {

template <class Owner, class T>
struct Field {
  std::string_view name;
  T Owner::*member;
  std::string_view unit;  ///< "length", "pixels", "degrees", "1" (a ratio), "" (no number)
  double min;             ///< accepted range, both ends included; min == max: no limit
  double max;
  std::string_view help;  ///< one sentence; says what the limiting values do
};

template <class Owner, class T>
constexpr Field<Owner, T> field(std::string_view name, T Owner::*member, std::string_view unit,
                                double min, double max, std::string_view help) {
  return {name, member, unit, min, max, help};
}

/// A field without unit and range: names, switches, curves.
template <class Owner, class T>
constexpr Field<Owner, T> field(std::string_view name, T Owner::*member, std::string_view help) {
  return {name, member, "", 0.0, 0.0, help};
}

/// visit(field) for every field of an options type.
template <class Options, class Visitor>
constexpr void for_each_field(Visitor&& visit) {
  std::apply([&](const auto&... each) { (visit(each), ...); }, Options::fields());
}

/// Multiplies every field whose unit is "length" (floats and Vec2f) by `factor`: users give lengths
/// in object units, operators take them in pixels.
template <class Options>
Options scale_lengths(Options options, float factor) {
  for_each_field<Options>([&](const auto& f) {
    auto& value = options.*f.member;
    using T = std::remove_reference_t<decltype(value)>;
    if constexpr (std::is_same_v<T, float> || std::is_same_v<T, Vec2f>) {
      if (f.unit == "length") value *= factor;
    }
  });
  return options;
}

/// Names of an enum's values in order, for reflection: specialise by overloading
/// `constexpr auto names_of(MyEnum) { return std::array<std::string_view, 2>{"a", "b"}; }`.
template <class E>
concept NamedEnum = std::is_enum_v<E> && requires(E e) {
  names_of(e).size();
};

template <NamedEnum E>
constexpr std::string_view name_of(E value) {
  return names_of(value)[static_cast<std::size_t>(value)];
}

/// Sets `value` to the one with that name; false when there is none.
template <NamedEnum E>
constexpr bool from_name(std::string_view name, E& value) {
  const auto names = names_of(E{});
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i] != name) continue;
    value = static_cast<E>(i);
    return true;
  }
  return false;
}

}  // namespace normalshop
