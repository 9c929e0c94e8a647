#include "robots/planning/is_free.hpp"

namespace kinship::planning {
namespace {

auto calls(std::function<void()> before) {
  return [before = std::move(before)] {
    if (before)
      before();
  };
}

}  // namespace

IsFree free_in(collision::CollisionWorld& world, std::function<void()> before) {
  const auto prepare = calls(std::move(before));
  return {[&world, prepare](const Eigen::VectorXd& q) {
            prepare();
            return !world.collides(q);
          },
          [&world, prepare](const Eigen::Ref<const Eigen::MatrixXd>& qs) {
            prepare();
            return world.free_ahead(qs);
          },
          [&world, prepare](const Eigen::Ref<const Eigen::MatrixXd>& qs) {
            prepare();
            return world.colliding_ahead(qs);
          }};
}

IsFree proven_in(collision::EdgeProver& prover, const collision::EdgeProofOptions& options,
                 std::function<void()> before) {
  const auto prepare = calls(std::move(before));
  return {[&prover, options, prepare](const Eigen::VectorXd& q) {
            prepare();
            return prover.clear_ahead(q, options) == 1;
          },
          [&prover, options, prepare](const Eigen::Ref<const Eigen::MatrixXd>& qs) {
            prepare();
            return prover.clear_ahead(qs, options);
          },
          [&prover, options, prepare](const Eigen::Ref<const Eigen::MatrixXd>& qs) {
            prepare();
            return prover.near_ahead(qs, options);
          },
          [&prover, options, prepare](const Eigen::Ref<const Eigen::MatrixXd>& from,
                                      const Eigen::Ref<const Eigen::MatrixXd>& to) {
            prepare();
            IsFree::Lines lines;
            for (const collision::EdgeProof& proof : prover.prove_all(from, to, options))
              lines.push_back(proof.is_free());
            return lines;
          },
          [&prover, options, prepare](const Eigen::Ref<const Eigen::MatrixXd>& qs) {
            prepare();
            return prover.are_clear(qs, options);
          }};
}

}  // namespace kinship::planning
