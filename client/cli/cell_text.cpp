#include "client/cli/cell_text.hpp"

#include <algorithm>
#include <chrono>
#include <iomanip>
#include <sstream>

#include "proto/types/pose.hpp"

namespace kinship::cli {

std::string number_text(double value, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

std::string age_text(std::int64_t then_ms, std::int64_t now_ms) {
  if (then_ms <= 0)
    return "-";
  constexpr std::int64_t kMinute_s = 60, kHour_s = 60 * kMinute_s, kDay_s = 24 * kHour_s;
  const std::int64_t age_s = std::max<std::int64_t>(0, now_ms - then_ms) / 1000;
  if (age_s < 2 * kMinute_s)
    return std::to_string(age_s) + "s";
  if (age_s < 2 * kHour_s)
    return std::to_string(age_s / kMinute_s) + "m";
  if (age_s < 2 * kDay_s)
    return std::to_string(age_s / kHour_s) + "h";
  return std::to_string(age_s / kDay_s) + "d";
}

std::int64_t now_ms() {
  const auto since_1970 = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::milliseconds>(since_1970).count();
}

std::string size_text(std::uint64_t bytes) {
  constexpr double kStep = 1000;
  if (bytes < static_cast<std::uint64_t>(kStep))
    return std::to_string(bytes) + " B";
  auto size = static_cast<double>(bytes);
  const char* unit = "";
  for (const char* const next : {"kB", "MB", "GB", "TB"})
    if (size >= kStep) {
      size /= kStep;
      unit = next;
    }
  return number_text(size, 1) + " " + unit;
}

std::string percent_text(double part) { return number_text(100 * part, 0) + "%"; }

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names)
    text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::string kept_text(std::uint64_t kept, std::uint64_t dropped) {
  return std::to_string(kept) + (dropped > 0 ? " of " + std::to_string(kept + dropped) : "");
}

std::string count_text(std::uint64_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

std::string pose_text(const Eigen::Isometry3d& T_a_b) {
  constexpr int kDigits = 4;
  std::string text;
  for (const double number : to_pose_array(T_a_b))
    text += (text.empty() ? "" : " ") + number_text(number, kDigits);
  return text;
}

std::string short_pose_text(const Eigen::Isometry3d& T_a_b) {
  std::istringstream numbers(pose_text(T_a_b));
  std::string text;
  for (std::string number; numbers >> number;) {
    number.erase(number.find_last_not_of('0') + 1);
    if (number.ends_with('.'))
      number.pop_back();
    text += (text.empty() ? "" : " ") + (number == "-0" ? "0" : number);
  }
  return text;
}

}  // namespace kinship::cli
