#pragma once

#include <string>

namespace kinship {

/// The shortest decimal text that reads back as the same number, in any locale: "0.1", "1e-07".
std::string number_text(double value);

}  // namespace kinship
