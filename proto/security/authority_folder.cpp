#include "proto/security/authority_folder.hpp"

#include <algorithm>
#include <array>

#include "proto/security/private_files.hpp"
#include "proto/types/time_text.hpp"

namespace kinship::security {
namespace {

constexpr std::chrono::days kAuthorityDays{3653};  // 10 years

std::string list_pem(const std::vector<Certificate>& certificates) {
  std::string text;
  for (const Certificate& certificate : certificates)
    text += to_pem(*certificate);
  return text;
}

/// A new authority, named so that it is told from others.
Authority make_new_authority(std::chrono::sys_seconds now) {
  Key key = make_key();
  Certificate certificate = make_authority({.name = "authority since " + time_text(now),
                                            .use = Use::Authority,
                                            .validity = valid_for(kAuthorityDays, now)},
                                           *key);
  return {std::move(key), std::move(certificate)};
}

bool is_key_of(const std::filesystem::path& file, x509_st& certificate) {
  return belongs_to(*key_from_pem(read_file(file), file.string()), certificate);
}

/// The key of `one`, vouched for by `other`, as long as both are valid.
Certificate cross(const Authority& one, const Authority& other, std::chrono::sys_seconds now) {
  Validity validity = valid_for(kAuthorityDays, now);
  validity.end = std::min({validity.end, expiry(*one.certificate), expiry(*other.certificate)});
  return issue(
      {.name = common_name(*one.certificate), .use = Use::CrossedAuthority, .validity = validity},
      *one.key, *other.certificate, *other.key);
}

}  // namespace

AuthorityFolder AuthorityFolder::init(const std::filesystem::path& folder,
                                      std::chrono::sys_seconds now) {
  const Authority authority = make_new_authority(now);
  make_private_folder(folder);
  write_new_file(folder / "ca.key", to_pem(*authority.key), Readers::Owner);
  write_new_file(folder / "ca.pem", to_pem(*authority.certificate), Readers::Everybody);
  return AuthorityFolder(folder);
}

AuthorityFolder::AuthorityFolder(std::filesystem::path folder, std::filesystem::path key)
    : folder_(std::move(folder)), key_(std::move(key)) {
  if (!std::filesystem::is_regular_file(list_file()))
    throw Failure(ErrorCode::NotFound, list_file().string() + ": is not there");
}

std::vector<Certificate> AuthorityFolder::trusted() const {
  auto certificates = certificates_from_pem(read_file(list_file()), list_file().string());
  if (certificates.empty())
    throw Failure(ErrorCode::InvalidInput, list_file().string() + ": has no certificate");
  return certificates;
}

Key AuthorityFolder::key_of(x509_st& certificate) const {
  // By their use, not by their names: so an interrupted change is no trouble.
  const std::array<std::filesystem::path, 4> files = {key_, key_file(), previous_key_file(),
                                                      next_key_file()};
  for (const std::filesystem::path& file : files) {
    if (file.empty() || !std::filesystem::exists(file))
      continue;
    if (Key key = key_from_pem(read_file(file), file.string()); belongs_to(*key, certificate))
      return key;
  }
  throw Failure(ErrorCode::NotFound, (key_.empty() ? key_file().string() : key_.string()) +
                                         ": is not there, or not the key of '" +
                                         common_name(certificate) +
                                         "'; say where that is kept with --authority-key FILE");
}

Authority AuthorityFolder::authority(std::size_t number) const {
  auto certificates = trusted();
  Key key = key_of(*certificates.at(number));
  Authority authority{std::move(key), std::move(certificates.at(number))};
  if (certificates.size() > 1 && number == 0) {
    authority.crossed = certificates_from_pem(read_file(crossed_file()), crossed_file().string());
    if (authority.crossed.size() != 1)
      throw Failure(ErrorCode::InvalidInput,
                    crossed_file().string() + ": must have one certificate");
  }
  return authority;
}

Vouchers AuthorityFolder::vouchers(std::size_t issuer) const {
  Vouchers vouchers{authority(issuer), authority(0), trusted()};
  const auto first = vouchers.trusted.begin();
  std::rotate(first, first + static_cast<std::ptrdiff_t>(issuer), vouchers.trusted.end());
  return vouchers;
}

void AuthorityFolder::add_second(std::chrono::sys_seconds now) {
  if (has_two())
    throw Failure(ErrorCode::Conflict,
                  list_file().string() +
                      ": has two authorities already; the previous one is retired by: kinshipd "
                      "secure retire-authority");
  name_keys();
  const Authority previous = authority(0);
  const Authority next = make_new_authority(now);
  write_new_file(next_key_file(), to_pem(*next.key), Readers::Owner);
  // Never the other way round: with the previous key vouched for, its holder could sign any client
  // any permissions long after it was retired.
  replace_file(crossed_file(), to_pem(*cross(next, previous, now)), Readers::Everybody);
  replace_file(list_file(), to_pem(*next.certificate) + to_pem(*previous.certificate),
               Readers::Everybody);
  name_keys();
}

/// Names keys by their use, also after an interrupted change.
void AuthorityFolder::name_keys() const {
  if (!std::filesystem::exists(next_key_file()))
    return;
  const auto certificates = trusted();
  if (!is_key_of(next_key_file(), *certificates.front())) {
    std::filesystem::remove(next_key_file());  // unused: it never came into the list
    return;
  }
  if (std::filesystem::exists(key_file())) {
    if (std::filesystem::exists(previous_key_file()))
      throw Failure(ErrorCode::Conflict, previous_key_file().string() +
                                             ": is where ca.key has to go; keep it elsewhere");
    std::filesystem::rename(key_file(), previous_key_file());
  }
  std::filesystem::rename(next_key_file(), key_file());
}

/// Keeps the key of an authority that is to be retired under a name of its own.
/// \return that; empty if the key is kept elsewhere.
std::filesystem::path AuthorityFolder::set_aside(x509_st& certificate) const {
  const std::filesystem::path kept = folder_ / ("retired-" + fingerprint(certificate) + ".key");
  for (const auto& file : {key_file(), previous_key_file(), next_key_file()})
    if (std::filesystem::exists(file) && is_key_of(file, certificate))
      std::filesystem::rename(file, kept);
  return std::filesystem::exists(kept) ? kept : std::filesystem::path();
}

std::filesystem::path AuthorityFolder::retire_previous() {
  auto certificates = trusted();
  if (certificates.size() < 2)
    throw Failure(ErrorCode::Conflict,
                  list_file().string() +
                      ": has one authority only; another one is made by: kinshipd secure "
                      "renew-authority");
  const std::filesystem::path kept = set_aside(*certificates.back());
  name_keys();
  certificates.pop_back();
  replace_file(list_file(), list_pem(certificates), Readers::Everybody);
  std::filesystem::remove(crossed_file());
  return kept;
}

void AuthorityFolder::replace(std::chrono::sys_seconds now) {
  for (const Certificate& certificate : trusted())
    set_aside(*certificate);
  name_keys();
  const Authority next = make_new_authority(now);
  write_new_file(next_key_file(), to_pem(*next.key), Readers::Owner);
  replace_file(list_file(), to_pem(*next.certificate), Readers::Everybody);
  std::filesystem::remove(crossed_file());
  name_keys();
}

}  // namespace kinship::security
