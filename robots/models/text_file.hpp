#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace kinship::models {

/// The whole text of a file of at most `max_bytes`.
/// \throws Failure(NotFound, InvalidInput or TooLarge) that names the file.
std::string read_text(const std::filesystem::path& file, std::size_t max_bytes);

}  // namespace kinship::models
