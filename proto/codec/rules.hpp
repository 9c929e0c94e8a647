#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <string_view>

#include "proto/types/failure.hpp"

namespace kinship::codec {

/// Applies rules to the members of a value, one after the other, and remembers the first that is
/// broken. Messages name the thing, its value and the limit.
class Rules {
 public:
  /// \param error  of a check from proto/types/names.hpp.
  Rules& name(const std::optional<Error>& error);
  Rules& text(std::string_view what, std::string_view value, std::size_t limit);
  Rules& not_empty(std::string_view what, std::string_view value);
  Rules& between(std::string_view what, double value, double lowest, double highest);
  Rules& finite(std::string_view what, double value);
  Rules& not_negative(std::string_view what, double value);                     ///< and finite
  Rules& at_most(std::string_view what, std::size_t value, std::size_t limit);  ///< else TooLarge
  Rules& pose(std::string_view what, const Eigen::Isometry3d& T);
  Rules& that(bool holds, std::string_view message);

  /// The first broken rule.
  const std::optional<Error>& broken() const noexcept { return broken_; }

 private:
  void breaks(ErrorCode code, std::string message);

  std::optional<Error> broken_;
};

}  // namespace kinship::codec
