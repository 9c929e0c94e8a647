#pragma once

#include <memory>
#include <string>

#include "proto/types/result.hpp"

namespace urdf {
class Joint;
class ModelInterface;
}  // namespace urdf

namespace kinship::kinematics {

/// A parsed URDF; include <urdf_model/model.h> to look inside.
struct UrdfModel {
  std::shared_ptr<const urdf::ModelInterface> tree = nullptr;  ///< null: not parsed
  std::string complaints = {};  ///< the parser's messages on parts that it left out of the tree
};

/// Parses URDF text from outside with urdfdom, without output and without throwing.
/// \return a model whose links form one tree and whose names have at most kMaxLinkNameBytes;
///         InvalidInput or TooLarge with the parser's own message otherwise.
Result<UrdfModel> parse_urdf(const std::string& text);

/// Why a joint that moves can be no joint of a robot, e.g. crossed limits; empty if it can.
/// \param model  of the joint
std::string find_joint_fault(const urdf::ModelInterface& model, const urdf::Joint& joint);

}  // namespace kinship::kinematics
