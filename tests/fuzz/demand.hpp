#pragma once

#include <cstdio>
#include <cstdlib>
#include <string>

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"
#include "proto/types/result.hpp"

namespace kinship::fuzz {

/// Ends the process, as a crash that the fuzzer keeps the input of, unless a law holds.
inline void demand(bool holds, const std::string& law) {
  if (holds)
    return;
  std::fprintf(stderr, "broken: %s\n", law.c_str());
  std::abort();
}

/// A refusal is a text of bounded length that is fit to be sent (check_text()).
template <typename Value>
void demand_words(const Result<Value>& result) {
  if (result)
    return;
  const std::string& message = result.error().message;
  demand(!message.empty(), "a refusal says something");
  const auto fault = check_text("refusal", message, kMaxMessageBytes);
  demand(!fault, (fault ? fault->message : "") + " in: " + message);
}

}  // namespace kinship::fuzz
