// Robots that cannot be, registered past a client's checks: a real kinshipd refuses each with the
// thing, the value and the limit, stores nothing and goes on.

#include <functional>
#include <limits>

#include "tests/support/bad_input_test.hpp"

namespace kinship::test::bad_input_register_test {
namespace {

using codec::Arena;
using Wire = kinship_wire_RegisterRequest;

struct Case {
  const char* name;
  std::function<void(Wire&, Arena&)> damage;
  std::vector<std::string> words;  // of the refusal
};

void set_urdf(Wire& wire, Arena& arena, const std::string& text) { wire.urdf = arena.text(text); }

/// base - j1 (revolute, with `limit`) - arm - fixed - tip
std::string small_urdf(const std::string& limit) {
  return "<robot name='r'><link name='base'/><link name='arm'/><link name='tip'/>"
         "<joint name='j1' type='revolute'><parent link='base'/><child link='arm'/>"
         "<axis xyz='0 0 1'/>" +
         limit +
         "</joint><joint name='end' type='fixed'><parent link='arm'/><child link='tip'/></joint>"
         "</robot>";
}

void set_small(Wire& wire, Arena& arena, const std::string& limit) {
  set_urdf(wire, arena, small_urdf(limit));
  wire.base_link = arena.text("base");
  wire.tip_link = arena.text("tip");
  wire.held_joints._length = 0;
  wire.never_colliding._length = 0;
}

std::string entity_bomb() {
  std::string text = "<?xml version='1.0'?><!DOCTYPE r [<!ENTITY a0 'aaaaaaaaaa'>";
  for (int i = 1; i < 20; ++i) {
    const std::string before = "&a" + std::to_string(i - 1) + ";";
    text += "<!ENTITY a" + std::to_string(i) + " '";
    for (int j = 0; j < 10; ++j)
      text += before;
    text += "'>";
  }
  return text + "]><robot name='&a19;'/>";
}

/// What decoder and reader refuse is held in register_admin_codec_test, urdf_markup_test and
/// urdf_test; here are some of each kind.
std::vector<Case> cases() {
  return {
      {"an entity bomb",
       [](Wire& w, Arena& a) { set_urdf(w, a, entity_bomb()); },
       {"URDF", "line 1", "document types and entities"}},
      {"elements a million deep",
       [](Wire& w, Arena& a) {
         std::string deep;
         for (int i = 0; i < 300'000; ++i)
           deep += "<a>";
         set_urdf(w, a, deep);
       },
       {"URDF", "nested", "64"}},
      {"a limit of 1e300",
       [](Wire& w, Arena& a) {
         set_small(w, a, "<limit lower='0' upper='1e300' effort='1' velocity='1'/>");
       },
       {"j1", "1e+300", "1000"}},
      {"an unknown base",
       [](Wire& w, Arena& a) { w.base_link = a.text("bottom"); },
       {"base link 'bottom'", "not in the URDF"}},
      {"a label with a bell",
       [](Wire& w, Arena& a) { w.label = a.text("pan\ada"); },
       {"label", "byte 4", "A-Z"}},
      {"a zero quaternion",
       [](Wire& w, Arena&) { std::fill_n(w.T_tip_transfer, 7, 0.0); },
       {"T_tip_transfer", "quaternion", "0", "1"}},
      {"a held joint that is not there",
       [](Wire& w, Arena& a) {
         a.resize(w.held_joints, 1);
         w.held_joints._buffer[0].joint = a.text("nobody");
       },
       {"held joint 'nobody'", "not in the URDF"}},
  };
}

class BadRegister : public BadInput {
 protected:
  std::optional<RegisterReply> reply_to(const RobotDescription& description,
                                        const std::function<void(Wire&, Arena&)>& damage) {
    auto message = codec::encode({}, description).value_or_throw();
    damage(message.wire, *message.arena);
    return register_.call(message.wire);
  }

  RawConversation<codec::RegisterConversation> register_{participant_};
};

TEST_F(BadRegister, RobotsThatCannotBeAreRefused) {
  for (const Case& bad : cases()) {
    SCOPED_TRACE(bad.name);
    const auto reply = reply_to(model_description("ur10e"), bad.damage);
    ASSERT_TRUE(reply);
    EXPECT_EQ(reply->status, RegisterStatus::Refused);
    EXPECT_EQ(reply->robot, Digest{});
    expect_words(reply->message, bad.words);
  }
  expect_untouched();
}

TEST_F(BadRegister, ALabelThatIsTakenIsRefusedAndNamed) {
  RobotDescription other = model_description("ur10e");
  other.label = "panda";
  const auto reply = reply_to(other, [](Wire&, Arena&) {});
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->status, RegisterStatus::Refused);
  expect_words(reply->message, {"'panda'"});
  expect_untouched();
}

TEST_F(BadRegister, AUrdfOf10MbIsRefusedByTheClientAndDroppedByTheServer) {
  RobotDescription large = model_description("ur10e");
  large.urdf.append(10'000'000, ' ');
  const auto refused = client_.register_robot(large);
  ASSERT_FALSE(refused);
  expect_words(refused.error().message, {"urdf", std::to_string(large.urdf.size()), "1000000"});

  auto message = codec::encode({}, model_description("ur10e")).value_or_throw();
  set_urdf(message.wire, *message.arena, large.urdf);
  EXPECT_FALSE(register_.call(message.wire, std::chrono::seconds(3)));
  expect_untouched();
}

}  // namespace
}  // namespace kinship::test::bad_input_register_test
