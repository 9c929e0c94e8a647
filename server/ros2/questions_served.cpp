#include "server/ros2/questions_served.hpp"

#include <chrono>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <variant>

#include "proto/ros2/answers.hpp"
#include "proto/ros2/channel.hpp"
#include "proto/ros2/outlet.hpp"
#include "proto/ros2/questions.hpp"
#include "server/quotas/quota.hpp"
#include "server/ros2/follows.hpp"
#include "server/runtime/robot_registry.hpp"

namespace kinship::ros2 {
namespace {

constexpr int kKeptDistributions = 64;  ///< for nodes that come later

using Robots = service::RegistrationService::Robots;
using Joints = std::vector<std::string>;

/// The same words for each question, in the place that its reply has for them.
template <typename Reply>
Reply reply_to(const quotas::Refusal& refusal, Reply reply) {
  reply.message = refusal.message;
  reply.retry_after = refusal.retry_after;
  return reply;
}

Joints joints_of(const Robots& robots, const Digest& digest) {
  Joints names;
  const auto robot = robots.find(digest);
  if (robot != robots.end() && robot->second)
    for (const kinematics::Joint& joint : robot->second.value()->chain.joints())
      names.push_back(joint.name);
  return names;
}

/// Sends an answer by the way that its question came.
template <typename Answer>
using Send = std::function<void(const Question&, Message<Answer>)>;

template <typename Response, typename Answer>
Message<Response> response_of(Message<Answer> answer) {
  Message<Response> response;
  response.arena = std::move(answer.arena);
  response.wire = {0, 0, answer.wire};
  return response;
}

/// The topics of messages with UUIDs.
ChannelTopics topics_of(const std::string& question, const dds_topic_descriptor& question_type,
                        const std::string& answer, const dds_topic_descriptor& answer_type) {
  return {"rt/kinship/" + question, question_type, "rt/kinship/" + answer, answer_type};
}

/// The topics of a service as rmw_cyclonedds has them.
ChannelTopics topics_of_service(const std::string& name, const dds_topic_descriptor& request,
                                const dds_topic_descriptor& response) {
  return {"rq/kinship/" + name + "Request", request, "rr/kinship/" + name + "Reply", response,
          false};
}

/// The message of a sample, which is all of it, or stands behind a request's identity.
template <typename Wire>
const Wire& message_in(const void* sample, std::size_t offset) {
  return *reinterpret_cast<const Wire*>(static_cast<const std::byte*>(sample) + offset);  // NOLINT
}

}  // namespace

class QuestionsServed::Implementation {
 public:
  Implementation(const dds::Participant& participant, dds::WaitLoop& loop,
                 service::Service& service)
      : service_(service),
        distributions_(std::make_shared<Outlet>(
            participant, kinship_msgs_msg_dds__Distribution__desc, "rt/kinship/distribution",
            node_qos(Durability::TransientLocal, kKeptDistributions))) {
    const auto open = [&](const ChannelTopics& topics, Channel::Reading reading) {
      channels_.push_back(std::make_unique<Channel>(participant, loop, topics, std::move(reading)));
    };
    open_topics(open);
    open_services(open);
  }

  void announce(const Announcement& announcement) {
    forget_departed();
    for (const Follows::Follow& each : follows_.of(announcement, Follows::TimePoint::clock::now()))
      service_.fetches().fetch(
          each.query, each.client + " follow " + announcement.distribution_id.hex(),
          [this, client = each.client](const FetchReply& reply) {
            with_distribution(reply, client,
                              [outlet = distributions_](const Message<wire::Distribution>* newer) {
                                if (newer)
                                  outlet->write(&newer->wire);
                              });
          });
  }

 private:
  /// What nodes follow that neither read distributions nor can ask any more.
  void forget_departed() {
    if (follows_.empty())
      return;
    auto here = distributions_->nodes();
    for (const auto& channel : channels_) {
      auto nodes = channel->nodes();
      if (!here || !nodes)
        return;
      here->merge(*nodes);
    }
    follows_.keep_only(*here);
  }

  bool follow(const std::string& client, const FetchRequest& query) {
    const auto now = Follows::TimePoint::clock::now();
    if (follows_.keep(client, query, now))
      return true;
    forget_departed();
    return follows_.keep(client, query, now);
  }

