#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "proto/json/format.hpp"

/// Pieces of the documents that this library writes; for its sources only. Objects keep the order
/// in which their members were added.
namespace kinship::json {

using OrderedJson = nlohmann::ordered_json;

OrderedJson list(const Eigen::Ref<const Eigen::VectorXd>& numbers);
OrderedJson list_of_columns(const Eigen::Ref<const Eigen::MatrixXd>& matrix);
OrderedJson pose_list(const Eigen::Isometry3d& T_a_b);  ///< [x, y, z, qx, qy, qz, qw]
OrderedJson pose_or_null(const std::optional<Eigen::Isometry3d>& T_a_b);

/// One line of text. Bytes that are not UTF-8 become U+FFFD, numbers that are not finite null.
std::string write(const OrderedJson& document);

/// The same of a whole document, an object that gets its format as the first member.
std::string write(const Format& format, const OrderedJson& object);

}  // namespace kinship::json
