#include "proto/codec/publication_codec.hpp"

#include <gtest/gtest.h>

#include <string>

namespace kinship::codec::publication_codec_test {
namespace {

TEST(AnnouncementCodec, TaskIsATask) {
  Announcement announcement;
  announcement.task = "bin to shelf";
  EXPECT_EQ(encode(announcement).error().message, "task: byte 4 is not one of A-Z a-z 0-9 _ . : -");
  announcement.task = "bin_to_shelf";
  auto message = encode(announcement).value_or_throw();
  message.wire.task = nullptr;  // what a shorter message leaves
  EXPECT_FALSE(decode(message.wire));
}

TEST(EventCodec, WhatCannotBeSentIsMended) {
  const Event event{.kind = EventKind::Refusal,
                    .time_ms = 5,
                    .task = std::string(200, 't'),
                    .robot = "two\nlines",
                    .text = "label 'a\x01\xff b': " + std::string(600, 'x')};
  const Event sent = decode(encode(event).value_or_throw().wire).value_or_throw();
  EXPECT_EQ(sent.kind, EventKind::Refusal);
  EXPECT_EQ(sent.time_ms, 5);
  EXPECT_EQ(sent.task, std::string(128, 't'));
  EXPECT_EQ(sent.robot, "two lines");
  EXPECT_EQ(sent.text, "label 'a?? b': " + std::string(512 - 15, 'x'));
}

TEST(EventCodec, IncomingOneIsCheckedByName) {
  Event event;
  event.text = "fitted";
  auto message = encode(event).value_or_throw();
  message.wire.kind = 6;
  EXPECT_EQ(decode(message.wire).error().message, "kind: 6 is not between 0 and 5");
  message.wire.kind = 0;
  message.wire.text[2] = '\n';
  EXPECT_EQ(decode(message.wire).error().message, "text: has more than one line");
  const std::string text(513, 'x');
  message.wire.text = const_cast<char*>(text.c_str());
  EXPECT_EQ(decode(message.wire).error().message, "text: 513 bytes exceed 512");
}

}  // namespace
}  // namespace kinship::codec::publication_codec_test
