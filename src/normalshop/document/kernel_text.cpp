#include "normalshop/document/kernel_text.h"

#include "normalshop/core/error.h"
#include "normalshop/document/field_reader.h"

namespace normalshop {

namespace {

constexpr std::size_t longest_side = 255;
constexpr double largest_weight = 1e6;

bool is_side(std::size_t size) { return size % 2 == 1 && size <= longest_side; }

std::vector<float> parse_row(const FieldReader& row) {
  if (row.value().array() == nullptr) row.fail("a list of numbers");
  std::vector<float> weights;
  for (std::size_t i = 0; i < row.value().array()->size(); ++i) {
    const FieldReader weight(row.value().array()->at(i),
                             row.path() + ", number " + std::to_string(i + 1));
    weights.push_back(static_cast<float>(weight.number(-largest_weight, largest_weight)));
  }
  return weights;
}

}  // namespace

Image<float> parse_kernel(std::string_view json, std::string_view file) {
  const Value root = parse_json(json, file);
  const std::string name(file);
  if (root.array() == nullptr) FieldReader(root, name + ": ").fail("a list of rows of numbers");
  const Value::Array& rows = *root.array();
  if (!is_side(rows.size())) {
    throw InvalidInput(name + ": the kernel must have an odd number of rows, at most 255, not " +
                       std::to_string(rows.size()));
  }
  Image<float> kernel;
  for (std::size_t y = 0; y < rows.size(); ++y) {
    const std::string path = name + ": row " + std::to_string(y + 1);
    const std::vector<float> weights = parse_row(FieldReader(rows[y], path));
    if (y == 0) {
      if (!is_side(weights.size())) {
        throw InvalidInput(path + " must have an odd number of numbers, at most 255, not " +
                           std::to_string(weights.size()));
      }
      kernel.resize(static_cast<int>(weights.size()), static_cast<int>(rows.size()));
    }
    if (weights.size() != static_cast<std::size_t>(kernel.width())) {
      throw InvalidInput(path + " must have as many numbers as the first row, " +
                         std::to_string(kernel.width()) + ", not " +
                         std::to_string(weights.size()));
    }
    std::copy(weights.begin(), weights.end(), kernel.row(static_cast<int>(y)));
  }
  return kernel;
}

}  // namespace normalshop
