#include "proto/security/security_folder.hpp"

#include "proto/security/access_role.hpp"
#include "proto/security/permissions.hpp"
#include "proto/security/private_files.hpp"
#include "proto/security/time_text.hpp"
#include "proto/types/names.hpp"

namespace kinship::security {
namespace {

constexpr std::chrono::days kAuthorityDays{3653};
constexpr std::chrono::days kMaxDays = kAuthorityDays;

void check(const std::optional<Error>& error) {
  if (error)
    throw Failure(*error);
}

/// A new authority, named so that it is told from others.
Authority make_new_authority(std::chrono::sys_seconds now) {
  Key key = make_key();
  const std::string name = "authority since " + time_text(now);
  Certificate certificate = make_authority(
      {.name = name, .use = Use::Authority, .validity = valid_for(kAuthorityDays, now)}, *key);
  return {std::move(key), std::move(certificate)};
}

/// `days` from now on, as far as the authority itself is valid.
Validity within(const Authority& authority, std::chrono::days days, std::chrono::sys_seconds now) {
  if (days < std::chrono::days(1) || days > kMaxDays)
    throw Failure(ErrorCode::InvalidInput, "days: " + std::to_string(days.count()) +
                                               " is not from 1 to " +
                                               std::to_string(kMaxDays.count()));
  Validity validity = valid_for(days, now);
  validity.end = std::min(validity.end, expiry(*authority.certificate));
  return validity;
}

void write_server_credentials(const std::filesystem::path& folder, const Authority& authority,
                              const std::vector<Certificate>& trusted, const Validity& validity) {
  write_credentials(folder,
                    {.name = kServerName,
                     .role = kServerName,
                     .validity = validity,
                     .permissions = server_permissions(kServerName, validity)},
                    authority, trusted);
}

}  // namespace

SecurityFolder SecurityFolder::init(const std::filesystem::path& folder,
                                    std::chrono::days server_days, std::chrono::sys_seconds now) {
  const Authority authority = make_new_authority(now);
  const Validity validity = within(authority, server_days, now);
  make_private_folder(folder);
  make_private_folder(folder / "authority");
  make_private_folder(folder / "clients");
  write_new_file(folder / "authority" / "ca.key", to_pem(*authority.key), Readers::Owner);
  const std::string pem = to_pem(*authority.certificate);
  write_new_file(folder / "authority" / "ca.pem", pem, Readers::Everybody);
  write_server_credentials(folder / "server", authority, certificates_from_pem(pem, "authority"),
                           validity);
  return SecurityFolder(folder);
}

SecurityFolder::SecurityFolder(std::filesystem::path folder, std::filesystem::path authority_key)
    : folder_(std::move(folder)), authority_key_(std::move(authority_key)) {
  if (authority_key_.empty())
    authority_key_ = folder_ / "authority" / "ca.key";
  if (!std::filesystem::is_regular_file(folder_ / "authority" / "ca.pem"))
    throw Failure(ErrorCode::NotFound, folder_.string() +
                                           ": is no security folder: authority/ca.pem is not "
                                           "there; one is made by: kinshipd secure init " +
                                           folder_.string());
}

std::vector<Certificate> SecurityFolder::trusted() const {
  const std::filesystem::path file = folder_ / "authority" / "ca.pem";
  return certificates_from_pem(read_file(file), file.string());
}

Authority SecurityFolder::authority() const {
  auto certificates = trusted();
  Key key = key_from_pem(read_file(authority_key_), authority_key_.string());
  if (certificates.empty() || !belongs_to(*key, *certificates.front()))
    throw Failure(ErrorCode::InvalidInput, authority_key_.string() + ": is not the key of " +
                                               (folder_ / "authority" / "ca.pem").string());
  return {std::move(key), std::move(certificates.front())};
}

std::filesystem::path SecurityFolder::record_file(const std::string& name) const {
  return clients() / (name + ".toml");
}

ClientRecord SecurityFolder::add(const NewClient& client, const std::filesystem::path& out,
                                 std::chrono::sys_seconds now) const {
  check(check_client_name(client.name));
  for (const std::string& pattern : client.tasks)
    check(check_task_pattern(pattern));
  for (const std::string& label : client.robots)
    check(check_label(label));
  if (std::filesystem::exists(record_file(client.name)))
    throw Failure(ErrorCode::Conflict, "client '" + client.name + "' exists already: " +
                                           record_file(client.name).string());
  const Authority issuer = authority();
  const Validity validity = within(issuer, client.days, now);
  const Certificate certificate =
      write_credentials(out,
                        {.name = client.name,
                         .role = role_name(client.role),
                         .validity = validity,
                         .permissions = client_permissions(client.name, client.role, validity)},
                        issuer, trusted());
  ClientRecord record{.name = client.name,
                      .role = client.role,
                      .tasks = client.tasks,
                      .robots = client.robots,
                      .serial = serial_text(*certificate),
                      .authority = fingerprint(*issuer.certificate),
                      .expires = validity.end};
  write_new_file(record_file(client.name), record_text(record), Readers::Everybody);
  return record;
}

ClientRecord SecurityFolder::revoke(const std::string& name, std::chrono::sys_seconds now) const {
  check(check_client_name(name));
  ClientRecord record =
      read_record(read_file(record_file(name)), record_file(name).string()).value_or_throw();
  record.revoked = record.revoked.value_or(now);
  replace_file(record_file(name), record_text(record), Readers::Everybody);
  return record;
}

}  // namespace kinship::security
