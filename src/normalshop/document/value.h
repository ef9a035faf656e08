#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "normalshop/core/vec.h"

namespace normalshop {

/// A JSON value that keeps the order of its fields: what recipes are read from and reports written
/// to.
class Value {
 public:
  using Array = std::vector<Value>;
  using Object = std::vector<std::pair<std::string, Value>>;

  Value() = default;
  Value(bool b) : data_(b) {}
  Value(double number) : data_(number) {}
  Value(float number) : data_(static_cast<double>(number)) {}
  Value(int number) : data_(static_cast<double>(number)) {}
  Value(std::size_t number) : data_(static_cast<double>(number)) {}
  Value(std::string text) : data_(std::move(text)) {}
  Value(std::string_view text) : data_(std::string(text)) {}
  Value(const char* text) : data_(std::string(text)) {}
  Value(Array array) : data_(std::move(array)) {}
  Value(Object object) : data_(std::move(object)) {}

  bool is_null() const { return std::holds_alternative<std::monostate>(data_); }
  /// Null when it is something else.
  const bool* boolean() const { return std::get_if<bool>(&data_); }
  const double* number() const { return std::get_if<double>(&data_); }
  const std::string* text() const { return std::get_if<std::string>(&data_); }
  const Array* array() const { return std::get_if<Array>(&data_); }
  const Object* object() const { return std::get_if<Object>(&data_); }
  /// A field of an object; null when there is none.
  const Value* find(std::string_view name) const;
  /// Short words for messages: `the text "wide"`, "a list of 3", "the number 7".
  std::string describe() const;

 private:
  std::variant<std::monostate, bool, double, std::string, Array, Object> data_;
};

/// A list of its components.
inline Value vec3_value(const Vec3f& v) { return Value::Array{v.x(), v.y(), v.z()}; }

/// Strict JSON (UTF-8, no comments, no repeated field names, nesting up to 100). Throws
/// InvalidInput with the line, named `name`.
Value parse_json(std::string_view text, std::string_view name);

/// The value with one field, "options.width", set anew; objects on the way are made where they are
/// missing. Throws InvalidInput where something else stands there.
Value with_field(const Value& value, std::string_view path, const Value& field);

/// Indented by 2; arrays of numbers on one line. Numbers print as the shortest text that reads
/// back; numbers that are not finite as null.
std::string to_json(const Value& value);
/// The same without the line's end: numbers, texts and flat lists inside a sentence.
std::string to_line(const Value& value);

}  // namespace normalshop
