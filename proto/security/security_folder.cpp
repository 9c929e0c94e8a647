#include "proto/security/security_folder.hpp"

#include <fcntl.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "proto/files/lock_file.hpp"
#include "proto/security/access_role.hpp"
#include "proto/security/certificate_name.hpp"
#include "proto/security/permissions.hpp"
#include "proto/security/private_files.hpp"
#include "proto/types/names.hpp"
#include "proto/types/time_text.hpp"

namespace kinship::security {
namespace {

void throw_if(const std::optional<Error>& error) {
  if (error)
    throw Failure(*error);
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

void write_server_credentials(const std::filesystem::path& folder, const Vouchers& vouchers,
                              const Validity& validity) {
  write_credentials(folder,
                    {.name = kServerName,
                     .role = kServerName,
                     .validity = validity,
                     .permissions = server_permissions(kServerName, validity)},
                    vouchers);
}

/// Puts the folder `next` in the place of `folder`, which is never missing meanwhile.
/// \return where that is now.
std::filesystem::path replace_folder(const std::filesystem::path& folder,
                                     const std::filesystem::path& next,
                                     std::chrono::sys_seconds now) {
  std::filesystem::path kept = folder.string() + ".replaced-" + time_text(now);
  for (int number = 2; std::filesystem::exists(kept); ++number)
    kept = folder.string() + ".replaced-" + time_text(now) + "-" + std::to_string(number);
  if (renameat2(AT_FDCWD, next.c_str(), AT_FDCWD, folder.c_str(), RENAME_EXCHANGE) != 0)
    throw Failure(ErrorCode::Storage, folder.string() + ": cannot be replaced by " + next.string() +
                                          ": " + std::generic_category().message(errno));
  std::filesystem::rename(next, kept);
  return kept;
}

std::int64_t to_ms(std::chrono::sys_seconds time) {
  return std::chrono::milliseconds(time.time_since_epoch()).count();
}

/// Sets the members that follow from the time until which credentials are valid.
void set_expiry(CredentialList::Row& row, std::chrono::sys_seconds expires,
                std::chrono::sys_seconds now) {
  row.expires_ms = to_ms(expires);
  row.days_left = std::chrono::round<std::chrono::days>(expires - now).count();
  row.state = expires <= now ? "expired" : expires - now < kWarnedBefore ? "expires soon" : "valid";
}

CredentialList::Row client_row(const std::filesystem::path& file, std::chrono::sys_seconds now) {
  CredentialList::Row row{.name = file.stem().string(), .state = "unreadable"};
  try {
    const ClientRecord record = read_record(read_file(file), file.string()).value_or_throw();
    row.role = role_name(record.role);
    row.tasks = record.tasks;
    row.robots = record.robots;
    row.authority = record.authority;
    row.trusted = record.trusted;
    set_expiry(row, record.expires, now);
    if (record.revoked) {
      row.state = "revoked";
      row.revoked_ms = to_ms(*record.revoked);
    }
  } catch (const Failure& failure) {
    row.message = failure.what();
  }
  return row;
}

CredentialList::Row server_row(const std::filesystem::path& folder, std::chrono::sys_seconds now) {
  CredentialList::Row row{.name = kServerName, .role = kServerName, .state = "unreadable"};
  try {
    const CredentialFiles files(folder);
    const auto certificates =
        certificates_from_pem(read_file(files.certificate), files.certificate.string());
    const auto trusted =
        certificates_from_pem(read_file(files.authorities), files.authorities.string());
    if (certificates.empty() || trusted.empty())
      throw Failure(ErrorCode::InvalidInput, folder.string() + ": a certificate is missing");
    row.authority = fingerprint(*trusted.front());
    for (const Certificate& one : trusted)
      row.trusted.push_back(fingerprint(*one));
    set_expiry(row, expiry(*certificates.front()), now);
  } catch (const Failure& failure) {
    row.message = failure.what();
  }
  return row;
}

bool is_good(const HostCertificate& files, const std::vector<std::string>& hosts,
             const std::vector<Certificate>& trusted, std::chrono::sys_seconds now) {
  try {
    const auto certificates = certificates_from_pem(read_file(files.certificate), "certificate");
    const Key key = key_from_pem(read_file(files.key), "key");
    return !certificates.empty() && belongs_to(*key, *certificates.front()) &&
           !check_issued(*certificates.front(), trusted, now + kWarnedBefore) &&
           std::ranges::all_of(hosts, [&](const std::string& host) {
             return names_host(*certificates.front(), host);
           });
  } catch (const Failure&) {
    return false;
  }
}

/// Names of clients, neither revoked nor expired, that `property` holds for.
std::vector<std::string> names_of(const CredentialList& list, bool CredentialList::Row::*property) {
  std::vector<std::string> names;
  for (const CredentialList::Row& row : list.credentials)
    if (row.*property && row.role != kServerName && row.state != "revoked" &&
        row.state != "expired")
      names.push_back(row.name);
  return names;
}

/// Files that root writes for another user's server could not be read by it.
void require_owner(const std::filesystem::path& folder) {
  struct stat status {};
  if (stat(folder.c_str(), &status) == 0 && status.st_uid != geteuid())
    throw Failure(ErrorCode::Conflict, folder.string() + ": belongs to user " +
                                           std::to_string(status.st_uid) +
                                           ", who has to do this: sudo -u '#" +
                                           std::to_string(status.st_uid) + "' kinshipd secure ...");
}

/// Waits until no other process changes the folder; none does as long as the lock lives.
/// \throws Failure(Storage) if the folder's file `lock` cannot be had.
files::LockFile lock_folder(const std::filesystem::path& folder) {
  try {
    return files::LockFile::acquire(folder / "lock");
  } catch (const files::FileError& error) {
    throw Failure(ErrorCode::Storage,
                  error.file().string() + ": cannot be locked: " + error.reason_text());
  }
}

/// \throws Failure(NotFound) if it is no security folder.
AuthorityFolder open_authority(const std::filesystem::path& folder,
                               const std::filesystem::path& key) {
  try {
    return AuthorityFolder(folder / "authority", key);
  } catch (const Failure& failure) {
    throw Failure(failure.code(), folder.string() + ": is no security folder (" + failure.what() +
                                      "); one is made by: kinshipd secure init " + folder.string());
  }
}

}  // namespace

SecurityFolder SecurityFolder::init(const std::filesystem::path& folder,
                                    std::chrono::days server_days, std::chrono::sys_seconds now) {
  make_private_folder(folder);
  make_private_folder(folder / "clients");
  const AuthorityFolder authority = AuthorityFolder::init(folder / "authority", now);
  const Vouchers vouchers = authority.for_server();
  write_server_credentials(folder / "server", vouchers, within(vouchers.issuer, server_days, now));
  return SecurityFolder(folder);
}

SecurityFolder::SecurityFolder(std::filesystem::path folder,
                               const std::filesystem::path& authority_key)
    : folder_(std::move(folder)), authority_(open_authority(folder_, authority_key)) {
  require_owner(folder_);
}

std::filesystem::path SecurityFolder::record_file(const std::string& name) const {
  return clients() / (name + ".toml");
}

ClientRecord SecurityFolder::record_of(const std::string& name) const {
  throw_if(check_client_name(name));
  if (!std::filesystem::exists(record_file(name)))
    throw Failure(ErrorCode::NotFound, "client '" + name + "': is not in " + clients().string() +
                                           "; who is there: kinshipd secure list");
  return read_record(read_file(record_file(name)), record_file(name).string()).value_or_throw();
}

ClientRecord SecurityFolder::issue_to(ClientRecord record, std::chrono::days days,
                                      const std::filesystem::path& out,
                                      std::chrono::sys_seconds now) const {
  const Vouchers vouchers = authority_.for_clients();
  const Validity validity = within(vouchers.issuer, days, now);
  const std::string name = common_name({.client = record.name, .generation = record.generation});
  const Certificate certificate =
      write_credentials(out,
                        {.name = name,
                         .role = role_name(record.role),
                         .validity = validity,
                         .permissions = client_permissions(name, record.role, validity)},
                        vouchers);
  record.serial = serial_text(*certificate);
  record.authority = fingerprint(*vouchers.issuer.certificate);
  record.trusted.clear();
  for (const Certificate& one : vouchers.trusted)
    record.trusted.push_back(fingerprint(*one));
  record.expires = validity.end;
  return record;
}

ClientRecord SecurityFolder::add(const NewClient& client, const std::filesystem::path& out,
                                 std::chrono::sys_seconds now) const {
  throw_if(check_client_name(client.name));
  for (const std::string& pattern : client.tasks)
    throw_if(check_task_pattern(pattern));
  for (const std::string& label : client.robots)
    throw_if(check_label(label));
  const files::LockFile lock = lock_folder(folder_);
  if (std::filesystem::exists(record_file(client.name)))
    throw Failure(ErrorCode::Conflict, "client '" + client.name + "': exists already (" +
                                           record_file(client.name).string() +
                                           "); new credentials for it: kinshipd secure renew " +
                                           client.name);
  const ClientRecord record = issue_to(
      {.name = client.name, .role = client.role, .tasks = client.tasks, .robots = client.robots},
      client.days, out, now);
  try {
    write_new_file(record_file(client.name), record_text(record), Readers::Everybody);
  } catch (...) {  // e.g. added twice at the same time: no client has these credentials
    std::error_code ignored;
    std::filesystem::remove_all(out, ignored);
    throw;
  }
  return record;
}

ClientRecord SecurityFolder::renew(const std::string& name, std::chrono::days days,
                                   const std::filesystem::path& out,
                                   std::chrono::sys_seconds now) const {
  const files::LockFile lock = lock_folder(folder_);
  ClientRecord record = record_of(name);
  if (record.revoked)
    throw Failure(ErrorCode::Conflict, "client '" + name + "': revoked at " +
                                           time_text(*record.revoked) +
                                           "; give what is to come back another name");
  ++record.generation;
  record = issue_to(std::move(record), days, out, now);
  replace_file(record_file(name), record_text(record), Readers::Everybody);
  return record;
}

ClientRecord SecurityFolder::revoke(const std::string& name, std::chrono::sys_seconds now) const {
  const files::LockFile lock = lock_folder(folder_);
  ClientRecord record = record_of(name);
  if (!record.revoked) {
    record.revoked = now;
    replace_file(record_file(name), record_text(record), Readers::Everybody);
  }
  return record;
}

ClientRecord SecurityFolder::revoke_former(const std::string& name) const {
  const files::LockFile lock = lock_folder(folder_);
  ClientRecord record = record_of(name);
  if (record.generation == 1)
    throw Failure(ErrorCode::Conflict,
                  "client '" + name + "': has its first credentials, there are no former ones");
  record.oldest_accepted = record.generation;
  replace_file(record_file(name), record_text(record), Readers::Everybody);
  return record;
}

void SecurityFolder::revoke_again(const Revocation& revocation) const {
  const files::LockFile lock = lock_folder(folder_);
  ClientRecord record = record_of(revocation.client);
  if (revocation.revoked)
    record.revoked = revocation.revoked;
  record.oldest_accepted = std::max(record.oldest_accepted, revocation.oldest_accepted);
  record.generation = std::max(record.generation, revocation.generation);
  replace_file(record_file(record.name), record_text(record), Readers::Everybody);
}

std::vector<std::string> SecurityFolder::authorities() const {
  std::vector<std::string> fingerprints;
  for (const Certificate& one : authority_.trusted())
    fingerprints.push_back(fingerprint(*one));
  return fingerprints;
}

CredentialList SecurityFolder::list(std::chrono::sys_seconds now) const {
  CredentialList list;
  for (const Certificate& one : authority_.trusted())
    list.authorities.push_back({common_name(*one), fingerprint(*one), to_ms(expiry(*one))});
  list.credentials.push_back(server_row(server_credentials(), now));
  for (const auto& entry : std::filesystem::directory_iterator(clients()))
    if (entry.path().extension() == ".toml")
      list.credentials.push_back(client_row(entry.path(), now));
  std::sort(list.credentials.begin() + 1, list.credentials.end(),
            [](const auto& a, const auto& b) { return a.name < b.name; });
  for (CredentialList::Row& row : list.credentials) {
    row.is_of_previous_authority =
        !row.authority.empty() && row.authority != list.authorities.front().fingerprint;
    row.trusts_a_retired_authority =
        std::ranges::any_of(row.trusted, [&](const std::string& trusted) {
          return std::ranges::find(list.authorities, trusted,
                                   &CredentialList::Authority::fingerprint) ==
                 list.authorities.end();
        });
  }
  return list;
}

HostCertificate SecurityFolder::host_certificate(const std::vector<std::string>& hosts,
                                                 std::chrono::sys_seconds now) const {
  const std::filesystem::path folder = folder_ / "console";
  HostCertificate files{folder / "certificate.pem", folder / "key.pem"};
  const files::LockFile lock = lock_folder(folder_);
  if (is_good(files, hosts, authority_.trusted(), now))
    return files;
  const Authority issuer = authority_.for_server().issuer;
  const Key key = make_key();
  const Certificate certificate = issue({.name = "Kinship console",
                                         .use = Use::Host,
                                         .validity = within(issuer, kDefaultDays, now),
                                         .hosts = hosts},
                                        *key, *issuer.certificate, *issuer.key);
  if (!std::filesystem::exists(folder))
    make_private_folder(folder);
  replace_file(files.key, to_pem(*key), Readers::Owner);
  replace_file(files.certificate, to_pem(*certificate), Readers::Everybody);
  return files;
}

std::filesystem::path SecurityFolder::replace_server(std::chrono::days days,
                                                     std::chrono::sys_seconds now) const {
  const Vouchers vouchers = authority_.for_server();
  const std::filesystem::path next = folder_ / "server.next";
  std::filesystem::remove_all(next);  // of a change that was interrupted
  write_server_credentials(next, vouchers, within(vouchers.issuer, days, now));
  return replace_folder(server_credentials(), next, now);
}

std::filesystem::path SecurityFolder::renew_server(std::chrono::days days,
                                                   std::chrono::sys_seconds now) const {
  const files::LockFile lock = lock_folder(folder_);
  return replace_server(days, now);
}

std::filesystem::path SecurityFolder::renew_authority(std::chrono::days server_days,
                                                      std::chrono::sys_seconds now) {
  const files::LockFile lock = lock_folder(folder_);
  authority_.add_second(now);
  return replace_server(server_days, now);
}

std::filesystem::path SecurityFolder::replace_authority(std::chrono::days server_days,
                                                        std::chrono::sys_seconds now) {
  const files::LockFile lock = lock_folder(folder_);
  authority_.replace(now);
  return replace_server(server_days, now);
}

std::vector<std::string> SecurityFolder::clients_of_previous_authority(
    std::chrono::sys_seconds now) const {
  return names_of(list(now), &CredentialList::Row::is_of_previous_authority);
}

std::vector<std::string> SecurityFolder::clients_that_trust_retired(
    std::chrono::sys_seconds now) const {
  return names_of(list(now), &CredentialList::Row::trusts_a_retired_authority);
}

std::filesystem::path SecurityFolder::retire_authority(std::chrono::days server_days,
                                                       std::chrono::sys_seconds now) {
  const files::LockFile lock = lock_folder(folder_);
  static_cast<void>(authority_.for_clients());  // its key has to be there, before anything changes
  const std::filesystem::path key = authority_.retire_previous();
  replace_server(server_days, now);
  return key;
}

}  // namespace kinship::security
