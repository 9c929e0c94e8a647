#include "client/link/outbox.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <system_error>
#include <utility>

#include "client/link/durable_file.hpp"
#include "client/link/outbox_files.hpp"
#include "proto/files/lock_file.hpp"
#include "proto/files/new_file.hpp"
#include "proto/json/attempt_json.hpp"
#include "proto/json/robot_description_json.hpp"
#include "proto/types/failure.hpp"
#include "proto/types/hex.hpp"
#include "proto/types/limits.hpp"
#include "proto/types/store_epoch.hpp"

namespace kinship::link {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kRejected = "rejected";
constexpr std::string_view kSetAside = "set_aside";
constexpr std::string_view kRobots = "robots";
constexpr std::string_view kMeshes = "meshes";
constexpr std::string_view kSuffix = ".json";
constexpr std::size_t kMaxFileBytes = 16'000'000;
constexpr std::chrono::hours kKeepTemporary{24};

void remove_older_than(const fs::directory_entry& entry, std::chrono::hours age) {
  std::error_code error;
  const fs::file_time_type written = entry.last_write_time(error);
  if (!error && fs::file_time_type::clock::now() - written > age)
    fs::remove(entry.path(), error);
  // Whatever failed here is tried again at the next purge.
}

/// \return as a value: TooLarge for a file that cannot be ours, Storage for one that cannot be
/// read.
Result<std::string> read_limited(const fs::path& path) {
  try {
    return read_file(path, kMaxFileBytes);
  } catch (const Failure& failure) {
    return failure.error();
  }
}

/// A content as a file: the number of its bytes in little endian, then the zlib stream.
std::string file_text(const MeshContent& content) {
  std::string text;
  for (unsigned shift = 0; shift < 32; shift += 8)
    text.push_back(static_cast<char>((content.bytes >> shift) & 0xffU));
  text.append(content.zlib.begin(), content.zlib.end());
  return text;
}

/// \return nothing if it is not that content.
std::optional<MeshContent> content_of(std::string_view text, const Digest& digest) {
  if (text.size() < 4)
    return std::nullopt;
  MeshContent content;
  for (unsigned i = 0; i < 4; ++i)
    content.bytes |= std::uint32_t{static_cast<std::uint8_t>(text[i])} << (8 * i);
  content.zlib.assign(text.begin() + 4, text.end());
  const auto mesh = TriangleMesh::read(content);
  if (!mesh || mesh->digest() != digest)
    return std::nullopt;
  return content;
}

bool is_missing(const fs::path& path) {
  std::error_code error;
  return fs::symlink_status(path, error).type() == fs::file_type::not_found;
}

}  // namespace

Outbox::Outbox(fs::path folder, Resend resend)
    : folder_(std::move(folder)), resend_(resend), sent_(folder_), others_(folder_) {
  for (const std::string_view part : {kPending, kRejected, kRobots})
    make_folder_durably(folder_ / part);
  if (resend_ == Resend::None)
    for (const Uuid& report : reports_in(kPending))
      reported_before_.insert(report);
}

fs::path Outbox::file(std::string_view part, const Uuid& report_uuid) const {
  return folder_ / part / report_file_name(report_uuid);
}

fs::path Outbox::reason_file(std::string_view part, const Uuid& report_uuid) const {
  return folder_ / part / (report_uuid.text() + ".reason.txt");
}

void Outbox::add(const Attempt& attempt) {
  write_durably(file(kPending, attempt.report_uuid), json::to_json(attempt) + "\n");
}

std::size_t Outbox::pending_count(const std::set<Uuid>& without) const {
  std::size_t count = 0;
  for_each_entry(folder_ / kPending, [&](const fs::directory_entry& entry) {
    const auto uuid = report_uuid_of(entry.path());
    std::error_code error;
    if (uuid && !without.contains(*uuid) && entry.is_regular_file(error))
      ++count;
  });
  return count;
}

std::vector<Uuid> Outbox::pending() const {
  std::vector<std::pair<fs::file_time_type, Uuid>> found;
  for_each_entry(folder_ / kPending, [&](const fs::directory_entry& entry) {
    const auto uuid = report_uuid_of(entry.path());
    std::error_code error;
    const fs::file_time_type written = entry.last_write_time(error);  // min() of a dangling link
    if (uuid)
      found.emplace_back(written, *uuid);
  });
  std::sort(found.begin(), found.end());
  std::vector<Uuid> uuids;
  for (const auto& [written, uuid] : found)
    uuids.push_back(uuid);
  return uuids;
}

