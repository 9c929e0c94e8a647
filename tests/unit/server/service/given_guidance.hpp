#pragma once

#include <map>
#include <memory>
#include <string>

#include "server/service/served_guidance.hpp"

namespace kinship::service {

/// Guidance with the rehearsals that a test gives it, and nothing in memory.
class GivenGuidance final : public ServedGuidance {
 public:
  std::map<Digest, std::shared_ptr<const Rehearsal>> rehearsed;

  Advice advise(const Distribution& distribution) override { return distribution.advice; }
  std::shared_ptr<const Rehearsal> find_rehearsal(const Digest& id) const override {
    const auto found = rehearsed.find(id);
    return found == rehearsed.end() ? nullptr : found->second;
  }
  std::string trouble_of(const Digest& /*id*/) const override { return {}; }
  void forget_distribution(const Digest& /*id*/) override {}
  void forget_task(const std::string& /*task*/) override {}
  void drop_task(const std::string& /*task*/) override {}
  void new_experience(std::string_view /*task*/) override {}
  void forget_robot(const Digest& /*robot*/) override {}
};

}  // namespace kinship::service
