#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "proto/types/audit.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/distribution.hpp"
#include "proto/types/summaries.hpp"
#include "server/store/page.hpp"

namespace kinship::store {

/// The right to fit a distribution, which one server of a store has at a time.
struct FitRight {
  /// Greater than the fence of every earlier holder; 0: there is one server.
  std::uint64_t fence = 0;
};

/// Keeps fitted distributions, and the right of one server to fit each; see Store.
class DistributionStore {
 public:
  /// Stores a distribution under its id with the next revision, durable on return. Beyond the limit
  /// of all distributions (an option of the engine) the least recently used ones are deleted.
  /// \param right  with which it was fitted.
  /// \return the revision, greater than every earlier one of this id.
  /// \throws Failure(NotFound) if its robot is not registered, or its task is not there (any more),
  ///         so that what was fitted for it serves no other of its name; Failure(InvalidInput) if a
  ///         part exceeds its limit; Failure(Unavailable), and nothing is stored, if another server
  ///         has taken the right since.
  virtual std::uint64_t put_distribution(const Distribution& distribution,
                                         const FitRight& right = {}) = 0;
  /// Takes the right to fit a distribution. It is free a few seconds after its server died.
  /// \return nothing while another server has it.
  virtual std::optional<FitRight> take_fit_right(const Digest& id) {
    (void)id;
    return FitRight{};
  }
  /// Frees the right for other servers. Never throws: a right that is not given back is free once
  /// the server takes it again or ends.
  virtual void give_back_fit_right(const Digest& id, const FitRight& right) noexcept {
    (void)id;
    (void)right;
  }
  /// The newest revision; nothing if its payload fails its CRC.
  virtual std::optional<Distribution> find_distribution(const Digest& id) const = 0;
  /// Notes that a distribution was served; precise to the hour, lost in a crash. Returns at once.
  virtual void note_use(const Digest& id) const = 0;
  /// Evicts a distribution, durable on return; its next fit gets the next revision.
  /// \return whether it existed.
  virtual bool evict_distribution(const Digest& id, const AuditEntry* audit = nullptr) = 0;
  /// The newest fit first; a distribution fitted again between two pages goes to the front.
  virtual Page<DistributionSummary> list_distributions(const std::optional<Digest>& robot,
                                                       std::string_view task,
                                                       std::string_view cursor,
                                                       std::size_t limit) const = 0;

 protected:
  ~DistributionStore() = default;
};

}  // namespace kinship::store
