#pragma once

#include <chrono>
#include <cstdint>

#include "tests/unit/server/service/service_fixture.hpp"

namespace kinship::service {

/// A service with a teacher, whose catalog is asked.
class CatalogTest : public ServiceFixture {
 protected:
  void teach(int paths, std::uint64_t first_seed = 1) {
    report(fleet::solved(teacher_, "shelf", paths, first_seed));
  }
  /// Another distribution of the same robot.
  static FetchRequest elsewhere(FetchRequest request, double x_m) {
    request.T_task_base = Eigen::Isometry3d(Eigen::Translation3d(x_m, 0, 0));
    return request;
  }
  static FetchRequest at_once(FetchRequest request) {
    request.deadline = std::chrono::milliseconds(0);
    return request;
  }
  static FetchRequest with_generation(FetchRequest request, std::uint64_t generation) {
    request.minimum_generation = generation;
    return request;
  }
  /// Returns when the short task pool has done what it was given before.
  void wait_for_short_tasks() { administer(fleet::question(AdminVerb::ListTasks)); }
};

}  // namespace kinship::service
