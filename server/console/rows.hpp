#pragma once

#include <functional>
#include <string>

#include "server/console/questions.hpp"
#include "server/http/message.hpp"

namespace kinship::console {

/// A row of the service as a JSON document.
using RowText = std::function<std::string(const service::AdminRow&)>;

/// Answers /api/rows/VERB with {"rows": [...], "next_cursor", "message"}: the rows of an admin verb
/// (VerbRule::name), as `--json` has them. Verbs that change something need POST and, in its body,
/// {"argument", "robot", "task", "confirm"}: `confirm` is the object's name once more, as a person
/// typed it: of the task or robot where the verb names one, else the argument.
void answer_rows(Questions& questions, const RowText& to_json, const http::Request& request,
                 const http::Answer& answer);

/// A JSON document.
http::Reply json_reply(unsigned status, std::string document);

/// {"message": ...}
http::Reply message_reply(unsigned status, const std::string& message);

}  // namespace kinship::console
