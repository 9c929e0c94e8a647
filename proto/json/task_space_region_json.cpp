#include "proto/json/task_space_region_json.hpp"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace kinship::json {
namespace {

constexpr std::size_t kCoordinates = 6;

OrderedJson bound(double value) {
  return std::isfinite(value) ? OrderedJson(value) : OrderedJson(nullptr);
}

Eigen::Matrix<double, 2, 6> read_bounds(const Reader& reader) {
  const auto pairs = reader.elements(kCoordinates);
  if (pairs.size() != kCoordinates)
    reader.refuse(std::to_string(pairs.size()) +
                  " pairs, must be 6: [lower, upper] of x y z roll pitch yaw");
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Eigen::Matrix<double, 2, 6> bounds;
  for (std::size_t i = 0; i < kCoordinates; ++i) {
    const auto pair = pairs[i].elements(2);
    if (pair.size() != 2)
      pairs[i].refuse("must be [lower, upper], null for no bound");
    bounds.col(static_cast<Eigen::Index>(i)) << (pair[0].is_null() ? -kInfinity : pair[0].number()),
        (pair[1].is_null() ? kInfinity : pair[1].number());
  }
  return bounds;
}

}  // namespace

OrderedJson region_object(const TaskSpaceRegion& region) {
  OrderedJson object;
  object["T0_w"] = pose_list(region.T_task_region);
  object["Tw_e"] = pose_list(region.T_region_end);
  OrderedJson bounds = OrderedJson::array();
  for (const auto& pair : region.bounds.colwise())
    bounds.push_back({bound(pair[0]), bound(pair[1])});
  object["Bw"] = std::move(bounds);
  return object;
}

TaskSpaceRegion read_region(const Reader& reader) {
  reader.allow_only({"T0_w", "Tw_e", "Bw"});
  TaskSpaceRegion region;
  region.T_task_region = reader.at("T0_w").pose();
  region.T_region_end = reader.at("Tw_e").pose();
  region.bounds = read_bounds(reader.at("Bw"));
  if (const auto fault = validate(region))
    reader.refuse(*fault);
  return region;
}

}  // namespace kinship::json
