#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "normalshop/document/value.h"
#include "normalshop/io/export_maps.h"
#include "normalshop/surface/seam_mismatch.h"

namespace normalshop {

/// Everything that one run of `edit` did.
struct EditJob {
  OpenedDocument opened;
  std::vector<EditReport> edits;
  TransferOptions transfer;
  /// At the seams that the edits crossed: mismatch before, after, and its growth, in degrees.
  SeamMismatch seams_before;
  SeamMismatch seams_after;
  SeamMismatch seams_growth;
  std::vector<std::filesystem::path> files;
  std::vector<std::string> notes;
  std::vector<std::pair<std::string, double>> times;  ///< seconds by stage, in order
};

/// Opens, applies the recipe, writes maps, model and report.json into `folder`. Nothing is written
/// unless every edit succeeds. Throws IoError or InvalidInput.
EditJob run_edit_job(const OpenOptions& open, const Recipe& recipe,
                     const std::filesystem::path& folder, const ExportOptions& options,
                     const TransferOptions& transfer = {});

/// Adds what the user should know of an edit.
void note_edit(const Edit& edit, const EditReport& report, std::vector<std::string>& notes);

/// What each edit of a log did, for reports.
Value edits_value(std::span<const Edit> log, std::span<const EditReport> reports);

/// The content of report.json.
Value report_value(const EditJob& job);

}  // namespace normalshop
