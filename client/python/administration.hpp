#pragma once

#include "client/python/bindings.hpp"
#include "client/python/client_handle.hpp"

namespace kinship::python {

using ClientClass = pybind11::class_<ClientHandle>;

/// Adds to Client what is asked of the server itself: listings, retiring, backups, what happens.
void bind_administration(ClientClass& client);

/// Adds the class of what is watched, which they mention.
void bind_events(pybind11::module_& module);

}  // namespace kinship::python
