#include "normalshop/document/field_reader.h"

#include <algorithm>
#include <cmath>

#include "normalshop/core/error.h"

namespace normalshop {

namespace {

std::string plain(double number) {
  const std::string text = to_json(Value(number));
  return text.substr(0, text.size() - 1);
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
  throw InvalidInput(path_ + ": must be " + std::string(expected) + ", not " + value_.describe());
}

double FieldReader::number(double low, double high) const {
  const double* n = value_.number();
  const bool limited = low != high;
  const bool fits = n != nullptr && std::isfinite(*n) && std::abs(*n) < 1e30 &&
                    (!limited || (*n >= low && *n <= high));
  if (fits) return *n;
  fail(limited ? "a number from " + plain(low) + " to " + plain(high) : "a finite number");
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
  return {static_cast<float>(each[0].number()), static_cast<float>(each[1].number())};
}

Vec3f FieldReader::vec3() const {
  if (value_.array() == nullptr || value_.array()->size() != 3) fail("three numbers [x, y, z]");
  const auto each = items();
  return {static_cast<float>(each[0].number()), static_cast<float>(each[1].number()),
          static_cast<float>(each[2].number())};
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
  if (const Value* found = value_.find(name)) return child(name, *found);
  static const Value missing;
  throw InvalidInput(child(name, missing).path() + ": this field is missing");
}

bool FieldReader::has(std::string_view name) const { return value_.find(name) != nullptr; }

void FieldReader::only(const std::vector<std::string_view>& names) const {
  const Value::Object* fields = value_.object();
  if (fields == nullptr) fail("an object with fields");
  for (const auto& [name, value] : *fields) {
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    throw InvalidInput(child(name, value).path() + ": there is no such field; accepted: " +
                       (names.empty() ? "none" : join_names(names)));
  }
}

}  // namespace normalshop