Result<Attempt> Outbox::read(const Uuid& report_uuid) const {
  const fs::path path = file(kPending, report_uuid);
  std::error_code error;
  if (!fs::exists(fs::symlink_status(path, error)))
    return Error{ErrorCode::NotFound, path.string() + ": is gone"};
  const auto text = read_limited(path);
  if (!text)
    return text.error();
  auto named = json::attempt_from_json(*text);
  if (!named)
    return Error{named.error().code, "damaged file: " + named.error().message};
  if (!named->label.empty())
    return Error{ErrorCode::InvalidInput, "damaged file: the robot is not named by digest"};
  if (named->attempt.report_uuid != report_uuid)
    return Error{ErrorCode::InvalidInput, "damaged file: report_uuid is not that of its name"};
  return std::move(named).value().attempt;
}

void Outbox::mark_sent(const Uuid& report_uuid) {
  // No fsync: a report that is back in pending after a power cut is answered "duplicate".
  move_file(file(kPending, report_uuid), sent_.file(report_uuid));
}

void Outbox::put_away(std::string_view part, const Uuid& report_uuid, std::string_view reason) {
  make_folder_durably(folder_ / part);
  write_durably(reason_file(part, report_uuid), std::string(reason) + "\n");
  move_file(file(kPending, report_uuid), file(part, report_uuid));
}

void Outbox::reject(const Uuid& report_uuid, std::string_view reason) {
  put_away(kRejected, report_uuid, reason);
}

void Outbox::set_aside(const Uuid& report_uuid, std::string_view reason) {
  put_away(kSetAside, report_uuid, reason);
}

std::vector<Uuid> Outbox::reports_in(std::string_view part) const {
  std::vector<Uuid> reports;
  if (is_missing(folder_ / part))
    return reports;
  for_each_entry(folder_ / part, [&](const fs::directory_entry& entry) {
    if (const auto uuid = report_uuid_of(entry.path()))
      reports.push_back(*uuid);
  });
  std::sort(reports.begin(), reports.end());
  return reports;
}

std::vector<Uuid> Outbox::reports_set_aside() const { return reports_in(kSetAside); }

std::vector<Uuid> Outbox::reports_rejected() const { return reports_in(kRejected); }

bool Outbox::resend(const Uuid& report_uuid) {
  for (const std::string_view part : {kSetAside, kRejected})
    if (move_file(file(part, report_uuid), file(kPending, report_uuid))) {
      std::error_code error;  // a reason without its report is not looked at
      fs::remove(reason_file(part, report_uuid), error);
      return true;
    }
  return false;
}

bool Outbox::drop(const Uuid& report_uuid) {
  for (const std::string_view part : {kSetAside, kRejected}) {
    std::error_code error;
    if (!fs::remove(file(part, report_uuid), error)) {
      if (error)
        throw Failure(ErrorCode::Storage,
                      file(part, report_uuid).string() + ": cannot be deleted: " + error.message());
      continue;
    }
    fs::remove(reason_file(part, report_uuid), error);
    return true;
  }
  return false;
}

std::vector<OutboxEntry> Outbox::entries() const {
  std::vector<OutboxEntry> entries;
  for (const Uuid& uuid : reports_in(kPending)) {
    const Result<Attempt> attempt = read(uuid);
    if (attempt || attempt.error().code != ErrorCode::NotFound)
      entries.push_back({fs::path(kPending) / report_file_name(uuid), "pending",
                         attempt ? "" : attempt.error().message});
  }
  for (const auto& [part, state] : {std::pair(kRejected, "rejected"), {kSetAside, "set aside"}})
    for (const Uuid& uuid : reports_in(part)) {
      const Result<std::string> why = read_limited(reason_file(part, uuid));
      entries.push_back({fs::path(part) / report_file_name(uuid), state,
                         why ? why->substr(0, why->find('\n')) : why.error().message});
    }
  for (const KeptReports& kept : others_.kept())
    entries.push_back({fs::path(OtherStores::kFolder) / kept.store, "kept",
                       std::to_string(kept.reports) + " reports of this older store"});
  return entries;
}

