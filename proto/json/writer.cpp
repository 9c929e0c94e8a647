#include "proto/json/writer.hpp"

#include <nlohmann/json.hpp>

#include "proto/types/pose.hpp"

namespace kinship::json {

OrderedJson list(const Eigen::Ref<const Eigen::VectorXd>& numbers) {
  OrderedJson array = OrderedJson::array();
  for (const double number : numbers)
    array.push_back(number);
  return array;
}

OrderedJson list_of_columns(const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
  OrderedJson array = OrderedJson::array();
  for (Eigen::Index column = 0; column < matrix.cols(); ++column)
    array.push_back(list(matrix.col(column)));
  return array;
}

OrderedJson pose_list(const Eigen::Isometry3d& T_a_b) { return to_pose_array(T_a_b); }

OrderedJson pose_or_null(const std::optional<Eigen::Isometry3d>& T_a_b) {
  return T_a_b ? pose_list(*T_a_b) : OrderedJson(nullptr);
}

std::string write(const OrderedJson& document) {
  constexpr int kOneLine = -1;
  return document.dump(kOneLine, ' ', false, OrderedJson::error_handler_t::replace);
}

std::string write(const Format& format, const OrderedJson& object) {
  return in_format(format, write(object));
}

}  // namespace kinship::json
