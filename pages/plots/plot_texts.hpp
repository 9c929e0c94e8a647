#pragma once

#include <span>

#include "pages/page/embedded_text.hpp"

namespace kinship::plots {

/// The files of this room's pages. Written while building (cmake/embed_texts.cmake).
std::span<const page::EmbeddedText> plot_texts();

}  // namespace kinship::plots
