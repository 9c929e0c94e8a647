#pragma once

#include <iosfwd>

#include "client/experiments/page/page_data.hpp"

namespace kinship::experiments {

/// Writes one HTML document that needs nothing else: style, programs (three.js, vega) and data are
/// in it, and it forbids the browser to load anything.
void write_page(const PageData& data, std::ostream& out);

}  // namespace kinship::experiments
