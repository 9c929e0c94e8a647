#include "proto/types/rules.hpp"

#include <cmath>

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"
#include "proto/types/number_text.hpp"
#include "proto/types/pose.hpp"

namespace kinship {

void Rules::breaks(ErrorCode code, const std::string& message) {
  if (!broken_)  // it may quote text from outside
    broken_ = Error{code, cut_text(message, kMaxMessageBytes)};
}

Rules& Rules::name(const std::optional<Error>& error) {
  if (error)
    breaks(error->code, error->message);
  return *this;
}

Rules& Rules::text(std::string_view what, std::string_view value, std::size_t limit) {
  return name(check_text(what, value, limit));
}

Rules& Rules::not_empty(std::string_view what, std::string_view value) {
  if (value.empty())
    breaks(ErrorCode::InvalidInput, std::string(what) + ": is empty");
  return *this;
}

Rules& Rules::between(std::string_view what, double value, double lowest, double highest) {
  if (!(value >= lowest && value <= highest))  // so that NaN breaks it
    breaks(ErrorCode::InvalidInput, std::string(what) + ": " + number_text(value) +
                                        " is not between " + number_text(lowest) + " and " +
                                        number_text(highest));
  return *this;
}

Rules& Rules::finite(std::string_view what, double value) {
  if (!std::isfinite(value))
    breaks(ErrorCode::InvalidInput,
           std::string(what) + ": " + number_text(value) + " is not finite");
  return *this;
}

Rules& Rules::not_negative(std::string_view what, double value) {
  finite(what, value);
  if (value < 0)
    breaks(ErrorCode::InvalidInput, std::string(what) + ": " + number_text(value) + " is negative");
  return *this;
}

Rules& Rules::number(std::string_view what, double value, const FieldRules& limits) {
  constexpr FieldRules kNone;
  if (limits.max < kNone.max)
    return between(what, value, limits.min, limits.max);
  if (limits.min == 0)
    return not_negative(what, value);
  finite(what, value);
  if (value < limits.min)
    breaks(ErrorCode::InvalidInput, std::string(what) + ": " + number_text(value) +
                                        " is less than " + number_text(limits.min));
  return *this;
}

Rules& Rules::at_most(std::string_view what, std::size_t value, std::size_t limit) {
  if (value > limit)
    breaks(ErrorCode::TooLarge,
           std::string(what) + ": " + std::to_string(value) + " exceeds " + std::to_string(limit));
  return *this;
}

Rules& Rules::pose(std::string_view what, const Eigen::Isometry3d& T) {
  const auto checked = from_pose_array(to_pose_array(T));
  if (!checked)
    breaks(checked.error().code, std::string(what) + ": " + checked.error().message);
  return *this;
}

Rules& Rules::that(bool holds, std::string_view message) {
  if (!holds)
    breaks(ErrorCode::InvalidInput, std::string(message));
  return *this;
}

}  // namespace kinship
