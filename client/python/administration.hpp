#pragma once

#include "client/python/bindings.hpp"
#include "client/python/client_handle.hpp"

namespace kinship::python {

using ClientClass = pybind11::class_<ClientHandle>;

/// Adds the administration of the server to Client: listings, retiring, backups, events.
void bind_administration(ClientClass& client);

/// Adds the class Events, which the methods of Client mention.
void bind_events(pybind11::module_& module);

}  // namespace kinship::python
