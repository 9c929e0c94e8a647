#include "proto/types/profile.hpp"

namespace kinship {

std::optional<Profile> find_profile(std::string_view name) {
  if (name == "default")
    return Profile{};
  if (name == "paper") {
    Profile paper;
    paper.name = "paper";
    paper.transfer = {.pose_spacing = 0.1,  // every vertex at the planner's step
                      .max_poses_per_path = 0,
                      .max_solutions = 5,
                      .min_distance = 0.5,
                      .dropped_end_share = 0,
                      .tracks = 0,
                      .avoid_self_collision = false,
                      .avoid_recorded_scene = false};
    paper.density = {.components = 50,
                     .covariance_floor = 1e-4,
                     .equal_path_weights = false,
                     .weighting = Weighting::Paths,
                     .warm_refits = false,
                     .prior = 0};
    paper.recommended_share = 1;
    paper.thin_share = 1;
    return paper;
  }
  return std::nullopt;
}

}  // namespace kinship
