#pragma once

#include <cstdint>
#include <filesystem>

#include "normalshop/document/store/database.h"

namespace normalshop {

/// "NSHP", at byte 68 of every document: what tells it from other SQLite files.
inline constexpr std::int32_t document_application_id = 0x4E534850;
/// The schema that this program writes; older ones are brought up to it when they are opened.
int document_version();

/// From the first bytes alone. False for files that are missing or unreadable, too.
bool is_document_file(const std::filesystem::path& path);
/// Throws DocumentError, from the first bytes of the file alone, unless it is a whole document.
void check_document_file(const std::filesystem::path& path);

/// Makes the tables in an empty file.
void create_schema(const Database& database);
/// Brings an older document up to date, all or nothing. Throws DocumentError for a newer one,
/// naming the program that wrote it, and for an older one that is write-protected.
void migrate(const Database& database);

}  // namespace normalshop
