#include "proto/security/credentials.hpp"

#include <sys/stat.h>
#include <toml++/toml.h>

#include "proto/security/certificate_name.hpp"
#include "proto/security/governance.hpp"
#include "proto/security/private_files.hpp"
#include "proto/types/time_text.hpp"

namespace kinship::security {
namespace {

void write_files(const CredentialFiles& files, const CredentialWish& wish, const Vouchers& vouchers,
                 const Key& key, x509_st& certificate) {
  write_new_file(files.key, to_pem(*key), Readers::Owner);
  write_new_file(files.certificate, to_pem(certificate), Readers::Everybody);
  std::string all;
  make_private_folder(files.trusted);
  for (const Certificate& one : vouchers.trusted) {
    all += to_pem(*one);
    write_new_file(files.trusted / (fingerprint(*one) + ".pem"), to_pem(*one), Readers::Everybody);
  }
  write_new_file(files.authorities, all, Readers::Everybody);
  write_new_file(files.governance, sign_document(governance_text(), vouchers.signer, wish.validity),
                 Readers::Everybody);
  write_new_file(files.permissions, sign_document(wish.permissions, vouchers.signer, wish.validity),
                 Readers::Everybody);
  write_new_file(files.identity, "name = \"" + wish.name + "\"\nrole = \"" + wish.role + "\"\n",
                 Readers::Everybody);
}

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& reason) {
  throw Failure(ErrorCode::InvalidInput, file.string() + ": " + reason);
}

/// A folder of something else is named by mistake, such as the server's security folder.
void require_key(const std::filesystem::path& key) {
  if (!std::filesystem::exists(key))
    throw Failure(ErrorCode::NotFound,
                  key.parent_path().string() + ": holds no credentials (" + key.string() +
                      " is not there); they are made by: kinshipd secure add NAME --out FOLDER");
}

/// Other users that can read a key can act as its owner.
void require_private(const std::filesystem::path& key) {
  constexpr mode_t kOthers = 077;
  struct stat status {};
  if (stat(key.c_str(), &status) == 0 && (status.st_mode & kOthers) != 0)
    refuse(key, "others than its owner have access to it; chmod 600 it");
}

/// When this machine's clock stood at the file's last change; 1970 if that is not known.
std::chrono::sys_seconds changed_at(const std::filesystem::path& file) {
  struct stat status {};
  return std::chrono::sys_seconds(
      std::chrono::seconds(stat(file.c_str(), &status) == 0 ? status.st_ctim.tv_sec : 0));
}

/// A certificate may be from a machine whose clock is ahead, or this machine's clock may be behind:
/// it is, if it stood later before.
void require_begun(const std::filesystem::path& file, std::chrono::sys_seconds begins,
                   std::chrono::sys_seconds now) {
  if (begins <= now)
    return;
  const std::string times =
      "is valid from " + time_text(begins) + " on, and this machine's clock says " + time_text(now);
  if (const auto before = changed_at(file); before > now + std::chrono::minutes(1))
    refuse(file, times + ", which is behind: it said " + time_text(before) +
                     " when the file was written; set the clock");
  refuse(file, times + "; if that is right (date -u), the clock of the machine that made the " +
                   "certificate was ahead: set that one and make new ones there");
}

void check_document(const std::filesystem::path& file, x509_st& authority) {
  if (const auto text = verify_document(read_file(file), authority); !text)
    refuse(file, "not signed by the first authority of ca.pem, or not valid any more (" +
                     text.error().message + ")");
}

std::string identity_field(const toml::table& table, std::string_view field,
                           const std::filesystem::path& file) {
  const auto value = table[field].value<std::string>();
  if (!value)
    refuse(file, "field '" + std::string(field) + "' must be there, as text");
  return *value;
}

Credentials read_checked(const CredentialFiles& files, std::chrono::sys_seconds now) {
  require_key(files.key);
  require_private(files.key);
  const Key key = key_from_pem(read_file(files.key), files.key.string());
  const auto certificates =
      certificates_from_pem(read_file(files.certificate), files.certificate.string());
  const auto authorities =
      certificates_from_pem(read_file(files.authorities), files.authorities.string());
  if (certificates.size() != 1)
    refuse(files.certificate, "must have one certificate");
  if (authorities.empty())
    refuse(files.authorities, "has no certificate");
  x509_st& certificate = *certificates.front();
  if (!belongs_to(*key, certificate))
    refuse(files.key, "is not the key of certificate.pem");
  Credentials credentials{.name = common_name(certificate),
                          .role = {},
                          .expires = expiry(certificate),
                          .authorities = authorities.size()};
  if (credentials.expires <= now)
    refuse(files.certificate, "expired at " + time_text(credentials.expires) +
                                  "; new ones: kinshipd secure renew" +
                                  (credentials.name == kServerName
                                       ? std::string("-server")
                                       : " " + client_of(credentials.name) + " --out FOLDER"));
  require_begun(files.certificate, beginning(certificate), now);
  if (const auto error = check_issued(certificate, authorities, now))
    refuse(files.certificate, error->message);
  check_document(files.governance, *authorities.front());
  check_document(files.permissions, *authorities.front());
  toml::table identity;
  try {
    identity = toml::parse(read_file(files.identity));
  } catch (const toml::parse_error& error) {
    refuse(files.identity, std::string(error.description()));
  }
  credentials.role = identity_field(identity, "role", files.identity);
  if (const std::string name = identity_field(identity, "name", files.identity);
      name != credentials.name)
    refuse(files.identity, "is of '" + name + "', certificate.pem of '" + credentials.name + "'");
  return credentials;
}

}  // namespace

Result<Credentials> read_credentials(const std::filesystem::path& folder,
                                     std::chrono::sys_seconds now) {
  try {
    return read_checked(CredentialFiles(folder), now);
  } catch (const Failure& failure) {
    return failure.error();
  }
}

std::optional<std::string> expiry_warning(const Credentials& credentials,
                                          std::chrono::sys_seconds now) {
  if (credentials.expires - now >= kWarnedBefore)
    return std::nullopt;
  const auto days = std::chrono::floor<std::chrono::days>(credentials.expires - now).count();
  const std::string left = credentials.expires <= now ? "have expired"
                           : days == 0                ? "expire in less than a day"
                           : days == 1                ? "expire in 1 day"
                                       : "expire in " + std::to_string(days) + " days";
  const bool is_server = credentials.name == kServerName;
  return "the credentials of '" + client_of(credentials.name) + "' " + left + ", at " +
         time_text(credentials.expires) + "; new ones: kinshipd secure renew" +
         (is_server ? "-server" : " " + client_of(credentials.name) + " --out FOLDER");
}

Certificate write_credentials(const std::filesystem::path& folder, const CredentialWish& wish,
                              const Vouchers& vouchers) {
  const Key key = make_key();
  Certificate certificate =
      issue({.name = wish.name, .use = Use::Identity, .validity = wish.validity}, *key,
            *vouchers.issuer.certificate, *vouchers.issuer.key);
  make_private_folder(folder);
  try {
    write_files(CredentialFiles(folder), wish, vouchers, key, *certificate);
  } catch (...) {
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
      std::filesystem::remove_all(entry.path(), ignored);
    throw;
  }
  return certificate;
}

}  // namespace kinship::security