  template <typename Open>
  void open_topics(const Open& open) {
    open(topics_of("register", kinship_msgs_msg_dds__Registration__desc, "registered",
                   kinship_msgs_msg_dds__Registered__desc),
         [this](const void* sample, const Question& question) {
           return read_robot(message_in<wire::Registration>(sample, 0), question,
                             &Question::answer<wire::Registered>);
         });
    open(topics_of("report", kinship_msgs_msg_dds__PlannedPath__desc, "receipt",
                   kinship_msgs_msg_dds__Receipt__desc),
         [this](const void* sample, const Question& question) {
           return read_path(message_in<wire::PlannedPath>(sample, 0), question,
                            &Question::answer<wire::Receipt>);
         });
    open(topics_of("fetch", kinship_msgs_msg_dds__DistributionQuery__desc, "fetched",
                   kinship_msgs_msg_dds__DistributionAnswer__desc),
         [this](const void* sample, const Question& question) {
           return read_query(message_in<wire::DistributionQuery>(sample, 0), question,
                             [outlet = distributions_](const Question& asked,
                                                       Message<wire::DistributionAnswer> answer,
                                                       const Message<wire::Distribution>* found) {
                               if (found)
                                 outlet->write(&found->wire);
                               asked.answer(std::move(answer));
                             });
         });
    open(topics_of("status_query", kinship_msgs_msg_dds__StatusQuery__desc, "status",
                   kinship_msgs_msg_dds__Status__desc),
         [this](const void* sample, const Question& question) {
           return read_status_query(message_in<wire::StatusQuery>(sample, 0), question,
                                    &Question::answer<wire::Status>);
         });
  }

  template <typename Open>
  void open_services(const Open& open) {
    open(topics_of_service("register", kinship_msgs_srv_dds__Register_Request__desc,
                           kinship_msgs_srv_dds__Register_Response__desc),
         [this](const void* sample, const Question& question) {
           return read_robot(message_in<wire::Registration>(sample, wire::kKeyBytes), question,
                             [](const Question& asked, Message<wire::Registered> answer) {
                               asked.answer(response_of<wire::RegisterResponse>(std::move(answer)));
                             });
         });
    open(topics_of_service("report", kinship_msgs_srv_dds__Report_Request__desc,
                           kinship_msgs_srv_dds__Report_Response__desc),
         [this](const void* sample, const Question& question) {
           return read_path(message_in<wire::PlannedPath>(sample, wire::kKeyBytes), question,
                            [](const Question& asked, Message<wire::Receipt> answer) {
                              asked.answer(response_of<wire::ReportResponse>(std::move(answer)));
                            });
         });
    open(topics_of_service("fetch", kinship_msgs_srv_dds__Fetch_Request__desc,
                           kinship_msgs_srv_dds__Fetch_Response__desc),
         [this](const void* sample, const Question& question) {
           return read_query(message_in<wire::DistributionQuery>(sample, wire::kKeyBytes), question,
                             [](const Question& asked, Message<wire::DistributionAnswer> answer,
                                const Message<wire::Distribution>* found) {
                               Message<wire::FetchResponse> response;
                               response.wire = {0, 0, answer.wire, {}};
                               if (found) {
                                 response.arena->resize(response.wire.distribution, 1);
                                 response.wire.distribution._buffer[0] = found->wire;
                               }
                               asked.answer(std::move(response));  // is sent before it returns
                             });
         });
    open(topics_of_service("get_status", kinship_msgs_srv_dds__GetStatus_Request__desc,
                           kinship_msgs_srv_dds__GetStatus_Response__desc),
         [this](const void* sample, const Question& question) {
           return read_status_query(
               message_in<wire::StatusQuery>(sample, wire::kKeyBytes), question,
               [](const Question& asked, Message<wire::Status> answer) {
                 asked.answer(response_of<wire::GetStatusResponse>(std::move(answer)));
               });
         });
  }

  Channel::Answering read_robot(const wire::Registration& message, const Question& question,
                                const Send<wire::Registered>& send) {
    const Uuid uuid = read_uuid(message.uuid);
    const auto refuse = [&](const RegisterReply& reply) -> Channel::Answering {
      send(question, to_registered(reply, uuid, {}));
      return {};
    };
    const std::string& client = question.caller().client;
    if (const auto refusal = service_.admit_robot(client, size_of(message).bytes))
      return refuse(reply_to(*refusal, RegisterReply{}));
    Result<RobotDescription> robot = read(message);
    if (!robot)
      return refuse(codec::RegisterConversation::refuse(robot.error()));
    return [this, question, send, uuid, client, robot = std::move(robot).value()] {
      service_.registration().register_robot(
          robot,
          [this, question, send, uuid, client](const RegisterReply& reply) {
            service_.registration().find_robots(
                {reply.robot},
                [=](const Robots& robots) {
                  send(question, to_registered(reply, uuid, joints_of(robots, reply.robot)));
                },
                client);
          },
          client);
    };
  }

  Channel::Answering read_path(const wire::PlannedPath& message, const Question& question,
                               const Send<wire::Receipt>& send) {
    const Uuid uuid = read_uuid(message.uuid);
    const std::string& client = question.caller().client;
    const codec::RequestSize size = size_of(message);
    if (const auto refusal = service_.admit(client, size.bytes, size.attempts)) {
      send(question, to_receipt(reply_to(*refusal, ReportReply{}), uuid));
      return {};
    }
    Result<PathReport> read_report = read(message);
    if (!read_report) {
      send(question, to_receipt(read_report.error(), uuid));
      return {};
    }
    const auto answer = [question, send, uuid](const ReportReply& reply) {
      send(question, to_receipt(reply, uuid));
    };
    return [this, answer, client, report = std::move(read_report).value()] {
      report_in_order(report, answer, client);
    };
  }

