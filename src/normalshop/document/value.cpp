#include "normalshop/document/value.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <unordered_set>

#include <nlohmann/json.hpp>

#include "normalshop/core/error.h"

namespace normalshop {

namespace {

constexpr std::size_t deepest = 100;

/// Walks over a text and leaves its place where messages can find it.
class Cursor {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  Cursor(const char* at, const char*& place) : at_(at), place_(&place) {}
  reference operator*() const { return *at_; }
  Cursor& operator++() {
    *place_ = ++at_;
    return *this;
  }
  Cursor operator++(int) {
    const Cursor before = *this;
    ++*this;
    return before;
  }
  bool operator==(const Cursor& other) const { return at_ == other.at_; }

 private:
  const char* at_;
  const char** place_;
};

/// Printable ASCII of a text that may be anything, cut to a length that a sentence can hold.
std::string readable(std::string_view text) {
  constexpr std::size_t longest = 160;
  std::string out;
  for (const char c : text.substr(0, longest)) out += c >= ' ' && c <= '~' ? c : '?';
  return text.size() > longest ? out + "..." : out;
}

/// Builds a Value from nlohmann's events, so that depth and repeated names are checked on the way.
class Builder : public nlohmann::json_sax<nlohmann::json> {
 public:
  Builder(std::string_view text, std::string_view name)
      : text_(text), place_(text.data()), name_(name) {}
  Cursor begin() { return {text_.data(), place_}; }
  Cursor end() { return {text_.data() + text_.size(), place_}; }
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
    Open& object = open_.back();
    if (!object.names.insert(name).second) {
      fail("the field \"" + readable(name) + "\" appears twice in one object");
    }
    object.fields.emplace_back(std::move(name), Value());
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception& e) override {
    // "[json.exception.parse_error.101] parse error at line 3, column 5: syntax error while parsing
    // value - invalid literal; last read: 'x'": the part behind the first place names the fault.
    std::string_view what = e.what();
    for (const std::string_view mark : {"] ", "column ", ": ", " - "}) {
      const std::size_t at = what.find(mark);
      if (at != std::string_view::npos) what.remove_prefix(at + mark.size());
    }
    fail("not valid JSON: " + readable(what));
  }

 private:
  struct Open {
    bool is_object;
    Value::Object fields;
    Value::Array items;
    std::unordered_set<std::string> names;
  };
  [[noreturn]] void fail(const std::string& what) const {
    const auto line = 1 + std::count(text_.data(), place_, '\n');
    throw InvalidInput(name_ + ": line " + std::to_string(line) + ": " + what);
  }
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
    if (open_.size() >= deepest) fail("nested more than 100 levels deep");
    open_.push_back({is_object, {}, {}, {}});
    return true;
  }
  bool close() {
    Open done = std::move(open_.back());
    open_.pop_back();
    return put(done.is_object ? Value(std::move(done.fields)) : Value(std::move(done.items)));
  }

  std::string_view text_;
  const char* place_;  ///< just read
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
  std::array<char, 40> buffer;
  if (std::abs(number) < 1e15 && number == std::trunc(number)) {  // 1000000, not 1e+06
    const auto whole = static_cast<std::int64_t>(number);
    out.append(buffer.data(), std::to_chars(buffer.begin(), buffer.end(), whole).ptr);
    return;
  }
  // Floats were floats before they became double: print what reads back as the same float.
  const auto single = static_cast<float>(std::clamp(number, -3.4e38, 3.4e38));
  const auto end = static_cast<double>(single) == number
                       ? std::to_chars(buffer.begin(), buffer.end(), single)
                       : std::to_chars(buffer.begin(), buffer.end(), number);
  out.append(buffer.data(), end.ptr);
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
    // Cut between characters, not within one.
    std::size_t length = std::min<std::size_t>(t->size(), 60);
    while (length < t->size() && length > 0 &&
           (static_cast<unsigned char>((*t)[length]) & 0xC0U) == 0x80U)
      --length;
    std::string out;
    print_text(length == t->size() ? *t : t->substr(0, length) + "...", out);
    return "the text " + out;
  }
  if (const Array* a = array()) return "a list of " + std::to_string(a->size());
  if (object() != nullptr) return "an object";
  return "null";
}

Value parse_json(std::string_view text, std::string_view name) {
  Builder builder(text, name);
  if (!nlohmann::json::sax_parse(builder.begin(), builder.end(), &builder)) {
    throw InvalidInput(std::string(name) + ": not valid JSON");
  }
  return builder.take();
}

std::string to_json(const Value& value) { return to_line(value) + "\n"; }

std::string to_line(const Value& value) {
  std::string out;
  print(value, 0, out);
  return out;
}

Value with_field(const Value& value, std::string_view path, const Value& field) {
  const std::size_t dot = path.find('.');
  const std::string name(path.substr(0, dot));
  if (!value.is_null() && value.object() == nullptr) {
    throw InvalidInput("'" + name + "' cannot be a field of " + value.describe());
  }
  Value::Object fields = value.object() != nullptr ? *value.object() : Value::Object();
  auto found =
      std::find_if(fields.begin(), fields.end(), [&](const auto& f) { return f.first == name; });
  if (found == fields.end()) found = fields.insert(fields.end(), {name, Value()});
  found->second = dot == std::string_view::npos
                      ? field
                      : with_field(found->second, path.substr(dot + 1), field);
  return fields;
}

}  // namespace normalshop
