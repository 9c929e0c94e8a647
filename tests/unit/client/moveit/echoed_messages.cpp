#include "tests/unit/client/moveit/echoed_messages.hpp"

namespace kinship::moveit::conversion_test {

const models::LoadedRobot& panda() {
  static const models::LoadedRobot robot =
      models::load_robot({.source = std::string(KINSHIP_SOURCE_DIR) + "/robots/models/panda"})
          .value_or_throw();
  return robot;
}

}  // namespace kinship::moveit::conversion_test
