#include "server/console/rows.hpp"

#include <algorithm>
#include <charconv>

#include "pages/page/json_text.hpp"
#include "proto/json/text_members.hpp"

namespace kinship::console {
namespace {

using page::json_string;

unsigned status_of(AdminStatus status) {
  switch (status) {
    case AdminStatus::Ok:
      return 200;
    case AdminStatus::NotFound:
      return 404;
    case AdminStatus::Refused:
      return 400;
    case AdminStatus::Failed:
      break;
  }
  return 503;
}

std::string document_of(const service::AdminPage& page, const RowText& to_json) {
  return page::object({{"rows", page::list(page.rows,
                                           [&](const service::AdminRow& row) {
                                             const std::string text = to_json(row);
                                             return std::holds_alternative<service::TextLine>(row)
                                                        ? json_string(text)
                                                        : text;
                                           })},
                       {"next_cursor", json_string(page.next_cursor)},
                       {"message", json_string(page.message)}});
}

AdminRequest request_of(const VerbRule& rule, const http::Request& request) {
  AdminRequest asked{.verb = rule.verb,
                     .argument = request.query_value("argument"),
                     .robot = request.query_value("robot"),
                     .task = request.query_value("task"),
                     .cursor = request.query_value("cursor")};
  const std::string limit = request.query_value("limit");
  std::from_chars(limit.data(), limit.data() + limit.size(), asked.limit);
  asked.limit = std::clamp<std::uint32_t>(asked.limit, 1, kMaxPageRows);
  return asked;
}

/// The change that a POST asks for, or why it is not made.
Result<AdminRequest> change_of(const VerbRule& rule, const http::Request& request) {
  const std::string* const type = request.field("content-type");
  if (type == nullptr || !type->starts_with("application/json"))
    return invalid_input("a change comes as application/json");
  auto members = json::text_members_from_json(request.body);
  if (!members)
    return members.error();
  std::map<std::string, std::string> given = std::move(members).value();
  AdminRequest change{.verb = rule.verb,
                      .argument = given["argument"],
                      .robot = given["robot"],
                      .task = given["task"]};
  // `argument` is the object, or the new name or nothing beside a robot or task.
  const std::string& object = !change.task.empty()    ? change.task
                              : !change.robot.empty() ? change.robot
                                                      : change.argument;
  if (object.empty() || given["confirm"] != object)
    return invalid_input("'" + given["confirm"] + "' does not confirm '" + object + "'");
  return change;
}

}  // namespace

http::Reply json_reply(unsigned status, std::string document) {
  return {.status = status, .type = "application/json; charset=utf-8", .body = std::move(document)};
}

http::Reply message_reply(unsigned status, const std::string& message) {
  return json_reply(status, page::object({{"message", json_string(message)}}));
}

void answer_rows(Questions& questions, const RowText& to_json, const http::Request& request,
                 const http::Answer& answer) {
  const auto rule = std::ranges::find(kVerbRules, request.parts.back(), &VerbRule::name);
  if (rule == kVerbRules.end())
    return answer(message_reply(404, "no verb '" + request.parts.back() + "'"));
  const bool changes = rule->is(VerbRule::Changes);
  if (changes != (request.method == "POST"))
    return answer(message_reply(405, changes ? "a change needs POST" : "GET reads"));
  if (changes && !questions.is_admin())
    return answer(message_reply(403, "this console only reads; kinshipd --console-admin changes"));
  Result<AdminRequest> asked =
      changes ? change_of(*rule, request) : Result<AdminRequest>(request_of(*rule, request));
  if (!asked)
    return answer(message_reply(400, asked.error().message));
  questions.ask(*asked, [answer, to_json](const service::AdminPage& page) {
    answer(json_reply(status_of(page.status), document_of(page, to_json)));
  });
}

}  // namespace kinship::console
