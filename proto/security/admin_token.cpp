#include "proto/security/admin_token.hpp"

#include <fcntl.h>
#include <openssl/crypto.h>
#include <openssl/rand.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <span>
#include <utility>

#include "proto/files/file.hpp"
#include "proto/security/private_files.hpp"
#include "proto/types/failure.hpp"
#include "proto/types/hex.hpp"
#include "proto/types/sha256.hpp"

namespace kinship::security {
namespace {

constexpr std::size_t kRandomBytes = 16;
constexpr std::size_t kMaxUses = 65'536;  // of a challenge

template <std::size_t size>
std::array<std::uint8_t, size> random_bytes() {
  std::array<std::uint8_t, size> bytes{};
  if (RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) != 1)
    throw Failure(ErrorCode::Internal, "no random numbers");
  return bytes;
}

std::string random_text() { return to_hex(random_bytes<kRandomBytes>()); }

/// \param random  text of the random bytes.
std::string proof_with(const Digest& token, std::string_view challenge, const std::string& random,
                       const Uuid& client_id, const AdminRequest& request) {
  const Digest body = Sha256()
                          .add(std::string_view("kinship admin proof 1"))
                          .add(challenge)
                          .add(std::string_view(random))
                          .add(std::string_view(client_id.text()))
                          .add(static_cast<std::uint64_t>(request.verb))
                          .add(std::string_view(request.argument))
                          .add(std::string_view(request.robot))
                          .add(std::string_view(request.task))
                          .add(std::string_view(request.cursor))
                          .add(std::uint64_t{request.limit})
                          .add(static_cast<std::uint64_t>(request.deadline.count()))
                          .finish();
  return random + hmac_sha256(token, body.bytes).hex();
}

bool are_equal(const std::string& one, const std::string& other) {
  return one.size() == other.size() && CRYPTO_memcmp(one.data(), other.data(), one.size()) == 0;
}

/// The beginning of a file, if nobody else can have read or written it.
std::string read_own_file(const std::filesystem::path& file) {
  const auto refuse = [&file](const std::string& why) {
    throw Failure(ErrorCode::InvalidInput, file.string() + ": " + why);
  };
  try {
    const files::File open(file, O_RDONLY | O_NONBLOCK);  // a FIFO is not waited for
    struct stat status {};
    if (fstat(open.descriptor(), &status) != 0 || !S_ISREG(status.st_mode))
      refuse("is no file with a token");
    if (status.st_uid != geteuid() && status.st_uid != 0)
      refuse("belongs to user " + std::to_string(status.st_uid) +
             ", who knows this token: a token belongs to the user that reads it, or to root");
    if ((status.st_mode & (S_IRWXG | S_IRWXO)) != 0)
      refuse("others than its owner may read this token: chmod 600, or remove it for a new one");
    std::string text(256, '\0');
    text.resize(open.read(text.data(), text.size(), 0));
    return text;
  } catch (const files::FileError& error) {
    throw Failure(error.reason() == ENOENT ? ErrorCode::NotFound : ErrorCode::Storage,
                  file.string() + ": cannot be read: " + error.reason_text());
  }
}

}  // namespace

Digest read_admin_token(const std::filesystem::path& file) {
  std::string text = read_own_file(file);
  while (!text.empty() && text.back() == '\n')
    text.pop_back();
  const std::optional<Digest> token = Digest::from_hex(text);
  if (!token)
    throw Failure(ErrorCode::InvalidInput, file.string() + ": holds no token of kinshipd");
  return *token;
}

Digest make_admin_token(const std::filesystem::path& file) {
  try {
    return read_admin_token(file);
  } catch (const Failure& failure) {
    if (failure.code() != ErrorCode::NotFound)
      throw;
  }
  if (std::error_code ignored; file.has_parent_path())
    std::filesystem::create_directories(file.parent_path(), ignored);  // the next step says why
  const Digest token{.bytes = random_bytes<32>()};
  try {
    write_new_file(file, token.hex() + '\n', Readers::Owner);
  } catch (const Failure& failure) {
    if (failure.code() != ErrorCode::Conflict)
      throw;
    return read_admin_token(file);  // of a server that starts at the same time
  }
  return token;
}

std::string prove_admin_token(const Digest& token, std::string_view challenge,
                              const Uuid& client_id, const AdminRequest& request) {
  return proof_with(token, challenge, random_text(), client_id, request);
}

AdminTokenCheck::AdminTokenCheck(const Digest& token, TimePoint now)
    : token_(token), current_{random_text(), now, {}}, last_{random_text(), now, {}} {}

std::string AdminTokenCheck::challenge(TimePoint now) {
  const std::lock_guard lock(mutex_);
  renew(now);
  return current_.challenge;
}

TokenProof AdminTokenCheck::check(const AdminRequest& request, const Uuid& client_id,
                                  const std::string& request_key, TimePoint now) {
  constexpr std::size_t kRandomDigits = 2 * kRandomBytes;
  constexpr std::chrono::minutes kSentAgain{1};
  if (request.proof.empty())
    return TokenProof::Missing;
  if (request.proof.size() != kMaxProofBytes)
    return TokenProof::Wrong;
  const std::string random = request.proof.substr(0, kRandomDigits);
  const std::lock_guard lock(mutex_);
  renew(now);
  for (Period* const period : {&current_, &last_}) {
    if (!are_equal(proof_with(token_, period->challenge, random, client_id, request),
                   request.proof))
      continue;
    const auto [use, is_new] = period->uses.try_emplace(random, Use{request_key, now});
    return is_new ||
                   (use->second.request_key == request_key && now - use->second.first <= kSentAgain)
               ? TokenProof::Shown
               : TokenProof::Wrong;
  }
  return TokenProof::Wrong;
}

void AdminTokenCheck::renew(TimePoint now) {
  constexpr std::chrono::minutes kPeriod{10};
  if (now - current_.began < kPeriod && current_.uses.size() < kMaxUses)
    return;
  last_ = std::exchange(current_, Period{random_text(), now, {}});
}

}  // namespace kinship::security
