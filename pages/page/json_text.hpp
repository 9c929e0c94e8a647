#pragma once

#include <Eigen/Core>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pages/page/bones.hpp"
#include "proto/types/scene.hpp"

/// Parts of the JSON document that a page's scripts read. Lengths are whole millimetres, which is
/// finer than a pixel and a third of the text.
namespace kinship::page {

/// A JSON string.
std::string json_string(std::string_view text);

/// Eight digits; null for values that JSON lacks.
std::string number(double value);

/// Every value as a whole number of `1 / scale`, column after column: [x, y, z, x, ...].
std::string whole(const Eigen::Ref<const Eigen::MatrixXd>& values, double scale);

/// Lengths in m as whole millimetres, column after column.
std::string millimetres(const Eigen::Ref<const Eigen::MatrixXd>& lengths_m);

/// A list of the results of `each_to_json` for the values.
template <typename Values, typename ToJson>
std::string list(const Values& values, const ToJson& each_to_json) {
  std::string json = "[";
  for (const auto& value : values)
    json.append(json.size() > 1 ? "," : "").append(each_to_json(value));
  return json + "]";
}

/// A JSON object of members that are JSON themselves.
std::string object(std::initializer_list<std::pair<std::string_view, std::string>> members);

/// A solid for view.js: {"name", "pose": [7], "box" | "cylinder" | "capsule" | "sphere"}, and
/// "approximate" if it is fitted around a mesh.
std::string json_of(const SceneObject& object);
std::string json_of(const std::vector<SceneObject>& objects);

/// An arm for view.js: [[x, y, z, x, y, z, radius], ...].
std::string json_of(const std::vector<Bone>& bones);

}  // namespace kinship::page
