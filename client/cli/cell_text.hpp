#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

namespace kinship::cli {

/// With `digits` behind the point.
std::string number_text(double value, int digits);

/// How long ago, in one unit: "12s", "5m", "3h", "14d"; "-" for never (0).
std::string age_text(std::int64_t then_ms, std::int64_t now_ms);

std::int64_t now_ms();  ///< Unix time, UTC

std::string size_text(std::uint64_t bytes);  ///< "512 B", "1.2 kB", "3.4 GB", powers of 1000

std::string percent_text(double part);  ///< 0.25: "25%"

/// "1 path", "6 paths", "0 paths".
std::string count_text(std::uint64_t count, const std::string& noun);

/// "a, b".
std::string listed(const std::vector<std::string>& names);

/// "20000 of 35012" where a cap left some out, else the number alone.
std::string kept_text(std::uint64_t kept, std::uint64_t dropped);

std::string pose_text(const Eigen::Isometry3d& T_a_b);  ///< x y z qx qy qz qw

/// The same without zeros at the end, as --placement takes it: "0.5 0 0 0 0 0 1".
std::string short_pose_text(const Eigen::Isometry3d& T_a_b);

}  // namespace kinship::cli
