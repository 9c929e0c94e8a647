#include "client/cli/server_rates.hpp"

#include <gtest/gtest.h>

namespace kinship::cli::server_rates_test {
namespace {

using std::chrono::seconds;
using TimePoint = ServerRates::TimePoint;

ServerStatus status(std::uint64_t uptime_s, std::uint64_t reports, std::uint64_t fetches) {
  ServerStatus status;
  status.uptime_s = uptime_s;
  status.reports_received = reports;
  status.fetches = fetches;
  return status;
}

TEST(ServerRates, AreThoseOfTheWindowAlone) {
  ServerRates rates(seconds(10));
  rates.add(status(0, 0, 0), TimePoint(seconds(100)));
  EXPECT_EQ(rates.text(), "") << "one reading is no rate";
  rates.add(status(5, 500, 10), TimePoint(seconds(105)));
  EXPECT_EQ(rates.text(), "reports 100.0/s, fetches 2.0/s, fits 0.0/s");
  rates.add(status(15, 500, 20), TimePoint(seconds(115)));  // the burst is over
  EXPECT_EQ(rates.text(), "reports 0.0/s, fetches 1.0/s, fits 0.0/s");
}

TEST(ServerRates, BeginAnewWithAServerThatWasStartedAnew) {
  ServerRates rates(seconds(10));
  rates.add(status(50, 500, 9), TimePoint(seconds(100)));
  rates.add(status(1, 2, 0), TimePoint(seconds(103)));
  EXPECT_EQ(rates.text(), "");
  rates.add(status(2, 4, 0), TimePoint(seconds(104)));
  EXPECT_EQ(rates.text(), "reports 2.0/s, fetches 0.0/s, fits 0.0/s");
}

TEST(ServerRates, TellWhatWaits) {
  ServerRates rates(seconds(10));
  ServerStatus busy = status(5, 1, 1);
  rates.add(busy, TimePoint(seconds(1)));
  busy.queued_reports = 3;
  busy.queued_fits = 1;
  rates.add(busy, TimePoint(seconds(2)));
  EXPECT_NE(rates.text().find("; queued 3 reports, 1 fit"), std::string::npos) << rates.text();
}

TEST(GuidanceText, SaysWhatItBringsOrCosts) {
  TaskRobotSummary robot;
  robot.label = "ur10e";
  robot.guided = ModeEvidence{40, 40, 487};
  EXPECT_EQ(guidance_text("pick", robot), "") << "nothing to compare with";
  robot.control = ModeEvidence{40, 39, 852};
  EXPECT_EQ(guidance_text("pick", robot),
            "ur10e on pick: 487 checks a solution guided, 852 uniform: 1.75 times fewer");
  robot.control->checks_per_solution = 243.5;
  EXPECT_NE(guidance_text("pick", robot).find("2.00 times more"), std::string::npos);
}

}  // namespace
}  // namespace kinship::cli::server_rates_test
