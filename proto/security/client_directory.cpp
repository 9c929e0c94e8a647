#include "proto/security/client_directory.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <tuple>

#include "proto/security/certificate_name.hpp"
#include "proto/security/private_files.hpp"
#include "proto/types/time_text.hpp"

namespace kinship::security {
namespace {

constexpr std::chrono::seconds kFreshFor{1};
constexpr std::size_t kMaxEntries = 100'000;  // of clients that were removed, too

/// Tells one content of a file from another; all zeros: there is none.
using FileMark = std::tuple<dev_t, ino_t, off_t, time_t, long, time_t, long>;

FileMark mark_of(const std::filesystem::path& file) {
  struct stat status {};
  if (stat(file.c_str(), &status) != 0)
    return {};
  return {status.st_dev,         status.st_ino,          status.st_size,
          status.st_mtim.tv_sec, status.st_mtim.tv_nsec, status.st_ctim.tv_sec,
          status.st_ctim.tv_nsec};
}

/// What both take.
Revocation merged(Revocation first, const Revocation& second) {
  if (!first.revoked)
    first.revoked = second.revoked;
  first.oldest_accepted = std::max(first.oldest_accepted, second.oldest_accepted);
  first.generation = std::max(first.generation, second.generation);
  return first;
}

bool takes_more(const Revocation& first, const Revocation& second) {
  return (first.revoked && !second.revoked) || first.oldest_accepted > second.oldest_accepted ||
         first.generation > second.generation;
}

}  // namespace

struct ClientDirectory::Entry {
  std::chrono::steady_clock::time_point checked;
  FileMark mark;
  Result<ClientRecord> record;
};

ClientDirectory::ClientDirectory(std::filesystem::path folder, Clock clock)
    : folder_(std::move(folder)), clock_(std::move(clock)) {}

ClientDirectory::~ClientDirectory() = default;

Result<ClientRecord> ClientDirectory::read(const std::filesystem::path& file,
                                           const std::string& name) const {
  try {
    Result<ClientRecord> record = read_record(read_file(file), file.string());
    if (record && record->name != name)
      return invalid_input(file.string() + ": is of '" + record->name + "'");
    return record;
  } catch (const Failure& failure) {
    if (failure.code() == ErrorCode::NotFound)
      return Error{ErrorCode::NotFound, "client '" + name + "': is not in " + folder_.string()};
    return failure.error();
  }
}

Result<ClientRecord> ClientDirectory::find(const std::string& name) const {
  return find(name, kFreshFor);
}

Result<ClientRecord> ClientDirectory::find(const std::string& name,
                                           std::chrono::seconds fresh_for) const {
  if (const auto error = check_client_name(name))
    return *error;
  const auto now = clock_();
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(name);
  if (found != entries_.end() && now - found->second->checked < fresh_for)
    return found->second->record;
  const std::filesystem::path file = folder_ / (name + ".toml");
  const FileMark mark = mark_of(file);  // before it is read: changes meanwhile are read again
  if (mark == FileMark()) {             // not kept: a certified client can ask for any name
    if (found != entries_.end())
      entries_.erase(found);
    return read(file, name);
  }
  if (found != entries_.end() && found->second->mark == mark) {
    found->second->checked = now;
    return found->second->record;
  }
  if (entries_.size() >= kMaxEntries)
    entries_.clear();
  return entries_
      .insert_or_assign(name, std::make_unique<Entry>(Entry{now, mark, read(file, name)}))
      .first->second->record;
}

Result<Caller> ClientDirectory::caller(const std::string& common_name,
                                       std::chrono::sys_seconds now) const {
  const Result<CertificateName> certificate = read_certificate_name(common_name);
  if (!certificate)
    return certificate.error();
  const std::string& name = certificate->client;
  const Result<ClientRecord> record = find(name);
  if (!record)
    return record.error();
  const Revocation taken = merged(
      {name, record->revoked, record->oldest_accepted, record->generation}, remembered(name));
  if (taken.revoked)
    return Error{ErrorCode::Unavailable,
                 "client '" + name + "': revoked at " + time_text(*taken.revoked)};
  if (record->expires <= now)
    return Error{ErrorCode::Unavailable,
                 "client '" + name + "': expired at " + time_text(record->expires)};
  if (certificate->generation < taken.oldest_accepted)
    return Error{ErrorCode::Unavailable,
                 "client '" + name + "': these credentials were replaced (" +
                     std::to_string(certificate->generation) + " of " +
                     std::to_string(taken.generation) + "), the newest ones are accepted only"};
  return caller_of(*record);
}

Revocation ClientDirectory::remembered(const std::string& name) const {
  const std::lock_guard lock(mutex_);
  const auto found = remembered_.find(name);
  return found == remembered_.end() ? Revocation{name} : found->second;
}

void ClientDirectory::remember(const Revocation& revocation) {
  const std::lock_guard lock(mutex_);
  Revocation& known = remembered_.try_emplace(revocation.client, revocation).first->second;
  known = merged(known, revocation);
}

ClientDirectory::Differences ClientDirectory::compare_records() const {
  Differences differences;
  std::error_code ignored;  // the folder need not exist yet
  for (const auto& file : std::filesystem::directory_iterator(folder_, ignored)) {
    if (file.path().extension() != ".toml")
      continue;
    const Result<ClientRecord> record = find(file.path().stem().string(), {});
    if (!record)
      continue;
    const Revocation told{record->name, record->revoked, record->oldest_accepted,
                          record->generation};
    const Revocation known = remembered(record->name);
    if (takes_more(told, known))
      differences.unknown.push_back(told);
    if (takes_more(known, told))
      differences.put_back.push_back(merged(known, told));
  }
  return differences;
}

}  // namespace kinship::security
