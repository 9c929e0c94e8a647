#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <iostream>
#include <map>
#include <utility>
#include <vector>

#include "client/python/bindings.hpp"
#include "client/python/robot_names.hpp"
#include "proto/files/lines.hpp"
#include "proto/files/output_file.hpp"
#include "proto/json/experience_line.hpp"

namespace kinship::python {
namespace {

namespace py = pybind11;
using json::NamedAttempt;

/// The content of an experience file.
struct Experience {
  std::vector<std::shared_ptr<Robot>> robots;
  std::vector<NamedAttempt> attempts;
};

/// Attempts that name a robot of the file by its label are given its digest.
void name_by_digest(Experience& experience) {
  std::map<std::string, Digest> digests;
  for (const auto& robot : experience.robots)
    digests.insert_or_assign(robot->description().label, robot->digest());
  for (NamedAttempt& attempt : experience.attempts)
    if (const auto known = digests.find(attempt.label); known != digests.end()) {
      attempt.attempt.robot = known->second;
      attempt.label.clear();
    }
}

Experience read(const std::filesystem::path& file) {
  const py::gil_scoped_release unlocked;
  Experience experience;
  std::ifstream stream = files::open_input(file);
  files::for_each_line(stream, file.string(), [&](const files::Line& line) {
    try {
      const std::string text = Result<std::string>(line.text).value_or_throw();
      json::ExperienceLine parsed = json::experience_line_from_json(text).value_or_throw();
      if (auto* robot = std::get_if<RobotDescription>(&parsed))
        experience.robots.push_back(Robot::of_description(std::move(*robot)));
      else
        experience.attempts.push_back(std::get<NamedAttempt>(std::move(parsed)));
    } catch (const Failure& failure) {
      throw Failure(failure.code(), "'" + file.string() + "' line " + std::to_string(line.number) +
                                        ": " + failure.what());
    }
    return true;
  });
  name_by_digest(experience);
  return experience;
}

/// Lists, so that a change of an attempt in them stays.
py::tuple read_experience(const std::filesystem::path& file) {
  Experience experience = read(file);
  return py::make_tuple(std::move(experience.robots), std::move(experience.attempts));
}

void write_experience(const std::filesystem::path& file, const std::vector<NamedAttempt>& attempts,
                      const std::vector<std::shared_ptr<Robot>>& robots) {
  const py::gil_scoped_release unlocked;
  files::OutputFile output(file, std::cout);
  for (const auto& robot : robots)
    output.stream() << json::to_experience_line(robot->model_for_server().description) << '\n';
  for (const NamedAttempt& attempt : attempts)
    output.stream() << json::to_json(attempt_of(attempt)) << '\n';
  output.keep();
}

}  // namespace

void bind_experience(py::module_& module) {
  module.def(
      "read_experience", read_experience, py::arg("file"),
      R"(Reads an experience file, as `kinship paths export` writes it: its robots and attempts.

Raises NotFound, InvalidInput or TooLarge with the file, line and value.)");
  module.def("write_experience", write_experience, py::arg("file"), py::arg("attempts"),
             py::arg("robots") = std::vector<std::shared_ptr<Robot>>(),
             R"(Writes an experience file that `kinship paths import` takes.

robots  the ones that a server may not know yet. The file gets its name once it is whole.)");
}

}  // namespace kinship::python
