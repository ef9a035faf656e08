#pragma once

#include <string>
#include <vector>

#include "arguments.h"

#include "normalshop/io/open_document.h"

namespace normalshop::cli {

/// Flags of every verb that opens a model.
class ModelFlags {
 public:
  /// Returns the model's place, which the verb may require.
  Argument add(Verb& verb, const std::string& help = "glTF, GLB or OBJ file");
  OpenOptions options() const;

 private:
  OpenOptions options_;
  std::string space_;
  std::string green_;
};

/// "1,2.5,-3" as a vector. Throws WrongUse naming the flag.
Vec3f parse_vector(const std::string& text, const std::string& flag);
/// A NamedView's name or a direction towards the viewer. Throws WrongUse otherwise.
ViewSpec parse_view(const std::string& text);

/// Prints notes to standard error, where they don't disturb what another program reads.
void print_notes(const std::vector<std::string>& notes);

}  // namespace normalshop::cli
