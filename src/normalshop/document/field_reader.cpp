#include "normalshop/document/field_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "normalshop/core/error.h"

namespace normalshop {

namespace {

constexpr double farthest = 1e9;

/// What required() gives for a missing field.
const Value& missing_value() {
  static const Value value;
  return value;
}

std::string plain(double number) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.10g", number);
  return text.data();
}

std::string range_text(double low, double high) {
  return "number from " + plain(low) + " to " + plain(high);
}

float coordinate(const FieldReader& reader) {
  return static_cast<float>(reader.number(-farthest, farthest));
}

}  // namespace

std::string join_names(const std::vector<std::string_view>& names) {
  std::string out;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) out += i + 1 == names.size() ? " or " : ", ";
    out += names[i];
  }
  return out;
}

void FieldReader::fail(std::string_view expected) const {
  // At the root the path is only the file's name: "scar.json: must be ...".
  const std::string subject = path_.ends_with(": ") ? path_ : path_ + " ";
  if (missing()) throw InvalidInput(subject + "is missing; it must be " + std::string(expected));
  throw InvalidInput(subject + "must be " + std::string(expected) + ", not " + value_.describe());
}

double FieldReader::number(double low, double high) const {
  const double* n = value_.number();
  const bool limited = low != high;
  const bool fits = n != nullptr && std::isfinite(*n) && std::abs(*n) < 1e30 &&
                    (!limited || (*n >= low && *n <= high));
  if (fits) return *n;
  fail(limited ? "a " + range_text(low, high) : "a number");
}

int FieldReader::whole_number(int low, int high) const {
  const double* n = value_.number();
  if (n != nullptr && *n >= low && *n <= high && *n == std::trunc(*n)) return static_cast<int>(*n);
  fail("a whole " + range_text(low, high));
}

bool FieldReader::boolean() const {
  if (const bool* b = value_.boolean()) return *b;
  fail("true or false");
}

const std::string& FieldReader::text() const {
  if (const std::string* t = value_.text()) return *t;
  fail("a text");
}

std::size_t FieldReader::one_of(const std::vector<std::string_view>& names) const {
  if (const std::string* t = value_.text()) {
    const auto found = std::find(names.begin(), names.end(), *t);
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  }
  fail(join_names(names));
}

Vec2f FieldReader::vec2() const {
  if (value_.array() == nullptr || value_.array()->size() != 2) fail("two numbers [x, y]");
  const auto each = items();
  return {coordinate(each[0]), coordinate(each[1])};
}

Vec3f FieldReader::vec3() const {
  if (value_.array() == nullptr || value_.array()->size() != 3) fail("three numbers [x, y, z]");
  const auto each = items();
  return {coordinate(each[0]), coordinate(each[1]), coordinate(each[2])};
}

std::vector<FieldReader> FieldReader::items() const {
  const Value::Array* array = value_.array();
  if (array == nullptr) fail("a list");
  std::vector<FieldReader> out;
  out.reserve(array->size());
  for (std::size_t i = 0; i < array->size(); ++i) {
    out.emplace_back((*array)[i], path_ + "[" + std::to_string(i) + "]");
  }
  return out;
}

FieldReader FieldReader::child(std::string_view name, const Value& value) const {
  const std::string between = path_.empty() || path_.ends_with(": ") ? "" : ".";
  return {value, path_ + between + std::string(name)};
}

FieldReader FieldReader::required(std::string_view name) const {
  if (value_.object() == nullptr) fail("an object with fields");
  const Value* found = value_.find(name);
  return child(name, found != nullptr ? *found : missing_value());
}

bool FieldReader::missing() const { return &value_ == &missing_value(); }

bool FieldReader::has(std::string_view name) const { return value_.find(name) != nullptr; }

void FieldReader::only(const std::vector<std::string_view>& names) const {
  const Value::Object* fields = value_.object();
  if (fields == nullptr) fail("an object with fields");
  for (const auto& [name, value] : *fields) {
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    // A name from the file may hold anything: quoted, so that the sentence stays one line.
    const std::string field = Value(name).describe().substr(sizeof("the text ") - 1);
    throw InvalidInput((path_.ends_with(": ") ? path_ : path_ + ": ") + "there is no field " +
                       field + "; it may be " + (names.empty() ? "none" : join_names(names)));
  }
}

}  // namespace normalshop
