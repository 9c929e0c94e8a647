#pragma once

#include "robots/kinematics/chain.hpp"

namespace kinship::test {

/// What a chain is made of, to make another one like it.
inline kinematics::ChainParts parts_of(const kinematics::Chain& chain) {
  kinematics::ChainParts parts;
  parts.base_link = chain.base_link();
  parts.tip_link = chain.tip_link();
  parts.joints = chain.joints();
  parts.T_last_tip = chain.T_last_tip();
  parts.T_tip_transfer = chain.T_tip_transfer();
  parts.task_axes = chain.task_axes();
  parts.links = chain.links();
  parts.mimics = chain.mimics();
  return parts;
}

}  // namespace kinship::test
