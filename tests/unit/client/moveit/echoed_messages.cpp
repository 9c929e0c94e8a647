#include "tests/unit/client/moveit/echoed_messages.hpp"
#include "tests/support/places.hpp"

namespace kinship::moveit::conversion_test {

const models::LoadedRobot& panda() {
  static const models::LoadedRobot robot =
      models::load_robot({.source = test::source_dir() + "/robots/models/panda"}).value_or_throw();
  return robot;
}

}  // namespace kinship::moveit::conversion_test
