#include "proto/codec/fetch_codec.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/random_values.hpp"

namespace kinship::codec::fetch_codec_test {
namespace {

constexpr std::uint64_t kSeed = 33;

FetchReply ready_reply() {
  test::RandomValues values(kSeed);
  FetchReply reply;
  reply.status = FetchStatus::Ready;
  reply.distribution = values.distribution();
  reply.distribution->state = DistributionState::Ready;
  reply.distribution->mixture = values.mixture(reply.distribution->limits.cols());
  return reply;
}

TEST(FetchCodec, PlacementIsSevenNumbersOrNone) {
  FetchRequest request;
  request.task = "t";
  request.T_task_base = Eigen::Isometry3d::Identity();
  auto message = encode({}, request).value_or_throw();
  message.wire.T_task_base._length = 6;
  EXPECT_EQ(decode(message.wire).error().message, "T_task_base: 6 numbers, must be none or 7");
  message.wire.T_task_base._length = 0;
  EXPECT_FALSE(decode(message.wire)->T_task_base);
}

TEST(FetchCodec, NegativeDeadlineIsRefused) {
  FetchRequest request;
  request.task = "t";
  request.deadline = std::chrono::milliseconds(-1);
  EXPECT_EQ(encode({}, request).error().code, ErrorCode::InvalidInput);
}

TEST(FetchCodec, AProfileHas256BytesAtMostOnBothSides) {
  EXPECT_EQ(kMaxProfileBytes, 256U) << "proto/CONTRACT.md says so to other languages";
  FetchRequest request;
  request.task = "t";
  request.profile = std::string(kMaxProfileBytes, 'p');
  auto message = encode({}, request).value_or_throw();
  EXPECT_EQ(decode(message.wire).value_or_throw().profile, request.profile);
  request.profile += 'p';
  message.wire.profile = message.arena->text(request.profile);
  EXPECT_EQ(encode({}, request).error().message, "profile: 257 bytes exceed 256");
  EXPECT_EQ(decode(message.wire).error().message, "profile: 257 bytes exceed 256");

  FetchReply reply = ready_reply();
  reply.distribution->profile = request.profile;
  EXPECT_EQ(encode({}, reply).error().message, "profile: 257 bytes exceed 256");
  reply.distribution->profile.pop_back();
  auto sent = encode({}, reply).value_or_throw();
  EXPECT_EQ(decode(sent.wire).value_or_throw().distribution->profile, reply.distribution->profile);
  sent.wire.distribution._buffer[0].profile = sent.arena->text(request.profile);
  EXPECT_EQ(decode(sent.wire).error().message, "profile: 257 bytes exceed 256");
}

TEST(FetchCodec, DistributionBelongsToReadyAndFailed) {
  FetchReply reply = ready_reply();
  reply.status = FetchStatus::Pending;
  EXPECT_FALSE(encode({}, reply));
  reply.distribution.reset();
  EXPECT_TRUE(encode({}, reply));
  reply.status = FetchStatus::Ready;
  EXPECT_EQ(encode({}, reply).error().message, "distribution: missing");
}

TEST(FetchCodec, MixtureMustFitTheLimits) {
  auto message = encode({}, ready_reply()).value_or_throw();
  message.wire.distribution._buffer[0].limits._length -= 2;
  EXPECT_FALSE(decode(message.wire));
  FetchReply reply = ready_reply();
  reply.distribution->limits(0, 0) = reply.distribution->limits(1, 0) + 1;
  EXPECT_EQ(encode({}, reply).error().message.find("limits: joint 1 from "), 0U);
}

TEST(FetchCodec, WeightsMustBeProbabilities) {
  auto message = encode({}, ready_reply()).value_or_throw();
  message.wire.distribution._buffer[0].mixture._buffer[0].weights._buffer[0] += 0.1;
  EXPECT_EQ(decode(message.wire).error().message,
            "Mixture: weights must be >= 0 with sum 1, means finite");
}

TEST(FetchCodec, MixtureThatDoesNotFitIntoASampleIsTooLarge) {
  const Eigen::Index dof = 32;
  const Eigen::Index components = 1024;
  FetchReply reply = ready_reply();
  reply.distribution->limits = Eigen::Matrix2Xd::Zero(2, dof);
  reply.distribution->mixture =
      Mixture(Eigen::VectorXd::Constant(components, 1.0 / components),
              Eigen::MatrixXd::Zero(dof, components),
              std::vector<Eigen::MatrixXd>(components, Eigen::MatrixXd::Identity(dof, dof)));
  EXPECT_EQ(encode({}, reply).error().code, ErrorCode::TooLarge);
}

/// A reply with `count` kernels of seven joints.
FetchReply reply_of_kernels(Eigen::Index count) {
  FetchReply reply = ready_reply();
  reply.distribution->limits = Eigen::Matrix2Xd::Zero(2, 7);
  reply.distribution->limits.row(1).setOnes();
  reply.distribution->cuts.clear();
  reply.distribution->mixture = Mixture(
      Eigen::VectorXd::Constant(count, 1.0 / static_cast<double>(count)),
      Eigen::MatrixXd::NullaryExpr(7, count,
                                   [](Eigen::Index row, Eigen::Index column) {
                                     return static_cast<double>((column % 997) * 8 + row) / 8192;
                                   }),
      {Eigen::MatrixXd::Identity(7, 7) / 512});
  return reply;
}

TEST(FetchCodec, KernelsComeBackInFewBytes) {
  const FetchReply written = reply_of_kernels(4000);
  auto message = encode({}, written).value_or_throw();
  const kinship_wire_Distribution& wire = message.wire.distribution._buffer[0];
  EXPECT_EQ(wire.mixture._length, 0U);
  EXPECT_EQ(wire.kernels._buffer[0].centres._length, 7U * 4000);
  EXPECT_EQ(wire.kernels._buffer[0].covariance._length, 28U);
  const FetchReply read = decode(message.wire).value_or_throw();
  const Mixture& mixture = *read.distribution->mixture;
  EXPECT_TRUE(mixture.shares_covariance());
  EXPECT_EQ(mixture.means(), written.distribution->mixture->means());
  EXPECT_EQ(mixture.weights(), written.distribution->mixture->weights());
  EXPECT_EQ(mixture.covariances(), written.distribution->mixture->covariances());
}

TEST(FetchCodec, KernelsThatDoNotFitAreRefused) {
  EXPECT_EQ(encode({}, reply_of_kernels(4001)).error().code, ErrorCode::TooLarge);
  FetchReply far = reply_of_kernels(3);
  far.distribution->mixture =
      Mixture(Eigen::Vector2d(0.5, 0.5), Eigen::MatrixXd::Constant(7, 2, 1e300),
              {Eigen::MatrixXd::Identity(7, 7)});
  EXPECT_EQ(encode({}, far).error().message, "kernels: a centre is no finite f32");

  auto both = encode({}, reply_of_kernels(3)).value_or_throw();
  kinship_wire_Distribution& wire = both.wire.distribution._buffer[0];
  kinship_wire_Mixture none = {};
  wire.mixture._buffer = &none;
  wire.mixture._length = 1;
  EXPECT_EQ(decode(both.wire).error().message, "mixture: given, and kernels too");
  wire.mixture._length = 0;
  wire.kernels._buffer[0].centres._length = 20;
  EXPECT_EQ(decode(both.wire).error().message, "kernels: 20 numbers of centres, must be 21");
  wire.kernels._buffer[0].centres._length = 21;
  wire.kernels._buffer[0].covariance._length = 84;
  EXPECT_EQ(decode(both.wire).error().message, "kernels: 84 numbers of covariances, must be 28");
  wire.kernels._buffer[0].covariance._length = 28;
  EXPECT_TRUE(decode(both.wire));
  wire.kernels._buffer[0].centres._buffer[5] = std::numeric_limits<float>::infinity();
  EXPECT_FALSE(decode(both.wire));
  wire.kernels._length = 0;  // as a client that does not know the member sees it
  EXPECT_EQ(decode(both.wire).error().message, "mixture: missing although not failed");
}

TEST(FetchCodec, EvidenceAndSourcesMustBePossible) {
  FetchReply reply = ready_reply();
  reply.distribution->advice.guided = ModeEvidence{.attempts = 5, .solved = 6};
  EXPECT_EQ(encode({}, reply).error().message, "guided: 6 solved of 5");
  reply.distribution->advice.guided->solved = 5;
  reply.distribution->advice.guided->checks_per_solution = -1;
  EXPECT_EQ(encode({}, reply).error().message, "guided: checks_per_solution: -1 is negative");
  reply = ready_reply();
  reply.distribution->sources = {test::RandomValues(kSeed).source()};
  reply.distribution->sources[0].mass = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(encode({}, reply).error().message, "mass of a source: nan is not between 0 and 1");
  reply.distribution->sources[0].mass = 1;
  auto message = encode({}, reply).value_or_throw();
  message.wire.distribution._buffer[0].sources._buffer[0].relation = 3;
  EXPECT_EQ(decode(message.wire).error().message, "relation of a source: 3 is not between 0 and 2");
}

TEST(FetchCodec, RecentAttemptsAreJudgedOnesOldestFirst) {
  FetchReply reply = ready_reply();
  Advice& advice = reply.distribution->advice;
  advice.recent = {{SamplingMode::Guided, true, 500, 3}, {SamplingMode::Control, false, 900, 1}};
  EXPECT_EQ(
      decode(encode({}, reply).value_or_throw().wire).value_or_throw().distribution->advice.recent,
      advice.recent);
  advice.recent[1].age = 4;
  EXPECT_EQ(encode({}, reply).error().message, "recent: age 4 after 3, must be oldest first");
  advice.recent[1] = {SamplingMode::Uniform, true, 900, 1};
  EXPECT_EQ(encode({}, reply).error().message, "recent: an attempt of sampling_mode uniform");
  advice.recent.assign(kMaxJudgedAttempts + 1, {});
  EXPECT_EQ(encode({}, reply).error().code, ErrorCode::TooLarge);
  advice.recent.resize(1);
  auto message = encode({}, reply).value_or_throw();
  message.wire.distribution._buffer[0].recent._buffer[0].sampling_mode = 2;
  EXPECT_EQ(decode(message.wire).error().message,
            "sampling_mode of a recent attempt: 2 is not between 0 and 1");
}

TEST(FetchCodec, ScoresFallInComponentsAndCutsNameJoints) {
  FetchReply reply = ready_reply();
  Distribution& distribution = *reply.distribution;
  distribution.component_scores = {{40, 0.5}, {20, -1}};
  distribution.cuts.assign(static_cast<std::size_t>(distribution.limits.cols()), std::nullopt);
  distribution.cuts.back() = 1.5;
  auto message = encode({}, reply).value_or_throw();
  const Distribution read = *decode(message.wire).value_or_throw().distribution;
  EXPECT_EQ(read.component_scores, distribution.component_scores);
  EXPECT_EQ(read.cuts, distribution.cuts);
  message.wire.distribution._buffer[0].cuts._buffer[0].joint = 32;
  EXPECT_NE(decode(message.wire).error().message.find("cuts: joint 32 of "), std::string::npos);

  distribution.cuts.front() = -1.5;
  message = encode({}, reply).value_or_throw();
  message.wire.distribution._buffer[0].cuts._buffer[1].joint = 0;
  EXPECT_NE(decode(message.wire).error().message.find("cuts: joint 0 after joint 0"),
            std::string::npos);
  message = encode({}, reply).value_or_throw();
  message.wire.distribution._buffer[0].component_scores._buffer[0].components = 1025;
  EXPECT_EQ(decode(message.wire).error().code, ErrorCode::TooLarge);

  distribution.component_scores[1].components = 40;
  EXPECT_EQ(encode({}, reply).error().message,
            "component_scores: 40 after 40 components, must fall");
  distribution.component_scores.assign(kMaxComponentScores + 1, {1, 0});
  EXPECT_EQ(encode({}, reply).error().code, ErrorCode::TooLarge);
  distribution.component_scores.clear();
  distribution.cuts.emplace_back();
  EXPECT_EQ(encode({}, reply).error().code, ErrorCode::InvalidInput);
}

TEST(FetchCodec, WhatAFitBeganWithComesBackAndAddsUp) {
  FetchReply reply = ready_reply();
  std::optional<FitOrigin>& fit = reply.distribution->fit;
  fit.reset();
  EXPECT_FALSE(decode(encode({}, reply).value_or_throw().wire).value_or_throw().distribution->fit);
  fit = FitOrigin{4, 2, 525, 25, 30, ""};
  auto message = encode({}, reply).value_or_throw();
  EXPECT_EQ(decode(message.wire).value_or_throw().distribution->fit, fit);

  message.wire.distribution._buffer[0].fit._buffer[0].full_revision = 5;
  EXPECT_EQ(decode(message.wire).error().message, "fit: full_revision 5 exceeds from_revision 4");
  fit->new_paths = 526;
  EXPECT_EQ(encode({}, reply).error().message, "fit: new_paths 526 exceeds paths 525");
  fit = FitOrigin{0, 0, 5, 5, 6, "the first"};
  EXPECT_EQ(encode({}, reply).error().message, "fit: transferred 6 exceeds paths 5");
  fit = FitOrigin{0, 0, 5, 5, 5, std::string(kMaxMessageBytes + 1, 'x')};
  EXPECT_EQ(encode({}, reply).error().message.find("reason of a full fit: "), 0U);
}

TEST(FetchCodec, StatusOutOfRangeIsRefused) {
  FetchReply reply;
  reply.status = FetchStatus::Pending;
  auto message = encode({}, reply).value_or_throw();
  message.wire.status = 7;
  EXPECT_EQ(decode(message.wire).error().message, "status: 7 is not between 0 and 6");
}

}  // namespace
}  // namespace kinship::codec::fetch_codec_test
