#pragma once

#include <span>
#include <string_view>

namespace kinship::page {

/// A file of the source tree or of Debian that a program carries (kinship_embed_texts in cmake).
struct EmbeddedText {
  std::string_view name;  ///< of the file, without folder
  std::string_view text;
};

/// \throws std::logic_error if none has that name.
std::string_view text_of(std::span<const EmbeddedText> texts, std::string_view name);

/// This room's own and Debian's. Written while building.
std::span<const EmbeddedText> embedded_texts();

}  // namespace kinship::page
