#pragma once

#include <span>
#include <string_view>

namespace kinship::experiments {

/// A file of the source tree or of Debian that the program carries.
struct EmbeddedText {
  std::string_view name;  ///< of the file, without folder
  std::string_view text;
};

/// Written while building (cmake/embed_texts.cmake).
std::span<const EmbeddedText> embedded_texts();

}  // namespace kinship::experiments
