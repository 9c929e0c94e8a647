#include "client/python/administration.hpp"

#include <pybind11/stl.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "client/link/admin_rows.hpp"
#include "client/python/arrays.hpp"
#include "client/python/errors.hpp"
#include "client/python/event_stream.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "proto/json/event_json.hpp"
#include "proto/types/enum_text.hpp"

namespace kinship::python {
namespace {

py::object parsed(const std::string& document) {
  return py::module_::import("json").attr("loads")(document);
}

/// The rows of a verb, as Python objects.
py::list rows_of(const ClientHandle& client, AdminVerb verb, const std::string& argument = {}) {
  AdminRequest request;
  request.verb = verb;
  request.argument = argument;
  const std::vector<std::string> rows = client
                                            .wait_for<Result<std::vector<std::string>>>(
                                                [request = std::move(request)](link::Client& line) {
                                                  return link::rows_of(line, request);
                                                })
                                            .value_or_throw();
  py::list documents;
  for (const std::string& row : rows)
    documents.append(parsed(row));
  return documents;
}

/// The one row of a verb that is about one thing.
py::object row_of(const ClientHandle& client, AdminVerb verb, const std::string& argument = {}) {
  py::list rows = rows_of(client, verb, argument);
  if (rows.empty())
    raise_error("InternalError", "the server answered without a row");
  return rows[0];
}

/// \throws the exception of a job that did not come to its end.
void require_done(const Job& job) {
  const std::string about = "job " + job.id + ", " + job.verb + " " + job.argument + ": ";
  if (!link::has_ended(job))
    raise_error("NotReady", about + "goes on at the deadline");
  if (job.state != JobState::Done)
    raise_error("Error", about + std::string(to_text(job.state)) + ": " + job.message);
}

py::object backup(const ClientHandle& client, const std::string& name, double deadline) {
  AdminRequest request;
  request.verb = AdminVerb::Backup;
  request.argument = name;
  const auto until = std::chrono::steady_clock::now() + to_milliseconds(deadline, "deadline");
  Job job = client
                .wait_for<Result<Job>>([request = std::move(request)](link::Client& line) {
                  return link::row_of<Job>(line, request);
                })
                .value_or_throw();
  while (!link::has_ended(job) && std::chrono::steady_clock::now() < until) {
    const auto slice = std::min(until, std::chrono::steady_clock::now() + std::chrono::seconds(1));
    job = client
              .wait_for<Result<Job>>([id = job.id, slice](link::Client& line) {
                return link::wait_for_job(line, id, slice);
              })
              .value_or_throw();
  }
  require_done(job);
  return parsed(json::to_document(job));
}

/// The next event; StopIteration once the stream is closed.
py::object next_of(EventStream& events) {
  std::optional<Event> event;
  bool is_closed = false;
  wait_until([&](std::chrono::milliseconds slice) {
    event = events.take(slice);
    is_closed = !event && events.is_closed();
    return event || is_closed;
  });
  if (is_closed)
    throw py::stop_iteration();
  return parsed(json::to_json(*event));
}

}  // namespace

void bind_events(py::module_& module) {
  py::class_<EventStream>(module, "Events",
                          "What happens at a server, as it happens: an iterator that ends when it "
                          "is closed. Keeps the newest 10000 that nobody has taken.")
      .def(
          "__iter__", [](py::object self) { return self; }, "Itself.")
      .def("__next__", next_of, "Waits for the next event: a dict as `kinship watch --json`.")
      .def_property_readonly("dropped", &EventStream::dropped,
                             "Events that were not taken in time.")
      .def("close", &EventStream::close, py::call_guard<py::gil_scoped_release>(), "Ends it.")
      .def(
          "__enter__", [](py::object self) { return self; }, "Itself.")
      .def(
          "__exit__",
          [](EventStream& self, const py::args&) {
            const py::gil_scoped_release unlocked;
            self.close();
          },
          "Closes it.");
}

void bind_administration(ClientClass& client) {
  client
      .def(
          "status", [](const ClientHandle& self) { return row_of(self, AdminVerb::Status); },
          "What the server says of itself, as `kinship status --json`.")
      .def(
          "robots", [](const ClientHandle& self) { return rows_of(self, AdminVerb::ListRobots); },
          "The robots that the server knows, as `kinship robots list --json`.")
      .def(
          "tasks", [](const ClientHandle& self) { return rows_of(self, AdminVerb::ListTasks); },
          "The tasks that it has experience of, as `kinship tasks list --json`.")
      .def(
          "retire",
          [](const ClientHandle& self, const std::string& path) {
            return row_of(self, AdminVerb::RetirePath, path);
          },
          py::arg("path"),
          "Takes a path, by its report_uuid, out of every fit, as `kinship paths retire --yes`. "
          "Returns task, paths and robots; raises NotFound.")
      .def(
          "restore",
          [](const ClientHandle& self, const std::string& path) {
            return row_of(self, AdminVerb::RestorePath, path);
          },
          py::arg("path"),
          "Stores a retired path anew, as `kinship paths restore`. Returns task, paths, in_use, "
          "lost, report_uuid and reason; raises NotFound.")
      .def(
          "reset",
          [](const ClientHandle& self, const std::string& task) {
            return row_of(self, AdminVerb::ResetTask, task);
          },
          py::arg("task"), "Retires every path of a task, as `kinship tasks reset --yes`.")
      .def("backup", backup, py::arg("name"), py::kw_only(), py::arg("deadline") = 3600.0,
           R"(Copies the store of the running server into a new file, as `kinship backup`.

name      bare, of a file in the server's folder of backups that is not there yet
deadline  so long its end is waited for, s

Returns the job; raises NotReady if it goes on, InvalidInput if the server does not take the name.)")
      .def(
          "watch",
          [](const ClientHandle& self) {
            const std::shared_ptr<link::Client> line = self.line();
            const py::gil_scoped_release unlocked;
            return std::make_unique<EventStream>(*line);
          },
          "Hears of reports, fetches, fits and refusals from now on: Events to iterate over. May "
          "outlive the client.");
}

}  // namespace kinship::python