  /// A robot that is not registered is told of by the service.
  void report_in_order(const PathReport& report,
                       const std::function<void(const ReportReply&)>& answer,
                       const std::string& client) {
    if (report.joint_names.empty() || report.request.attempts.empty())
      return service_.reports().report(report.request, answer, client);
    const Digest robot = report.request.attempts[0].robot;
    service_.registration().find_robots(
        {robot},
        [this, report, answer, client, robot](const Robots& robots) {
          PathReport ordered = report;
          const auto found = robots.find(robot);
          if (found != robots.end() && !found->second)
            return answer({.store_epoch = {},
                           .receipts = {},
                           .retry_after = service::TaskPools::kRetryAfter,
                           .message = found->second.error().message});
          if (found != robots.end())
            if (const auto error = order_joints(ordered, joints_of(robots, robot))) {
              ordered.request.refused.push_back({ordered.request.attempts[0].report_uuid,
                                                 ReceiptStatus::Refused, error->message});
              ordered.request.attempts.clear();
            }
          service_.reports().report(std::move(ordered.request), answer, client);
        },
        client);
  }

  using SendDistribution = std::function<void(const Question&, Message<wire::DistributionAnswer>,
                                              const Message<wire::Distribution>*)>;

  Channel::Answering read_query(const wire::DistributionQuery& message, const Question& question,
                                const SendDistribution& send) {
    const Uuid uuid = read_uuid(message.uuid);
    const auto refuse = [&](FetchReply reply, FetchStatus status) -> Channel::Answering {
      reply.status = status;
      send(question, to_answer(reply, uuid), nullptr);
      return {};
    };
    const std::string& client = question.caller().client;
    if (const auto refusal = service_.admit(client, size_of(message).bytes))
      return refuse(reply_to(*refusal, FetchReply{}), FetchStatus::Busy);
    const Result<FetchRequest> query = read(message);
    if (!query)
      return refuse(codec::FetchConversation::refuse(query.error()), FetchStatus::Refused);
    if (query->follow > std::chrono::seconds(0) && !follow(client, *query))
      return refuse({.message = "too many distributions are followed"}, FetchStatus::Busy);
    return [this, question, send, uuid, client, query = *query] {
      service_.fetches().fetch(
          query, question.key(), [this, question, send, uuid, client](const FetchReply& reply) {
            with_distribution(reply, client, [=](const Message<wire::Distribution>* found) {
              send(question, to_answer(reply, uuid), found);
            });
          });
    };
  }

  /// Calls `done` with the message of the reply's distribution; with null if it has no mixture.
  void with_distribution(const FetchReply& reply, const std::string& client,
                         std::function<void(const Message<wire::Distribution>*)> done) {
    if (!reply.distribution || !reply.distribution->mixture)
      return done(nullptr);
    // Shared by the copies of the task that may have to read the store.
    const auto distribution = std::make_shared<const Distribution>(*reply.distribution);
    service_.registration().find_robots(
        {distribution->robot},
        [distribution, done = std::move(done)](const Robots& robots) {
          const auto message =
              to_distribution(*distribution, joints_of(robots, distribution->robot));
          done(&message);
        },
        client);
  }

  Channel::Answering read_status_query(const wire::StatusQuery& message, const Question& question,
                                       const Send<wire::Status>& send) {
    const Uuid uuid = read_uuid(message.uuid);
    const auto answer = [question, send, uuid](const Result<ServerStatus>& status) {
      send(question, to_status(status, uuid));
    };
    if (const auto refusal = service_.admit(question.caller().client, size_of(message).bytes)) {
      answer(Error{ErrorCode::Unavailable, refusal->message});
      return {};
    }
    return [this, question, answer] {
      service_.administration().administer(
          {.verb = AdminVerb::Status}, question.key(),
          [answer](const service::AdminPage& page) {
            const auto* const status =
                page.rows.empty() ? nullptr : std::get_if<ServerStatus>(&page.rows.front());
            answer(status ? Result<ServerStatus>(*status)
                          : Error{ErrorCode::Unavailable, page.message});
          },
          question.caller());
    };
  }

  service::Service& service_;
  Follows follows_;
  std::shared_ptr<const Outlet> distributions_;  // shared with answers under way
  std::vector<std::unique_ptr<Channel>> channels_;
};

QuestionsServed::QuestionsServed(const dds::Participant& participant, dds::WaitLoop& loop,
                                 service::Service& service)
    : implementation_(std::make_unique<Implementation>(participant, loop, service)) {}

QuestionsServed::~QuestionsServed() = default;

void QuestionsServed::announce(const Announcement& announcement) {
  implementation_->announce(announcement);
}

}  // namespace kinship::ros2
