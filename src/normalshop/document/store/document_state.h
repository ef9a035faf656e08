#pragma once

#include "normalshop/document/document_file.h"
#include "normalshop/document/store/database.h"
#include "normalshop/document/store/stored_files.h"
#include "normalshop/document/store/stored_history.h"

namespace normalshop {

/// What a DocumentFile is made of.
struct DocumentFile::State {
  explicit State(const std::filesystem::path& path)
      : database(path), files(database), history(database) {}

  Database database;
  StoredFiles files;
  StoredHistory history;
};

}  // namespace normalshop
