#pragma once

#include <span>

#include "pages/page/embedded_text.hpp"

namespace kinship::console {

/// The files in app/. Written while building (cmake/embed_texts.cmake).
std::span<const page::EmbeddedText> app_texts();

}  // namespace kinship::console
