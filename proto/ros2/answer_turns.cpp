#include "proto/ros2/answer_turns.hpp"

namespace kinship::ros2 {

bool AnswerTurns::begin(const Place& place) {
  const std::lock_guard lock(mutex_);
  return being_answered_.insert(place).second;
}

void AnswerTurns::end(const Place& place) {
  const std::lock_guard lock(mutex_);
  being_answered_.erase(place);
}

AnswerTurns::Turn AnswerTurns::take(const Place& place, const Answer& answer, TimePoint now) {
  const std::lock_guard lock(mutex_);
  try {
    const Turn turn = turn_of(place, answer, now);
    if (turn != Turn::Later)
      being_answered_.erase(place);
    return turn;
  } catch (...) {
    being_answered_.erase(place);
    throw;
  }
}

AnswerTurns::Turn AnswerTurns::turn_of(const Place& place, const Answer& answer, TimePoint now) {
  Line& line = line_of(place.first, now);
  if (line.held.empty() && line.tokens.has_token(now)) {
    line.tokens.take(now);
    return Turn::Now;
  }
  if (!answer.may_wait || line.held.size() >= kMaxHeldOfNode ||
      held_bytes_ + answer.bytes > kMaxHeldBytes)
    return Turn::Never;
  line.held.push_back({place.second, answer});
  held_bytes_ += answer.bytes;
  return Turn::Later;
}

std::vector<std::shared_ptr<const void>> AnswerTurns::due(TimePoint now) {
  std::vector<std::shared_ptr<const void>> samples;
  const std::lock_guard lock(mutex_);
  for (auto& [node, line] : lines_)
    while (!line.held.empty() && line.tokens.has_token(now)) {
      Held& next = line.held.front();
      being_answered_.erase({node, next.question});
      samples.push_back(std::move(next.answer.sample));
      line.tokens.take(now);
      held_bytes_ -= next.answer.bytes;
      line.held.pop_front();
    }
  return samples;
}

void AnswerTurns::drop_if(const std::function<bool(std::uint64_t participant)>& is_gone) {
  const std::lock_guard lock(mutex_);
  for (auto& each : lines_) {
    const std::string& node = each.first;
    std::erase_if(each.second.held, [&](const Held& held) {
      if (!is_gone(held.answer.participant))
        return false;
      being_answered_.erase({node, held.question});
      held_bytes_ -= held.answer.bytes;
      return true;
    });
  }
}

bool AnswerTurns::holds_some() const {
  const std::lock_guard lock(mutex_);
  return held_bytes_ > 0;
}

AnswerTurns::Line& AnswerTurns::line_of(const std::string& node, TimePoint now) {
  if (const auto known = lines_.find(node); known != lines_.end())
    return known->second;
  std::erase_if(lines_, [&](const auto& each) {  // of those that have been silent, or have left
    return each.second.held.empty() && each.second.tokens.is_full(now);
  });
  return lines_.emplace(node, Line{{kRate, now}, {}}).first->second;
}

}  // namespace kinship::ros2
