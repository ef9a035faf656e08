#pragma once

#include <string>
#include <type_traits>
#include <vector>

#include "normalshop/core/curve.h"
#include "normalshop/core/options.h"
#include "normalshop/document/field_reader.h"

/// Options structs to and from values, by their reflection (core/options.h).
namespace normalshop {

/// Lengths have no default that fits every model: those whose default is not 0 must be given, and
/// so must what the options list as `static constexpr std::array required_fields{...}`.
template <class Options, class Owner, class T>
constexpr bool is_required(const Field<Owner, T>& f) {
  if constexpr (requires { Options::required_fields; }) {
    for (const std::string_view name : Options::required_fields) {
      if (name == f.name) return true;
    }
  }
  if constexpr (std::is_same_v<T, float>) {
    return f.unit == "length" && Owner{}.*f.member != 0.0F;
  } else {
    return false;
  }
}

template <class E>
std::vector<std::string_view> names_list() {
  const auto names = names_of(E{});
  return {names.begin(), names.end()};
}

template <class Options, class Owner, class T>
void read_field(const FieldReader& reader, const Field<Owner, T>& f, Options& options) {
  T& target = options.*f.member;
  if constexpr (std::is_same_v<T, float>) {
    target = static_cast<float>(reader.number(f.min, f.max));
  } else if constexpr (std::is_same_v<T, int>) {
    target = reader.whole_number(static_cast<int>(f.min), static_cast<int>(f.max));
  } else if constexpr (std::is_same_v<T, bool>) {
    target = reader.boolean();
  } else if constexpr (std::is_same_v<T, std::string>) {
    target = reader.text();
  } else if constexpr (std::is_same_v<T, Curve>) {
    std::vector<Vec2f> points;
    for (const FieldReader& point : reader.items()) points.push_back(point.vec2());
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (i > 0 && points[i].x() <= points[i - 1].x()) {
        reader.fail("points [u, height] with increasing u");
      }
    }
    target = points.empty() ? Curve() : Curve(std::move(points));
  } else if constexpr (std::is_same_v<T, std::vector<float>>) {
    for (const FieldReader& item : reader.items()) {
      target.push_back(static_cast<float>(item.number(f.min, f.max)));
    }
  } else {
    static_assert(NamedEnum<T>);
    target = static_cast<T>(reader.one_of(names_list<T>()));
  }
}

/// Throws InvalidInput for unknown, missing and unacceptable fields.
template <class Options>
Options read_options(const FieldReader& reader) {
  Options options;
  std::vector<std::string_view> names;
  for_each_field<Options>([&](const auto& f) { names.push_back(f.name); });
  reader.only(names);
  for_each_field<Options>([&](const auto& f) {
    if (is_required<Options>(f) || reader.has(f.name))
      read_field(reader.required(f.name), f, options);
  });
  return options;
}

template <class Options, class Owner, class T>
Value field_value(const Options& options, const Field<Owner, T>& f) {
  const T& value = options.*f.member;
  if constexpr (std::is_same_v<T, Curve>) {
    Value::Array points;
    for (const Vec2f& p : value.points()) points.push_back(Value::Array{p.x(), p.y()});
    return points;
  } else if constexpr (std::is_same_v<T, std::vector<float>>) {
    return Value::Array(value.begin(), value.end());
  } else if constexpr (NamedEnum<T>) {
    return name_of(value);
  } else {
    return value;
  }
}

template <class Options>
Value options_value(const Options& options) {
  Value::Object fields;
  for_each_field<Options>(
      [&](const auto& f) { fields.emplace_back(f.name, field_value(options, f)); });
  return fields;
}

template <class T>
constexpr std::string_view type_name() {
  if constexpr (std::is_same_v<T, float>) return "number";
  if constexpr (std::is_same_v<T, int>) return "integer";
  if constexpr (std::is_same_v<T, bool>) return "switch";
  if constexpr (std::is_same_v<T, std::string>) return "text";
  if constexpr (std::is_same_v<T, Curve>) return "curve";
  if constexpr (std::is_same_v<T, std::vector<float>>) return "numbers";
  return "name";
}

/// One object a field: name, type, unit, range, names, default or required, help.
template <class Options>
Value::Array describe_fields() {
  Value::Array out;
  for_each_field<Options>([&](const auto& f) {
    using T = std::remove_cvref_t<decltype(Options{}.*f.member)>;
    Value::Object field{{"name", f.name}, {"type", type_name<T>()}};
    if (!f.unit.empty()) field.emplace_back("unit", f.unit);
    if (f.min != f.max) field.emplace_back("range", Value::Array{f.min, f.max});
    if constexpr (NamedEnum<T>) {
      Value::Array names;
      for (const std::string_view name : names_of(T{})) names.emplace_back(name);
      field.emplace_back("names", names);
    }
    if (is_required<Options>(f)) {
      field.emplace_back("required", true);
    } else {
      field.emplace_back("default", field_value(Options{}, f));
    }
    field.emplace_back("help", f.help);
    out.emplace_back(std::move(field));
  });
  return out;
}

}  // namespace normalshop
