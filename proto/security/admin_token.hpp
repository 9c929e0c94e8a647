#pragma once

#include <chrono>
#include <filesystem>
#include <mutex>
#include <string>
#include <string_view>
#include <unordered_map>

#include "proto/types/caller.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/uuid.hpp"

/// The token of a server without security that other hosts reach: who has it may change and remove.
/// It never goes over the network: a request shows a proof that its sender has it.
namespace kinship::security {

/// The token in a file: 64 hexadecimal digits.
/// \throws Failure(NotFound) if there is none, Failure(InvalidInput) if it holds no token, is no
///         regular file, belongs to another user (but root), or others than its owner may read it.
Digest read_admin_token(const std::filesystem::path& file);

/// The same; without a file a random token is written to a new one with mode 0600. Several servers
/// may do so at the same time.
Digest make_admin_token(const std::filesystem::path& file);

/// Proof for one sending of a request: 16 random bytes and HMAC-SHA-256, by the token, of the
/// challenge, these bytes, the sender and every member of the request but `proof`; in hexadecimal
/// digits.
/// \param challenge  of the server's status.
/// \param client_id  of the sender, in the request's head.
std::string prove_admin_token(const Digest& token, std::string_view challenge,
                              const Uuid& client_id, const AdminRequest& request);

/// Checks proofs at the server. A challenge lasts from 10 to 20 minutes; while it does, a proof is
/// good for one request, also sent again within a minute: a captured one is worth nothing. Bounded
/// memory: only holders of the token make it remember. May be shared between threads.
class AdminTokenCheck {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  AdminTokenCheck(const Digest& token, TimePoint now);

  /// For a proof that is made now.
  std::string challenge(TimePoint now);

  /// \param client_id    in the request's head.
  /// \param request_key  tells requests apart; the same for a request that is sent again.
  /// \return Missing, Wrong or Shown.
  TokenProof check(const AdminRequest& request, const Uuid& client_id,
                   const std::string& request_key, TimePoint now);

 private:
  struct Use {
    std::string request_key;
    TimePoint first;
  };
  struct Period {
    std::string challenge;
    TimePoint began;
    std::unordered_map<std::string, Use> uses;  // by the random bytes
  };

  void renew(TimePoint now);

  const Digest token_;
  std::mutex mutex_;  // guards what follows
  Period current_, last_;
};

}  // namespace kinship::security
