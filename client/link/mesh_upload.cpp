#include "client/link/mesh_upload.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "proto/types/limits.hpp"

namespace kinship::link {
namespace {

/// Of a message without URDF and contents: names, solids, pairs, meshes, each as large as may be.
constexpr std::size_t kOtherBytes = 300'000;

/// Contents that the server wants, as many as a message with this URDF holds.
std::vector<MeshContent> some_of(const std::vector<MeshDigest>& wanted, const FindContent& find,
                                 std::size_t urdf_bytes) {
  std::size_t left = kMaxSampleBytes - std::min(kMaxSampleBytes, kOtherBytes + urdf_bytes);
  std::vector<MeshContent> some;
  for (const MeshDigest& each : wanted) {
    if (some.size() == kMaxContentsARequest)
      break;
    std::optional<MeshContent> content = find(each.content);
    if (!content || content->zlib.size() > left)
      continue;
    left -= content->zlib.size();
    some.push_back(*std::move(content));
  }
  return some;
}

}  // namespace

Result<RegisterReply> register_with_meshes(RobotDescription description, const FindContent& find,
                                           const RegisterOnce& register_once) {
  description.contents.clear();
  const Result<RegisterReply> first = register_once(description);
  if (!first)
    return first;
  RegisterReply last = *first;
  while (last.status != RegisterStatus::Refused && !last.wanted.empty()) {
    description.contents = some_of(last.wanted, find, description.urdf.size());
    if (description.contents.empty())
      return last;
    const Result<RegisterReply> answer = register_once(description);
    if (!answer || answer->status == RegisterStatus::Refused)
      return last;  // it is registered all the same
    RegisterReply next = *answer;
    const bool gets_on = next.wanted.size() < last.wanted.size();
    next.took_geometry |= last.took_geometry;
    if (last.status == RegisterStatus::Registered)
      next.status = RegisterStatus::Registered;
    last = std::move(next);
    if (!gets_on)
      return last;
  }
  return last;
}

}  // namespace kinship::link