void Outbox::keep_robot(const Digest& robot, const RobotDescription& description) {
  RobotDescription kept = description;
  // A server that does not know the robot yet shall get its known meshes, too.
  if (kept.mesh_solids.solids.empty() || kept.meshes.empty())
    if (const auto before = this->robot(robot); before && before->urdf == description.urdf) {
      if (kept.mesh_solids.solids.empty())
        kept.mesh_solids = before->mesh_solids;
      if (kept.meshes.empty())
        kept.meshes = before->meshes;
    }
  if (!description.contents.empty())
    make_folder_durably(folder_ / kMeshes);
  for (const MeshContent& content : description.contents)  // before what names them
    if (const auto mesh = TriangleMesh::read(content))
      write_durably(folder_ / kMeshes / mesh->digest().hex(), file_text(content));
  write_durably(folder_ / kRobots / (robot.hex() + std::string(kSuffix)),
                json::to_json(kept) + "\n");
}

void Outbox::forget_meshes(const Digest& robot) {
  const Result<RobotDescription> known = this->robot(robot);
  if (!known || known->meshes.empty())
    return;
  drop_contents_of({robot});
  RobotDescription kept = *known;
  kept.meshes.clear();
  write_durably(folder_ / kRobots / (robot.hex() + std::string(kSuffix)),
                json::to_json(kept) + "\n");
}

std::optional<MeshContent> Outbox::content(const Digest& content) const {
  const fs::path path = folder_ / kMeshes / content.hex();
  std::error_code error;
  if (!fs::exists(path, error))
    return std::nullopt;
  const Result<std::string> text = read_limited(path);
  return text ? content_of(*text, content) : std::nullopt;
}

void Outbox::drop_contents(const RobotDescription& description) const {
  std::error_code error;  // what stays is offered again
  for (const LinkMesh& mesh : description.meshes)
    fs::remove(folder_ / kMeshes / mesh.content.hex(), error);
}

std::vector<Digest> Outbox::robots_with_contents() const {
  std::vector<Digest> robots;
  std::error_code error;
  if (is_missing(folder_ / kMeshes) || fs::is_empty(folder_ / kMeshes, error))
    return robots;
  for (const auto& [robot, description] : kept_robots())
    if (std::ranges::any_of(description.meshes, [&](const LinkMesh& mesh) {
          return fs::exists(folder_ / kMeshes / mesh.content.hex(), error);
        }))
      robots.push_back(robot);
  return robots;
}

/// Those whose files can be read.
std::map<Digest, RobotDescription> Outbox::kept_robots() const {
  std::map<Digest, RobotDescription> robots;
  for_each_entry(folder_ / kRobots, [&](const fs::directory_entry& entry) {
    if (const auto digest = Digest::from_hex(entry.path().stem().string()))
      if (auto description = robot(*digest))
        robots.emplace(*digest, std::move(description).value());
  });
  return robots;
}

/// But not what a robot names that is none of them.
void Outbox::drop_contents_of(const std::set<Digest>& robots) const {
  std::set<Digest> dropped, kept;
  for (const auto& [robot, description] : kept_robots())
    for (const LinkMesh& mesh : description.meshes)
      (robots.contains(robot) ? dropped : kept).insert(mesh.content);
  std::error_code error;  // what stays is offered again
  for (const Digest& content : dropped)
    if (!kept.contains(content))
      fs::remove(folder_ / kMeshes / content.hex(), error);
}

Result<RobotDescription> Outbox::robot(const Digest& robot) const {
  const fs::path path = folder_ / kRobots / (robot.hex() + std::string(kSuffix));
  std::error_code error;
  if (!fs::exists(path, error))
    return Error{ErrorCode::NotFound,
                 "no description of robot " + robot.short_hex() + " is kept; register it first"};
  const auto text = read_limited(path);
  if (!text)
    return text.error();
  auto description = json::robot_description_from_json(*text);
  if (!description)
    return Error{description.error().code,
                 path.string() + ": damaged file: " + description.error().message};
  return description;
}

/// \return the epoch in which `to` was known; empty: never. Ended before the epoch is written, it
/// all happens again.
std::optional<Uuid> Outbox::change_store(const Uuid& from, const Uuid& to) const {
  others_.put_away(from);
  const std::optional<Uuid> known = others_.known_epoch(to);
  if (!known && resend_ == Resend::None)
    others_.hold_back(from, reported_before_);
  if (!known)
    drop_contents_without_reports();
  write_durably(folder_ / kEpoch, known.value_or(to).text() + "\n");
  return known;
}

/// Of robots that a store never seen is not to get: sending contents registers them.
void Outbox::drop_contents_without_reports() const {
  const std::vector<Digest> with_contents = robots_with_contents();
  if (with_contents.empty())
    return;
  std::set<Digest> robots(with_contents.begin(), with_contents.end());
  for (const Uuid& uuid : pending())
    if (const Result<Attempt> attempt = read(uuid))
      robots.erase(attempt->robot);
  drop_contents_of(robots);
}

