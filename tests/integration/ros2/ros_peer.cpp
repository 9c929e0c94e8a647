// A ROS 2 node as far as kinshipd sees it: rosidl's messages over a middleware of ROS. Each verb
// prints what is answered, one line each, and ends with 0; with 1 if nothing is answered.

#include <messages.h>
#include <ros_messages.h>
#include <rosidl_runtime_c/primitives_sequence_functions.h>
#include <rosidl_runtime_c/string_functions.h>
#include <trajectory_msgs/msg/detail/joint_trajectory_point__functions.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <copies.hpp>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/integration/ros2/transport.hpp"
#include "tests/support/ros2/message_cdr.hpp"

namespace kinship::test {
namespace {

using Clock = std::chrono::steady_clock;
using Bytes = std::vector<std::uint8_t>;
using Words = std::vector<std::string>;

std::chrono::seconds patience{30};  // option of each verb
constexpr std::chrono::seconds kResend{1};

/// A type's names in C, of rosidl and of idlc.
#define KINSHIP_TYPE(KIND, NAME)                                                                   \
  struct NAME {                                                                                    \
    using Ros = kinship_msgs__##KIND##__##NAME;                                                    \
    using Wire = kinship_msgs_##KIND##_dds__##NAME##_;                                             \
    static const rosidl_message_type_support_t* support() {                                        \
      return ROSIDL_TYPESUPPORT_INTERFACE__MESSAGE_SYMBOL_NAME(rosidl_typesupport_introspection_c, \
                                                               kinship_msgs, KIND, NAME)();        \
    }                                                                                              \
    static TopicType type() {                                                                      \
      return {"kinship_msgs::" #KIND "::dds_::" #NAME "_",                                         \
              &kinship_msgs_##KIND##_dds__##NAME##__desc};                                         \
    }                                                                                              \
    static void init(Ros& message) { kinship_msgs__##KIND##__##NAME##__init(&message); }           \
  };
KINSHIP_TYPE(msg, Registration)
KINSHIP_TYPE(msg, Registered)
KINSHIP_TYPE(msg, PlannedPath)
KINSHIP_TYPE(msg, Receipt)
KINSHIP_TYPE(msg, DistributionQuery)
KINSHIP_TYPE(msg, DistributionAnswer)
KINSHIP_TYPE(msg, Distribution)
KINSHIP_TYPE(msg, StatusQuery)
KINSHIP_TYPE(msg, Status)
KINSHIP_TYPE(srv, Report_Request)
KINSHIP_TYPE(srv, Report_Response)
KINSHIP_TYPE(srv, Fetch_Request)
KINSHIP_TYPE(srv, Fetch_Response)
#undef KINSHIP_TYPE

template <typename Type>
typename Type::Ros made() {
  typename Type::Ros message{};  // what has no default is not initialised by the next line
  Type::init(message);
  return message;
}

void set(rosidl_runtime_c__String& to, const std::string& text) {
  rosidl_runtime_c__String__assignn(&to, text.data(), text.size());
}

std::string hex(const std::uint8_t* bytes, std::size_t size) {
  std::string text;
  for (std::size_t i = 0; i < size; ++i) {
    char digits[3];
    std::snprintf(digits, sizeof digits, "%02x", bytes[i]);
    text += digits;
  }
  return text;
}

void read_hex(const std::string& text, std::uint8_t* bytes) {
  for (std::size_t i = 0; 2 * i + 1 < text.size(); ++i)
    bytes[i] = static_cast<std::uint8_t>(std::stoul(text.substr(2 * i, 2), nullptr, 16));
}

void make_uuid(std::uint8_t* bytes) {
  std::random_device random;
  for (int i = 0; i < 16; ++i)
    bytes[i] = static_cast<std::uint8_t>(random());
}

/// Words of the command line: "name=value".
class Options {
 public:
  explicit Options(Words words) : words_(std::move(words)) {}

  std::string text(const std::string& name, const std::string& otherwise = "") const {
    for (const std::string& word : words_)
      if (word.starts_with(name + "="))
        return word.substr(name.size() + 1);
    return otherwise;
  }
  long number(const std::string& name, long otherwise) const {
    return std::stol(text(name, std::to_string(otherwise)));
  }

 private:
  Words words_;
};

/// A question and its answer by two topics, sent again each second as the messages ask for.
template <typename Question, typename Answer>
std::optional<typename Answer::Ros> ask(Transport& node, const std::string& question_topic,
                                        const std::string& answer_topic,
                                        const typename Question::Ros& question) {
  const int writer = node.open_writer("rt/kinship/" + question_topic, Question::type());
  const int reader = node.open_reader("rt/kinship/" + answer_topic, Answer::type(), false);
  const auto deadline = Clock::now() + patience;
  if (!node.wait_for_writer_match(writer, deadline) ||
      !node.wait_for_reader_match(reader, deadline))
    return std::nullopt;
  typename Question::Wire wire{};
  copy(question, wire);
  const Outgoing outgoing{&wire, to_cdr(Question::support(), &question)};
  while (Clock::now() < deadline) {
    node.write(writer, outgoing);
    const auto resend = Clock::now() + kResend;
    while (const auto bytes = node.take(reader, resend)) {
      auto answer = made<Answer>();
      from_cdr(Answer::support(), *bytes, &answer);
      if (std::memcmp(answer.uuid.uuid, question.uuid.uuid, sizeof answer.uuid.uuid) != 0)
        continue;
      node.close_writer(writer);  // as rclpy's destroy_publisher()
      return answer;
    }
  }
  return std::nullopt;
}

/// A service's call as rmw_cyclonedds makes it.
template <typename Request, typename Response>
std::optional<typename Response::Ros> call(Transport& node, const std::string& service,
                                           const typename Request::Ros& request) {
  const int writer = node.open_writer("rq/kinship/" + service + "Request", Request::type());
  const int reader = node.open_reader("rr/kinship/" + service + "Reply", Response::type(), false);
  const auto deadline = Clock::now() + patience;
  if (!node.wait_for_writer_match(writer, deadline) ||
      !node.wait_for_reader_match(reader, deadline))
    return std::nullopt;
  typename Request::Wire wire{};
  copy(request, wire);
  std::random_device random;
  wire.guid = (std::uint64_t{random()} << 32U) | random();
  wire.sequence_number = 7;
  Bytes identity(16);
  std::memcpy(identity.data(), &wire.guid, 8);
  std::memcpy(identity.data() + 8, &wire.sequence_number, 8);
  node.write(writer, {&wire, {}});
  while (const auto bytes = node.take(reader, deadline)) {
    if (bytes->size() < 20 || !std::equal(identity.begin(), identity.end(), bytes->begin() + 4))
      continue;  // another client's
    Bytes message(bytes->begin(), bytes->begin() + 4);
    message.insert(message.end(), bytes->begin() + 20, bytes->end());
    auto response = made<Response>();
    from_cdr(Response::support(), message, &response);
    return response;
  }
  return std::nullopt;
}

int none() {
  std::cout << "no answer" << std::endl;
  return 1;
}

int register_robot(Transport& node, const Options& options) {
  auto question = made<Registration>();
  make_uuid(question.uuid.uuid);
  std::ifstream file(options.text("urdf"));
  set(question.urdf, std::string(std::istreambuf_iterator<char>(file), {}));
  set(question.label, options.text("label"));
  set(question.base_link, options.text("base"));
  set(question.tip_link, options.text("tip"));
  const auto answer = ask<Registration, Registered>(node, "register", "registered", question);
  if (!answer)
    return none();
  std::cout << "registered " << int{answer->status} << ' ' << hex(answer->robot, 32) << ' ';
  for (std::size_t i = 0; i < answer->joint_names.size; ++i)
    std::cout << (i > 0 ? "," : "") << answer->joint_names.data[i].data;
  std::cout << ' ' << answer->message.data << std::endl;
  return 0;
}

/// Options: robot, task, joints, points, uuid, extra (numbers of effort a point).
PlannedPath::Ros path_of(const Options& options) {
  auto path = made<PlannedPath>();
  make_uuid(path.uuid.uuid);
  read_hex(options.text("uuid"), path.uuid.uuid);
  read_hex(options.text("robot"), path.robot);
  set(path.task, options.text("task", "shelf"));
  set(path.planner, "a ROS planner");
  path.planning_time = 0.5;
  path.collision_checks = 1000;
  path.outcome = kinship_msgs__msg__PlannedPath__SOLVED;
  Words joints;
  for (std::string rest = options.text("joints"); !rest.empty();) {
    const std::size_t end = std::min(rest.find(','), rest.size());
    joints.push_back(rest.substr(0, end));
    rest = rest.substr(std::min(end + 1, rest.size()));
  }
  std::reverse(joints.begin(), joints.end());  // another order than the chain's
  rosidl_runtime_c__String__Sequence__init(&path.trajectory.joint_names, joints.size());
  for (std::size_t i = 0; i < joints.size(); ++i)
    set(path.trajectory.joint_names.data[i], joints[i]);
  const auto points = static_cast<std::size_t>(options.number("points", 12));
  const auto extra = static_cast<std::size_t>(options.number("extra", 0));
  trajectory_msgs__msg__JointTrajectoryPoint__Sequence__init(&path.trajectory.points, points);
  std::mt19937 generator(static_cast<unsigned>(options.number("seed", 1)));
  std::uniform_real_distribution<double> offset(-0.2, 0.2);
  const double phase = offset(generator);
  for (std::size_t i = 0; i < points; ++i) {
    trajectory_msgs__msg__JointTrajectoryPoint& point = path.trajectory.points.data[i];
    rosidl_runtime_c__double__Sequence__init(&point.positions, joints.size());
    for (std::size_t j = 0; j < joints.size(); ++j)
      point.positions.data[j] = phase + 0.5 * std::sin(0.1 * static_cast<double>(i * (j + 1)));
    rosidl_runtime_c__double__Sequence__init(&point.effort, extra);
    point.time_from_start.sec = static_cast<std::int32_t>(i);
  }
  return path;
}

void print(const kinship_msgs__msg__Receipt& receipt) {
  std::cout << "receipt " << int{receipt.status} << ' ' << hex(receipt.store_epoch.uuid, 16) << ' '
            << receipt.message.data << std::endl;
}

int report(Transport& node, const Options& options) {
  const auto answer = ask<PlannedPath, Receipt>(node, "report", "receipt", path_of(options));
  if (!answer)
    return none();
  print(*answer);
  return 0;
}

/// Reports without an end, each another one, as fast as the middleware takes them.
int flood(Transport& node, const Options& options) {
  const int writer = node.open_writer("rt/kinship/report", PlannedPath::type());
  const int reader = node.open_reader("rt/kinship/receipt", Receipt::type(), false);
  const auto deadline = Clock::now() + patience;
  if (!node.wait_for_writer_match(writer, deadline) ||
      !node.wait_for_reader_match(reader, deadline))
    return none();
  auto path = path_of(options);
  PlannedPath::Wire wire{};
  copy(path, wire);
  Bytes bytes = to_cdr(PlannedPath::support(), &path);
  std::cout << "flooding" << std::endl;
  for (std::uint32_t number = 0;; ++number) {
    std::memcpy(wire.uuid.uuid, &number, sizeof number);
    std::memcpy(bytes.data() + 4, &number, sizeof number);  // behind the encapsulation
    try {
      node.write(writer, {&wire, bytes});
    } catch (const std::runtime_error&) {  // the server takes no more for now
    }
  }
}

/// Reports `rate` paths a second for some `seconds`, each again every second until its receipt has
/// come, and prints when all had: receipts of stored paths, and the time since the last new path.
int report_many(Transport& node, const Options& options) {
  const int writer = node.open_writer("rt/kinship/report", PlannedPath::type());
  const int reader = node.open_reader("rt/kinship/receipt", Receipt::type(), false);
  const auto deadline = Clock::now() + patience;
  if (!node.wait_for_writer_match(writer, deadline) ||
      !node.wait_for_reader_match(reader, deadline))
    return none();
  auto path = path_of(options);
  PlannedPath::Wire wire{};
  const auto rate = static_cast<std::uint32_t>(options.number("rate", 300));
  const auto count = rate * static_cast<std::uint32_t>(options.number("seconds", 3));
  const auto begin = Clock::now();
  const auto time_of = [&](std::uint32_t number) {
    return begin + number * std::chrono::nanoseconds(std::chrono::seconds(1)) / rate;
  };
  std::set<std::pair<Clock::time_point, std::uint32_t>> open;  // by when each is sent next
  std::map<std::uint32_t, Clock::time_point> due;              // the same by number
  for (std::uint32_t number = 0; number < count; ++number) {
    open.emplace(time_of(number), number);
    due.emplace(number, time_of(number));
  }
  int stored = 0, sendings = 0;
  while (!open.empty() && Clock::now() < deadline) {
    while (open.begin()->first <= Clock::now()) {
      const std::uint32_t number = open.begin()->second;
      std::memcpy(path.uuid.uuid, &number, sizeof number);
      path.trajectory.points.data[0].positions.data[0] = 1e-4 * number;
      copy(path, wire);
      node.write(writer, {&wire, to_cdr(PlannedPath::support(), &path)});
      ++sendings;
      open.erase(open.begin());
      open.emplace(due[number] = Clock::now() + kResend, number);
    }
    const auto answer = node.take(reader, open.begin()->first);
    if (!answer)
      continue;
    auto receipt = made<Receipt>();
    from_cdr(Receipt::support(), *answer, &receipt);
    std::uint32_t number = 0;
    std::memcpy(&number, receipt.uuid.uuid, sizeof number);
    if (receipt.status > kinship_msgs__msg__Receipt__DUPLICATE || !due.contains(number))
      continue;
    stored += receipt.status == kinship_msgs__msg__Receipt__STORED ? 1 : 0;
    open.erase({due[number], number});
    due.erase(number);
  }
  std::cout << "receipts " << count - due.size() << " of-stored " << stored << " sent-again "
            << sendings - static_cast<int>(count) << " ms-after "
            << std::chrono::round<std::chrono::milliseconds>(Clock::now() - time_of(count)).count()
            << std::endl;
  return due.empty() ? 0 : 1;
}

int call_report(Transport& node, const Options& options) {
  auto request = made<Report_Request>();
  request.path = path_of(options);
  const auto answer = call<Report_Request, Report_Response>(node, "report", request);
  if (!answer)
    return none();
  print(answer->receipt);
  return 0;
}

void print(const kinship_msgs__msg__Distribution& distribution) {
  std::cout << "distribution " << distribution.revision << ' ' << distribution.task.data << ' '
            << distribution.joint_names.size << ' ' << distribution.weights.size << ' '
            << distribution.means.size << ' ' << distribution.covariances.size << ' '
            << distribution.lower.size << ' ' << distribution.is_continuous.size << ' '
            << (distribution.joint_names.size > 0 ? distribution.joint_names.data[0].data : "-")
            << std::endl;
}

DistributionQuery::Ros query_of(const Options& options) {
  auto query = made<DistributionQuery>();
  make_uuid(query.uuid.uuid);
  read_hex(options.text("robot"), query.robot);
  set(query.task, options.text("task", "shelf"));
  query.deadline.sec = static_cast<std::int32_t>(options.number("deadline", 20));
  query.follow.sec = static_cast<std::int32_t>(options.number("follow", 0));
  return query;
}

void print(const kinship_msgs__msg__DistributionAnswer& answer) {
  std::cout << "fetched " << int{answer.status} << ' ' << answer.revision << ' '
            << answer.message.data << std::endl;
}

/// The next distribution of this revision or a later one.
std::optional<Distribution::Ros> next_distribution(Transport& node, int reader,
                                                   std::uint64_t revision) {
  const auto deadline = Clock::now() + patience;
  while (const auto bytes = node.take(reader, deadline)) {
    auto distribution = made<Distribution>();
    from_cdr(Distribution::support(), *bytes, &distribution);
    if (distribution.revision >= revision)
      return distribution;
  }
  return std::nullopt;
}

/// With `more=N` also N later revisions.
int fetch(Transport& node, const Options& options) {
  const int reader = node.open_reader("rt/kinship/distribution", Distribution::type(), true);
  const auto answer =
      ask<DistributionQuery, DistributionAnswer>(node, "fetch", "fetched", query_of(options));
  if (!answer)
    return none();
  print(*answer);
  std::uint64_t revision = answer->revision;
  if (answer->status != kinship_msgs__msg__DistributionAnswer__READY)
    return 0;
  for (long left = options.number("more", 0); left >= 0; --left) {
    const auto found = next_distribution(node, reader, revision++);
    if (!found)
      return none();
    print(*found);
  }
  return 0;
}

int call_fetch(Transport& node, const Options& options) {
  auto request = made<Fetch_Request>();
  request.query = query_of(options);
  const auto answer = call<Fetch_Request, Fetch_Response>(node, "fetch", request);
  if (!answer)
    return none();
  print(answer->answer);
  for (std::size_t i = 0; i < answer->distribution.size; ++i)
    print(answer->distribution.data[i]);
  return 0;
}

/// What was published before it came: the first of it, or all until one of the task `until`.
int listen(Transport& node, const Options& options) {
  const int reader = node.open_reader("rt/kinship/distribution", Distribution::type(), true);
  const std::string until = options.text("until");
  std::string task;
  do {
    const auto found = next_distribution(node, reader, 0);
    if (!found)
      return none();
    print(*found);
    task = found->task.data;
  } while (!until.empty() && task != until);
  return 0;
}

int status(Transport& node, const Options& /*options*/) {
  auto question = made<StatusQuery>();
  make_uuid(question.uuid.uuid);
  const auto answer = ask<StatusQuery, Status>(node, "status_query", "status", question);
  if (!answer)
    return none();
  std::cout << "status " << answer->robots << " robots " << answer->paths << " paths "
            << answer->attempts << " attempts, version " << answer->version.data << std::endl;
  return 0;
}

/// A node that is there and does nothing, until it is killed: it holds a place of the domain.
int stay(Transport& /*node*/, const Options& /*options*/) {
  std::cout << "here" << std::endl;
  return pause();
}

int run(std::uint32_t domain, const std::string& verb, const Words& words) {
  const std::unique_ptr<Transport> node = join(domain);
  const Options options(words);
  patience = std::chrono::seconds(options.number("patience", patience.count()));
  if (verb == "register")
    return register_robot(*node, options);
  if (verb == "report")
    return report(*node, options);
  if (verb == "flood")
    return flood(*node, options);
  if (verb == "report_many")
    return report_many(*node, options);
  if (verb == "call_report")
    return call_report(*node, options);
  if (verb == "fetch")
    return fetch(*node, options);
  if (verb == "call_fetch")
    return call_fetch(*node, options);
  if (verb == "listen")
    return listen(*node, options);
  if (verb == "status")
    return status(*node, options);
  if (verb == "stay")
    return stay(*node, options);
  throw std::runtime_error("no verb '" + verb + "'");
}

}  // namespace
}  // namespace kinship::test

int main(int argc, char** argv) try {
  if (argc < 3)
    throw std::runtime_error("usage: ros_peer DOMAIN VERB [NAME=VALUE ...]");
  return kinship::test::run(static_cast<std::uint32_t>(std::stoul(argv[1])), argv[2],
                            {argv + 3, argv + argc});
} catch (const std::exception& error) {
  std::cerr << argv[0] << ": " << error.what() << '\n';
  return 2;
}
