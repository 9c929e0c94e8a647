#pragma once

#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "proto/types/field.hpp"

namespace kinship {

/// The credentials issued by the authorities of a security folder, and their expiry.
struct CredentialList {
  struct Authority {
    std::string name = {};
    std::string fingerprint = {};
    std::int64_t expires_ms = 0;
  };

  struct Row {
    std::string name = {};
    std::string role = {};  ///< "server" for the server's; empty if its file cannot be read
    std::vector<std::string> tasks = {};
    std::vector<std::string> robots = {};
    std::string state = {};  ///< "valid", "expires soon", "expired", "revoked" or "unreadable"
    std::int64_t expires_ms = 0;
    std::int64_t days_left = 0;   ///< rounded; below 0: expired
    std::int64_t revoked_ms = 0;  ///< 0: not
    std::string authority = {};   ///< fingerprint of the issuer
    bool is_of_previous_authority = false;
    std::string message = {};               ///< why its file cannot be read
    std::vector<std::string> trusted = {};  ///< fingerprints of authorities that these files trust
    /// The holder of that authority's key can impersonate the server to this client, until it is
    /// renewed.
    bool trusts_a_retired_authority = false;
  };

  std::vector<Authority> authorities;  ///< the issuing one first
  std::vector<Row> credentials;        ///< first the server's, then clients by name
};

template <>
inline constexpr std::tuple kFieldsOf<CredentialList::Authority>{
    Field{"name", &CredentialList::Authority::name},
    Field{"fingerprint", &CredentialList::Authority::fingerprint},
    Field{"expires_ms", &CredentialList::Authority::expires_ms}};

template <>
inline constexpr std::tuple kFieldsOf<CredentialList::Row>{
    Field{"name", &CredentialList::Row::name},
    Field{"role", &CredentialList::Row::role},
    Field{"tasks", &CredentialList::Row::tasks},
    Field{"robots", &CredentialList::Row::robots},
    Field{"state", &CredentialList::Row::state},
    Field{"expires_ms", &CredentialList::Row::expires_ms},
    Field{"days_left", &CredentialList::Row::days_left},
    Field{"revoked_ms", &CredentialList::Row::revoked_ms},
    Field{"authority", &CredentialList::Row::authority},
    Field{"is_of_previous_authority", &CredentialList::Row::is_of_previous_authority},
    Field{"message", &CredentialList::Row::message},
    Field{"trusted", &CredentialList::Row::trusted},
    Field{"trusts_a_retired_authority", &CredentialList::Row::trusts_a_retired_authority}};

template <>
inline constexpr std::tuple kFieldsOf<CredentialList>{
    Field{"authorities", &CredentialList::authorities},
    Field{"credentials", &CredentialList::credentials}};

}  // namespace kinship