std::size_t Outbox::resend_sent() const {
  std::size_t offered = 0;
  sent_.for_each([&](const fs::path& report) {
    offered += move_file(report, folder_ / kPending / report.filename()) ? 1U : 0U;
  });
  return offered;
}

bool Outbox::note_store(const Uuid& epoch, const ConsistencyToken& token) {
  std::optional<Uuid> known = noted_epoch(folder_);
  if (known && !is_same_store(*known, epoch))
    known = change_store(*known, epoch).value_or(epoch);
  others_.bring_back(epoch);
  bool is_any_offered = resend_ == Resend::All && others_.offer_again() > 0;
  if (known != epoch) {
    if (known)  // else this outbox has never had a receipt
      is_any_offered |= resend_sent() > 0;
    write_durably(folder_ / kEpoch, epoch.text() + "\n");  // last, as above
  }
  if (!token.empty() && token != known_token()) {
    try {
      write_whole(folder_ / kToken, to_hex(token) + "\n");
    } catch (const Failure&) {
      // A full disk must not keep receipts from being noted: an older token says less, nothing
      // wrong.
    }
  }
  return is_any_offered;
}

std::size_t Outbox::resend_acknowledged() { return others_.offer_again() + resend_sent(); }

std::size_t Outbox::drop_of_older_stores(const std::vector<KeptReports>& stores) {
  const auto lock = try_to_become_sender(folder_);
  if (!lock)
    throw Failure(ErrorCode::Unavailable, "outbox '" + folder_.string() + "': process " +
                                              sender_of(folder_) +
                                              " sends from it; end it first, nothing was deleted");
  return others_.drop(stores);
}

std::vector<KeptReports> Outbox::kept_beside(const Uuid& epoch) const {
  std::vector<KeptReports> kept = others_.kept();
  std::erase_if(kept, [&](const KeptReports& each) { return each.store == store_name(epoch); });
  const std::optional<Uuid> known = noted_epoch(folder_);
  if (!known || is_same_store(*known, epoch))
    return kept;
  KeptReports acknowledged{store_name(*known)};
  sent_.for_each([&](const fs::path&) { ++acknowledged.reports; });
  if (acknowledged.reports > 0)
    kept.push_back(std::move(acknowledged));
  return kept;
}

bool Outbox::has_receipts() const {
  std::error_code error;
  return fs::exists(folder_ / kEpoch, error);
}

ConsistencyToken Outbox::known_token() const {
  const fs::path path = folder_ / kToken;
  std::error_code error;
  if (!fs::exists(path, error))
    return {};
  const std::string text = read_file(path, 1024);
  const std::string_view digits = std::string_view(text).substr(0, text.find('\n'));
  ConsistencyToken token(std::min(digits.size() / 2, kMaxConsistencyTokenBytes));
  return parse_hex(digits, token) ? token : ConsistencyToken{};
}

void Outbox::age(std::chrono::milliseconds sending) {
  sent_.make_folders();  // a rotating process may have been killed in between
  sent_.age(sending);
  others_.age(sending);
  for (const fs::path& folder : {folder_ / kPending, folder_ / kRejected, folder_ / kSetAside,
                                 folder_ / kRobots, folder_ / kMeshes, folder_})
    if (!is_missing(folder))
      for_each_entry(folder, [](const fs::directory_entry& entry) {
        if (files::is_part(entry.path()))
          remove_older_than(entry, kKeepTemporary);
      });
}

fs::path default_outbox_folder(std::uint32_t domain, std::string_view server) {
  std::string name = "domain-" + std::to_string(domain) + "@" + std::string(server);
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == '/' || c == '\0'; }, '_');
  for (const auto& [variable, below] :
       {std::pair("XDG_STATE_HOME", ""), std::pair("HOME", ".local/state")}) {
    const char* value = std::getenv(variable);
    if (value && fs::path(value).is_absolute())  // the XDG specification ignores relative ones
      return fs::path(value) / below / "kinship" / "outbox" / name;
  }
  throw Failure(ErrorCode::InvalidInput,
                "outbox: neither XDG_STATE_HOME nor HOME is an absolute path; name a folder for "
                "reports (" +
                    std::string(kOutboxOptions) + ")");
}

}  // namespace kinship::link
