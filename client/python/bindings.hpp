#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <string>
#include <variant>

#include "client/python/robot.hpp"
#include "proto/json/attempt_json.hpp"

namespace kinship::python {

/// Adds the classes of one topic to the module; module.cpp calls them in the order of their
/// dependencies.
void bind_robots(pybind11::module_& module);
void bind_scenes(pybind11::module_& module);
void bind_worlds(pybind11::module_& module);
void bind_distributions(pybind11::module_& module);
void bind_attempts(pybind11::module_& module);
void bind_experience(pybind11::module_& module);
void bind_planning(pybind11::module_& module);
void bind_client(pybind11::module_& module);

/// A robot as a Python argument: the object, its digest (64 hexadecimal digits) or a label.
using RobotName = std::variant<std::shared_ptr<Robot>, std::string>;

}  // namespace kinship::python
