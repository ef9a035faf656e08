#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "normalshop/core/vec.h"
#include "normalshop/document/value.h"

namespace normalshop {

/// A value and where it stands ("scar.json: edits[2].options.width"), for reading with messages
/// that name the field, what was found and what would be accepted. Every getter throws
/// InvalidInput.
class FieldReader {
 public:
  FieldReader(const Value& value, std::string path) : value_(value), path_(std::move(path)) {}

  /// Null for a required field that is missing: the getter's message then says so.
  const Value& value() const { return value_; }
  const std::string& path() const { return path_; }
  /// "<path> must be <expected>, not <what is there>", or "... is missing; it must be <expected>".
  [[noreturn]] void fail(std::string_view expected) const;

  /// Both ends included; low == high: any number up to 1e30.
  double number(double low = 0.0, double high = 0.0) const;
  int whole_number(int low, int high) const;
  bool boolean() const;
  const std::string& text() const;
  /// The index of one of these names.
  std::size_t one_of(const std::vector<std::string_view>& names) const;
  /// Exactly 2 or 3 numbers from -1e9 to 1e9.
  Vec2f vec2() const;
  Vec3f vec3() const;
  std::vector<FieldReader> items() const;

  /// Fields of an object. Asking for one that is missing throws only when its value is read.
  FieldReader required(std::string_view name) const;
  bool has(std::string_view name) const;
  /// Throws when the object has a field that is not among `names`.
  void only(const std::vector<std::string_view>& names) const;

 private:
  FieldReader child(std::string_view name, const Value& value) const;
  bool missing() const;

  const Value& value_;
  std::string path_;
};

/// `a, b or c`
std::string join_names(const std::vector<std::string_view>& names);

}  // namespace normalshop
