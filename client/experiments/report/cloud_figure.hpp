#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "proto/types/mixture.hpp"
#include "proto/types/scene.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::experiments {

/// From where a scene is looked at.
enum class View {
  Top,  ///< x to the right, y up
  Side  ///< x to the right, z up
};

/// What a cloud figure shows, in the task frame.
struct Cloud {
  Eigen::Matrix3Xd transfer_frames;        ///< origins of sampled configurations, m
  std::vector<Eigen::Matrix3Xd> postures;  ///< joint origins and transfer frame of five of them, m
  Scene scene;
};

/// Draws configurations from a mixture within the limits of the chain. Equal seed, equal cloud.
Cloud draw_cloud(const kinematics::Chain& chain, const Eigen::Isometry3d& T_task_base,
                 const Mixture& mixture, const Scene& scene, std::uint64_t seed);

/// Samples as dots, postures as lines, boxes of the scene as outlines; as SVG.
std::string cloud_figure(const Cloud& cloud, View view, const std::string& title);

inline constexpr int kCloudSamples = 3000;
inline constexpr int kCloudPostures = 5;

}  // namespace kinship::experiments
