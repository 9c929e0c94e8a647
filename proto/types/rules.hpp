#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include "proto/types/failure.hpp"
#include "proto/types/field.hpp"

namespace kinship {

/// Applies rules to the members of a value, one after the other, and records the first that is
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
  void breaks(ErrorCode code, const std::string& message);

  std::optional<Error> broken_;
};

/// Checks the limits of each field, and of the fields of each element of a list.
/// \param of  after its name in messages, e.g. " of a source".
template <Described Value>
void check_fields(const Value& value, Rules& rules, const std::string& of = "") {
  for_each_field<Value>([&]<typename Of, typename T>(const Field<Of, T>& field) {
    const auto what = [&] { return std::string(field.name) + of; };
    const FieldRules& limits = field.rules;
    if constexpr (std::is_same_v<T, std::string>) {
      rules.text(what(), value.*field.member, limits.limit);
      if (limits.check)
        rules.name(limits.check(value.*field.member));
    } else if constexpr (std::is_floating_point_v<T>) {
      if (limits.max < std::numeric_limits<T>::max())
        rules.between(what(), value.*field.member, limits.min, limits.max);
      else if (limits.min == 0)
        rules.not_negative(what(), value.*field.member);
      else
        rules.finite(what(), value.*field.member);
    } else if constexpr (kIsList<T>) {
      rules.at_most(what(), (value.*field.member).size(), limits.limit);
      for (const auto& element : value.*field.member)
        check_fields(element, rules, " of " + what());
    }
  });
}

}  // namespace kinship
