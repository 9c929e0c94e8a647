// Fetches and admin requests that no client of ours would send, put onto the wire past its checks.

#include <functional>
#include <limits>

#include "tests/support/bad_input_test.hpp"

namespace kinship::test::bad_input_request_test {
namespace {

using codec::Arena;
using FetchWire = kinship_wire_FetchRequest;
using AdminWire = kinship_wire_AdminRequest;

template <typename Wire>
struct Case {
  const char* name;
  std::function<void(Wire&, Arena&)> damage;
  std::vector<std::string> words;  // of the refusal
};

/// What the decoder refuses is held in fetch_codec_test and selection_codec_test.
std::vector<Case<FetchWire>> fetch_cases() {
  return {
      {"a million bytes of sources",
       [](FetchWire& w, Arena& a) {
         a.resize(w.selection, 1);
         a.resize(w.selection._buffer[0].sources, 1'000'000);
       },
       {"sources of the selection", "31250", "256"}},
      {"an unknown profile",
       [](FetchWire& w, Arena& a) { w.profile = a.text("fastest"); },
       {"profile", "'fastest'"}},
      {"a deadline of 49 days",
       [](FetchWire& w, Arena&) { w.deadline_ms = 0xFFFFFFFF; },
       {"deadline", "4294967295", "3600000"}},
      {"a placement of a million numbers",
       [](FetchWire& w, Arena& a) { a.resize(w.T_task_base, 100'000); },
       {"T_task_base", "100000", "7"}},
  };
}

std::vector<Case<AdminWire>> admin_cases() {
  const auto verb = [](std::uint32_t number, const std::string& argument = "") {
    return [number, argument](AdminWire& w, Arena& a) {
      w.verb = number;
      w.argument = a.text(argument);
    };
  };
  return {
      {"verb 99", verb(99), {"verb", "99"}},
      {"verb 2^32 - 1", verb(0xFFFFFFFF), {"verb", "4294967295"}},
      {"no rows", [](AdminWire& w, Arena&) { w.limit = 0; }, {"limit", "0", "1"}},
      {"1001 rows", [](AdminWire& w, Arena&) { w.limit = 1001; }, {"limit", "1001", "1000"}},
      {"a cursor of 513 bytes",
       [](AdminWire& w, Arena& a) { w.cursor = a.text(std::string(513, 'c')); },
       {"cursor", "513", "512"}},
      {"a garbage cursor",
       [verb](AdminWire& w, Arena& a) {
         verb(5)(w, a);
         w.cursor = a.text("\"; DROP TABLE path; --");
       },
       {"cursor"}},
      {"an argument with a control character", verb(2, "pan\x01"), {"argument", "byte 4"}},
      {"an argument of 129 bytes", verb(2, std::string(129, 'r')), {"argument", "129", "128"}},
      {"a filter that is not UTF-8",
       [verb](AdminWire& w, Arena& a) {
         verb(1)(w, a);
         w.robot = a.text("\xC0\x80");
       },
       {"robot", "UTF-8"}},
      {"a path that is no UUID", verb(6, "not-a-uuid"), {"not-a-uuid"}},
      {"retiring what is no UUID", verb(13, "../../etc"), {"../../etc"}},
      {"resetting a task that cannot be", verb(14, "a task"), {"task"}},
      {"a garbage job", verb(17, "job -1"), {"job -1"}},
      {"rows of a garbage job", verb(19, "99999999999999999999"), {"99999999999999999999"}},
      {"cancelling nothing", verb(18, ""), {"job"}},
      {"a backup to a device", verb(15, "/dev/null"), {"/dev/null"}},
      {"a backup outside of the folder",
       verb(15, "../backup.db"),
       {"../backup.db", "no bare name"}},
      {"a backup to a folder that is not there", verb(15, "/nowhere/at/all.db"), {"/nowhere"}},
      {"a backup to a name of 129 bytes",
       verb(15, std::string(129, 'b')),
       {"argument", "129", "128"}},
      {"the digest of a file that is no backup", verb(26, "fleet.db"), {"fleet.db", "the store"}},
      {"reading a file outside of the folder", verb(27, "/etc/passwd"), {"/etc/passwd"}},
      {"reading a backup that is not there", verb(27, "monday.db"), {"monday.db"}},
      {"reading from no place",
       [verb](AdminWire& w, Arena& a) {
         verb(27, "monday.db")(w, a);
         w.cursor = a.text("-1");
       },
       {"-1"}},
      {"a wait of 49 days",
       [verb](AdminWire& w, Arena& a) {
         verb(17, "1")(w, a);
         w.deadline_ms = 0xFFFFFFFF;
       },
       {"deadline", "4294967295", "3600000"}},
  };
}

class BadRequest : public BadInput {
 protected:
  AdminReply reply_to(const std::function<void(AdminWire&, Arena&)>& damage) {
    auto message = codec::encode({}, AdminRequest{}).value_or_throw();
    damage(message.wire, *message.arena);
    return admin_.call(message.wire).value();
  }

  RawConversation<codec::FetchConversation> fetch_{participant_};
  RawConversation<codec::AdminConversation> admin_{participant_};
};

TEST_F(BadRequest, FetchesThatCannotBeAreRefused) {
  FetchRequest request;
  request.task = "sweep";
  request.robot = panda_;
  for (const auto& bad : fetch_cases()) {
    SCOPED_TRACE(bad.name);
    auto message = codec::encode({}, request).value_or_throw();
    bad.damage(message.wire, *message.arena);
    const auto reply = fetch_.call(message.wire);
    ASSERT_TRUE(reply);
    EXPECT_EQ(reply->status, FetchStatus::Refused);
    expect_words(reply->message, bad.words);
  }
  expect_untouched();
}

TEST_F(BadRequest, FetchesOfAnUnknownRobotOrTaskSaySo) {
  FetchRequest request;
  request.task = "nobody.did:this";
  request.robot = panda_;
  auto message = codec::encode({}, request).value_or_throw();
  EXPECT_EQ(fetch_.call(message.wire)->status, FetchStatus::NoExperience);
  message.wire.robot[31] ^= 1;
  const auto reply = fetch_.call(message.wire);
  EXPECT_EQ(reply->status, FetchStatus::UnknownRobot);
  Digest unknown = panda_;
  unknown.bytes[31] ^= 1;
  expect_words(reply->message, {unknown.short_hex()});
  expect_untouched();
}

TEST_F(BadRequest, AdminRequestsThatCannotBeAreNotDone) {
  for (const auto& bad : admin_cases()) {
    SCOPED_TRACE(bad.name);
    const AdminReply reply = reply_to(bad.damage);
    EXPECT_NE(reply.status, AdminStatus::Ok);
    expect_words(reply.message, bad.words);
    EXPECT_TRUE(reply.rows.empty());
  }
  expect_untouched();
}

TEST_F(BadRequest, ABackupOntoTheStoreItselfLeavesItAsItWas) {
  const std::string store = directory_ / "fleet.db";
  const AdminReply reply = reply_to([&](AdminWire& w, Arena& a) {
    w.verb = 15;
    w.argument = a.text(store);
  });
  EXPECT_NE(reply.status, AdminStatus::Ok);
  expect_words(reply.message, {store});
  expect_untouched();
}

}  // namespace
}  // namespace kinship::test::bad_input_request_test
