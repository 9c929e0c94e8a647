#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "client/cli/terminal.hpp"
#include "client/link/client.hpp"

namespace kinship::cli {

inline constexpr const char* kImportPaths = "paths import";

/// Attempts of `paths import` on their way to the server: handed over in batches, and counted.
class AttemptDelivery {
 public:
  struct Counts {
    std::uint64_t robots = 0, stored = 0, known = 0, recorded = 0, refused = 0;
  };

  /// \param server, err  outlive the object.
  /// \param progress     names what was delivered last on `err`.
  AttemptDelivery(link::Client& server, std::ostream& err, bool progress);

  /// Takes an attempt; when there are enough, they are delivered (Client::deliver(), which checks
  /// each).
  /// \param place  where it is from, for messages, e.g. "line 3".
  void hold(const std::string& place, Attempt attempt);

  /// Counts what cannot be taken, and says why.
  void refuse(const std::string& place, const std::string& why);
  void tell(const std::string& place, const std::string& what);
  void count_robot() { ++counts_.robots; }

  /// Delivers what is held.
  void deliver();

  /// Ends the import.
  void stop(Error why) { end_ = std::move(why); }
  const std::optional<Error>& end() const noexcept { return end_; }  ///< why it cannot go on

  /// Delivers the rest and prints the counts.
  /// \param what  a refused one is, e.g. "line".
  /// \return the exit code: kFailed if something was refused.
  int finish(const std::string& what, bool json, std::ostream& out);

  link::Client& server() const noexcept { return server_; }

 private:
  void count(const Receipt& receipt, const std::string& place);

  link::Client& server_;
  std::ostream& err_;
  StatusLine progress_;
  Counts counts_;
  std::optional<Error> end_;
  std::vector<Attempt> attempts_;    // held until there are enough
  std::vector<std::string> places_;  // of them
  std::size_t bytes_ = 0;            // of their waypoints and scenes
};

}  // namespace kinship::cli
