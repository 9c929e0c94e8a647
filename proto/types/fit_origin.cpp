#include "proto/types/fit_origin.hpp"

namespace kinship {

std::string describe(const FitOrigin& origin) {
  std::string words;
  if (origin.from_revision > 0)
    words = "incremental from revision " + std::to_string(origin.from_revision) + ", " +
            std::to_string(origin.new_paths) + " of " + std::to_string(origin.paths) + " paths new";
  else
    words = "full" + (origin.reason.empty() ? "" : " (" + origin.reason + ")") + ", " +
            std::to_string(origin.paths) + " paths";
  if (origin.transferred != origin.new_paths)
    words += ", " + std::to_string(origin.transferred) + " transferred";
  return words;
}

}  // namespace kinship
