#include "server/catalog/flights.hpp"

namespace kinship::catalog {

Flight* Flights::find(const Digest& id) {
  const auto found = flights_.find(id);
  return found == flights_.end() ? nullptr : &found->second;
}

std::pair<Flight&, bool> Flights::open(const Digest& id, const fitting::DistributionKey& key) {
  const auto [flight, is_new] = flights_.try_emplace(id, key);
  return {flight->second, is_new};
}

void Flights::close_all(const SharedReply& reply, Answers& answers) {
  for (auto& [id, flight] : flights_)
    flight.answer_all(reply, answers);
  flights_.clear();
}

void Flights::answer_expired(TimePoint now, const SharedReply& reply, Answers& answers) {
  for (auto& [id, flight] : flights_)
    flight.answer_expired(now, reply, answers);
  std::erase_if(flights_, [](const auto& entry) {
    return entry.second.stage == Flight::Stage::Idle && entry.second.waiters().empty();
  });
}

std::size_t Flights::waiters() const {
  std::size_t count = 0;
  for (const auto& [id, flight] : flights_)
    count += flight.waiters().size();
  return count;
}

std::optional<Flights::TimePoint> Flights::next_deadline() const {
  std::optional<TimePoint> next;
  const auto consider = [&next](const std::optional<TimePoint>& time) {
    if (time && (!next || *time < *next))
      next = time;
  };
  for (const auto& [id, flight] : flights_) {
    consider(flight.look_due);
    for (const Waiter& waiter : flight.waiters())
      consider(waiter.deadline);
  }
  return next;
}

}  // namespace kinship::catalog
