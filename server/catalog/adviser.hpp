#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "proto/types/advice.hpp"
#include "proto/types/profile.hpp"
#include "server/catalog/pending_fit.hpp"
#include "server/fitting/distribution_key.hpp"
#include "server/fitting/profile_advice.hpp"

namespace kinship::catalog {

/// The source of advice. Both functions are called from any thread, without a lock, and answer from
/// memory.
struct AdviceSource {
  std::function<Advice(const std::string& task, const Digest& robot, const Profile& profile)>
      advise = [](const std::string&, const Digest&, const Profile& profile) {
        return fitting::advice_of_profile(profile);
      };
  /// Grows whenever the result of `advise` for this task and robot may change.
  std::function<std::uint64_t(const std::string& task, const Digest& robot)> version =
      [](const std::string&, const Digest&) { return std::uint64_t{0}; };
};

/// A reply with the advice of some version.
struct AdvisedReply {
  SharedReply reply;
  std::uint64_t version = 0;
};

/// Gives replies the current advice instead of that of their fit. A reply is copied when the
/// version of the advice changed, not for each fetch. May be shared between threads.
class Adviser {
 public:
  explicit Adviser(AdviceSource source) : source_(std::move(source)) {}

  bool is_current(const AdvisedReply& reply, const fitting::DistributionKey& key) const;

  /// The reply with the current advice. Null stays null; a reply without a mixture needs no advice.
  AdvisedReply advise(const SharedReply& reply, const fitting::DistributionKey& key) const;

 private:
  AdviceSource source_;
};

}  // namespace kinship::catalog
