#include "server/catalog/experience_reply.hpp"

#include <memory>
#include <utility>

#include "proto/types/limits.hpp"

namespace kinship::catalog {
namespace {

bool carries_experience(FetchStatus status) {
  return status != FetchStatus::Refused && status != FetchStatus::Busy;
}

/// Bytes of a mixture in a message.
std::size_t bytes_of(const Mixture& mixture) {
  const auto dof = static_cast<std::size_t>(mixture.dimension());
  const auto components = static_cast<std::size_t>(mixture.weights().size());
  const std::size_t covariances = mixture.shares_covariance() ? 1 : components;
  return sizeof(double) * (components * (1 + dof) + covariances * dof * (dof + 1) / 2);
}

/// \param known  the revision that the client holds.
void send(const FetchReply& reply, const SharedChoice& choice, std::uint64_t known,
          const FetchDone& done) {
  if (!choice)
    return done(reply);
  const fitting::ExperienceChoice sent = shortened(*choice, room_for_experience(reply));
  if (sent.revision == known || (sent.paths.empty() && known == 0))
    return done(reply);
  FetchReply with = reply;
  with.experience = to_experience(sent);
  done(with);
}

}  // namespace

std::size_t room_for_experience(const FetchReply& reply) {
  // Upper bounds of the bytes in a message of a distribution's members, with its texts.
  constexpr std::size_t kTexts = 16 * 1024, kSource = 384, kRecent = 32, kSelected = 32;
  // Sixteen costs of up to 48 bytes, a message of up to 2048, and the rest.
  constexpr std::size_t kRehearsal = 3072;
  std::size_t used = kTexts + (reply.rehearsal ? kRehearsal : 0) +
                     (reply.recall ? recall_bytes(*reply.recall) : 0);
  if (reply.distribution) {
    const Distribution& distribution = *reply.distribution;
    used += kSource * distribution.sources.size() + kRecent * distribution.advice.recent.size() +
            kSelected * distribution.selection.sources.size();
    if (distribution.mixture)
      used += bytes_of(*distribution.mixture);
  }
  return used < kMaxSampleBytes ? kMaxSampleBytes - used : 0;
}

FetchDone with_experience(ExperienceIndex& experience_index, const FetchRequest& request,
                          FetchDone done) {
  ExperienceKey key{request.task, request.selection.sources, request.selection.since_ms,
                    request.experience_bytes};
  if (!experience_index.find(key))
    experience_index.ask(key, [](const SharedChoice&) {});
  return [&experience_index, key = std::move(key), known = request.known_experience,
          done = std::move(done)](const FetchReply& reply) {
    if (!carries_experience(reply.status))
      return done(reply);
    if (const SharedChoice choice = experience_index.find(key))
      return send(reply, choice, known, done);
    experience_index.ask(key, [own = std::make_shared<const FetchReply>(reply), known, done](
                                  const SharedChoice& choice) { send(*own, choice, known, done); });
  };
}

}  // namespace kinship::catalog
