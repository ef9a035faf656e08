#include "normalshop/document/value.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <nlohmann/json.hpp>

#include "normalshop/core/error.h"

namespace normalshop {

namespace {

constexpr std::size_t deepest = 100;

/// Builds a Value from nlohmann's events, so that depth and repeated names are checked on the way.
class Builder : public nlohmann::json_sax<nlohmann::json> {
 public:
  explicit Builder(std::string_view name) : name_(name) {}
  Value take() { return std::move(root_); }

  bool null() override { return put({}); }
  bool boolean(bool value) override { return put(value); }
  bool number_integer(number_integer_t value) override { return put(static_cast<double>(value)); }
  bool number_unsigned(number_unsigned_t value) override { return put(static_cast<double>(value)); }
  bool number_float(number_float_t value, const string_t&) override { return put(value); }
  bool string(string_t& value) override { return put(std::move(value)); }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(true); }
  bool end_object() override { return close(); }
  bool start_array(std::size_t) override { return open(false); }
  bool end_array() override { return close(); }
  bool key(string_t& name) override {
    Value::Object& fields = open_.back().fields;
    const auto same = [&](const auto& f) { return f.first == name; };
    if (std::any_of(fields.begin(), fields.end(), same)) {
      throw InvalidInput(name_ + ": the field \"" + name + "\" appears twice");
    }
    fields.emplace_back(std::move(name), Value());
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception& e) override {
    // "[json.exception.parse_error.101] parse error at line 3, column 5: ..." from "line" on.
    const std::string_view what = e.what();
    const std::size_t at = what.find("line");
    throw InvalidInput(name_ + ": not valid JSON" +
                       (at == std::string_view::npos ? "" : ", " + std::string(what.substr(at))));
  }

 private:
  struct Open {
    bool is_object;
    Value::Object fields;
    Value::Array items;
  };
  bool put(Value value) {
    if (open_.empty()) {
      root_ = std::move(value);
    } else if (open_.back().is_object) {
      open_.back().fields.back().second = std::move(value);
    } else {
      open_.back().items.push_back(std::move(value));
    }
    return true;
  }
  bool open(bool is_object) {
    if (open_.size() >= deepest) throw InvalidInput(name_ + ": nested more than 100 levels deep");
    open_.push_back({is_object, {}, {}});
    return true;
  }
  bool close() {
    Open done = std::move(open_.back());
    open_.pop_back();
    return put(done.is_object ? Value(std::move(done.fields)) : Value(std::move(done.items)));
  }

  std::string name_;
  Value root_;
  std::vector<Open> open_;
};

void print_text(const std::string& text, std::string& out) {
  using nlohmann::json;
  out += json(text).dump(-1, ' ', false, json::error_handler_t::replace);
}

void print_number(double number, std::string& out) {
  if (!std::isfinite(number)) {
    out += "null";
    return;
  }
  // Floats were floats before they became double: print what reads back as the same float.
  char buffer[40];
  const auto single = static_cast<float>(number);
  const auto end = static_cast<double>(single) == number
                       ? std::to_chars(buffer, buffer + sizeof(buffer), single)
                       : std::to_chars(buffer, buffer + sizeof(buffer), number);
  out.append(buffer, end.ptr);
}

bool is_flat(const Value& value) { return value.array() == nullptr && value.object() == nullptr; }

void print(const Value& value, int depth, std::string& out) {
  const auto line = [&](int d) { out += "\n" + std::string(static_cast<std::size_t>(2 * d), ' '); };
  if (const bool* b = value.boolean()) {
    out += *b ? "true" : "false";
  } else if (const double* number = value.number()) {
    print_number(*number, out);
  } else if (const std::string* text = value.text()) {
    print_text(*text, out);
  } else if (const Value::Array* items = value.array()) {
    const bool flat = std::all_of(items->begin(), items->end(), is_flat);
    out += "[";
    for (std::size_t i = 0; i < items->size(); ++i) {
      if (i > 0) out += flat ? ", " : ",";
      if (!flat) line(depth + 1);
      print((*items)[i], depth + 1, out);
    }
    if (!flat) line(depth);
    out += "]";
  } else if (const Value::Object* fields = value.object()) {
    out += "{";
    for (std::size_t i = 0; i < fields->size(); ++i) {
      if (i > 0) out += ",";
      line(depth + 1);
      print_text((*fields)[i].first, out);
      out += ": ";
      print((*fields)[i].second, depth + 1, out);
    }
    if (!fields->empty()) line(depth);
    out += "}";
  } else {
    out += "null";
  }
}

}  // namespace

const Value* Value::find(std::string_view name) const {
  const Object* fields = object();
  if (fields == nullptr) return nullptr;
  for (const auto& [key, value] : *fields) {
    if (key == name) return &value;
  }
  return nullptr;
}

std::string Value::describe() const {
  if (const bool* b = boolean()) return *b ? "true" : "false";
  if (const double* n = number()) {
    std::string out = "the number ";
    print_number(*n, out);
    return out;
  }
  if (const std::string* t = text()) {
    std::string out;
    print_text(t->size() <= 60 ? *t : t->substr(0, 60) + "...", out);
    return "the text " + out;
  }
  if (const Array* a = array()) return "a list of " + std::to_string(a->size());
  if (object() != nullptr) return "an object";
  return "null";
}

Value parse_json(std::string_view text, std::string_view name) {
  Builder builder(name);
  if (!nlohmann::json::sax_parse(text, &builder)) {
    throw InvalidInput(std::string(name) + ": not valid JSON");
  }
  return builder.take();
}

std::string to_json(const Value& value) {
  std::string out;
  print(value, 0, out);
  return out + "\n";
}

}  // namespace normalshop
