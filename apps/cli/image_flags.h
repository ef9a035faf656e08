#pragma once

#include <optional>
#include <string>

#include "arguments.h"

#include "normalshop/io/image_job.h"

namespace normalshop::cli {

/// "8", "16", "32", or "": nothing.
std::optional<CodeType> code_type(const std::string& bits);
/// None for "". Throws WrongUse unless it is 0 to 1.
std::optional<float> read_roughness(const std::string& text);

/// Flags of the verbs that work on a picture with normals.
struct ImageFlags {
  OpenImageOptions files;  ///< normals and colour are added by the verb
  std::string green;
  std::string edges;
  std::string bits;

  /// --mask, --edges.
  void add(Verb& verb);
  void add_green(Verb& verb);  ///< `edit` has it from models, and so it has --bits
  void add_bits(Verb& verb);
  OpenImageOptions open() const;
};

}  // namespace normalshop::cli
