#pragma once

#include <cstdint>
#include <string_view>
#include <utility>

namespace kinship::dds {

using Handle = std::int32_t;  ///< dds_entity_t of Cyclone DDS

/// Sole owner of one Cyclone DDS entity; deletes it, and its children, on destruction.
/// Keep members in creation order (participant first) so that destruction runs child to parent.
class Entity {
 public:
  /// \param handle  return value of dds_create_*.
  /// \param what    named in the message, e.g. "reader kinship/fetch/request".
  /// \throws Failure(Internal) if `handle` is a negative return code.
  Entity(Handle handle, std::string_view what);
  Entity(Entity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
  Entity& operator=(Entity&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  Entity(const Entity&) = delete;
  Entity& operator=(const Entity&) = delete;
  ~Entity();

  Handle get() const noexcept { return handle_; }

 private:
  Handle handle_;  // 0: moved from
};

/// A return value of Cyclone DDS if it is no error. \throws Failure(Internal) with `what` and the
/// code otherwise.
Handle require(Handle result, std::string_view what);

}  // namespace kinship::dds
