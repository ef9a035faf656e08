#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "arguments.h"

#include "normalshop/document/document.h"
#include "normalshop/io/export_maps.h"

namespace normalshop::cli {

/// Flags of every verb that writes a model's maps.
class ExportFlags {
 public:
  void add(Verb& verb);
  ExportOptions options() const;

 private:
  std::string preset_;
  std::string bits_;
  bool mips_ = false;
  std::string roughness_;
  int roughness_level_ = 1;
};

/// A line for what each edit did.
void print_edits(std::span<const Edit> edits, std::span<const EditReport> reports);
/// A line for each file that was written.
void print_files(std::span<const std::filesystem::path> files);

}  // namespace normalshop::cli
