#pragma once

#include <span>

#include "pages/page/embedded_text.hpp"

namespace kinship::results {

/// The page's own files. Written while building.
std::span<const page::EmbeddedText> page_texts();

}  // namespace kinship::results
