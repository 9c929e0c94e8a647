#include "proto/dds/entity.hpp"

#include <dds/dds.h>

#include <string>

#include "proto/types/failure.hpp"

namespace kinship::dds {

static_assert(sizeof(Handle) == sizeof(dds_entity_t));

Handle require(Handle result, std::string_view what) {
  if (result < 0)
    throw Failure(ErrorCode::Internal, std::string(what) + ": " + dds_strretcode(-result));
  return result;
}

Entity::Entity(Handle handle, std::string_view what) : handle_(require(handle, what)) {}

Entity::~Entity() {
  if (handle_ > 0)
    dds_delete(handle_);
}

}  // namespace kinship::dds
