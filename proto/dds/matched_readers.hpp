#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <set>
#include <string_view>
#include <utility>

#include "proto/dds/entity.hpp"
#include "proto/dds/participant.hpp"

struct dds_qos;

namespace kinship::dds {

/// The participants with a reader that one of our writers has matched. A sample of a volatile
/// writer never reaches a reader that it has not matched yet, and a client's reader and writer are
/// discovered in either order. For sources of proto/dds only; may be shared between threads.
class MatchedReaders {
 public:
  explicit MatchedReaders(const Participant& participant);
  MatchedReaders(const MatchedReaders&) = delete;
  MatchedReaders& operator=(const MatchedReaders&) = delete;

  /// A writer whose readers are tracked; it must not outlive the object.
  /// \throws Failure(Internal) if it cannot be made.
  Entity make_writer(const Entity& publisher, Handle topic, const dds_qos* qos,
                     std::string_view what);

  /// \param participant  its instance handle.
  bool has(const Entity& writer, std::uint64_t participant) const;

  const Entity& guard() const noexcept { return guard_; }            ///< set when one has come
  std::uint64_t departures() const noexcept { return departures_; }  ///< number that have gone

 private:
  using Reader = std::pair<Handle, std::uint64_t>;  // of which writer, and its handle
  using Hearer = std::pair<Handle, std::uint64_t>;  // of which writer, and its participant

  void come(const Reader& reader);
  void go(const Reader& reader);

  Entity guard_;
  std::atomic<std::uint64_t> departures_ = 0;
  mutable std::mutex mutex_;  // guards what follows
  std::map<Reader, std::uint64_t> readers_;
  std::multiset<Hearer> participants_;
};

}  // namespace kinship::dds
