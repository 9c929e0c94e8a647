#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include "proto/types/failure.hpp"
#include "proto/types/field.hpp"
#include "proto/types/names.hpp"

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
  Rules& not_negative(std::string_view what, double value);  ///< and finite
  /// The limits of a number, which is finite.
  Rules& number(std::string_view what, double value, const FieldRules& limits);
  Rules& at_most(std::string_view what, std::size_t value, std::size_t limit);  ///< else TooLarge
  Rules& pose(std::string_view what, const Eigen::Isometry3d& T);
  Rules& that(bool holds, std::string_view message);

  /// The first broken rule.
  const std::optional<Error>& broken() const noexcept { return broken_; }

 private:
  void breaks(ErrorCode code, const std::string& message);

  std::optional<Error> broken_;
};

template <Described Value>
void check_fields(const Value& value, Rules& rules, const std::string& of = "");

/// Checks the limits of each field of a table, and of each element of a list.
/// \param of  after its name in messages, e.g. " of a source".
template <const auto& kTable, typename Value>
void check_members(const Value& value, Rules& rules, const std::string& of = "") {
  static_assert(limits_listed_texts(kTable), "a list of texts without element_limit");
  for_each_field(kTable, [&]<typename Of, typename T>(const Field<Of, T>& field) {
    const auto what = [&] { return std::string(field.name) + of; };
    const FieldRules& limits = field.rules;
    if constexpr (std::is_same_v<T, std::string>) {
      rules.name(limits.check ? limits.check(value.*field.member)
                              : check_text(what(), value.*field.member, limits.limit));
    } else if constexpr (kIsDuration<T>) {
      if (!limits.is_clamped)
        rules.between(what(), static_cast<double>((value.*field.member).count()), limits.min,
                      limits.max);
    } else if constexpr (std::is_same_v<T, std::optional<Eigen::Isometry3d>>) {
      if (value.*field.member)
        rules.pose(what(), *(value.*field.member));
    } else if constexpr (std::is_arithmetic_v<T>) {
      if (std::is_floating_point_v<T> || limits.has_bounds())
        rules.number(what(), static_cast<double>(value.*field.member), limits);
    } else if constexpr (kIsMap<T>) {
      rules.at_most(what(), (value.*field.member).size(), limits.limit);
    } else if constexpr (kIsList<T>) {
      rules.at_most(what(), (value.*field.member).size(), limits.limit);
      for (const auto& element : value.*field.member)
        if constexpr (std::is_same_v<T, std::vector<std::string>>)
          rules.text(what(), element, limits.element_limit);
        else if constexpr (Described<typename T::value_type>)
          check_fields(element, rules, " of " + what());
    }
  });
}

/// The same of all fields of a value.
template <Described Value>
void check_fields(const Value& value, Rules& rules, const std::string& of) {
  check_members<kFieldsOf<Value>>(value, rules, of);
}

}  // namespace kinship
