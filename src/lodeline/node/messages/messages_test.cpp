#include <gtest/gtest.h>

#include <cmath>

#include "lodeline/io/rosbag/definitions/message_conversion.h"
#include "lodeline/io/rosbag/definitions/message_text.h"
#include "lodeline/node/estimate_publisher.h"
#include "lodeline/node/messages/diagnostic_message.h"

// The reader of bags takes the messages of both serializations apart by their definitions. The tests of the
// ROS 1 node check the values with ROS's own types.

namespace lodeline {
namespace {

FrameEstimate someEstimate() {
  FrameEstimate estimate;
  estimate.time = Time::fromNanoseconds(1'500'000'000'123'456'789);
  estimate.state.world_from_body = Rigid3(so3::exp(Vec3(0.3, -0.5, 1.2)), Vec3(1.0, -2.0, 3.0));
  estimate.state.velocity_W = Vec3(0.4, 0.1, -0.2);
  for (int i = 0; i < 15; ++i) {
    for (int k = 0; k < 15; ++k) estimate.covariance(i, k) = std::sin(3.0 * i + 7.0 * k);
  }
  return estimate;
}

/// The same message in one of both serializations, with names whose lengths leave gaps in CDR.
wire::Bytes messageOf(Output output, const FrameNames& names, Serialization serialization) {
  const FrameEstimate estimate = someEstimate();
  const std::vector<MapPoint> points = {{1, Vec3(1.0, 2.0, 3.0), 4}, {2, Vec3(-5.5, 6.0, 7.0), 8}};
  DiagnosticStatus status;
  status.name = names.body;
  status.add("key", "value");
  switch (output) {
    case Output::Odometry:
      return odometryMessage(estimate, {Vec3(0.1, 0.2, 0.3), 0.02}, names, serialization);
    case Output::Pose:
      return poseMessage(estimate, names, serialization);
    case Output::PoseWithCovariance:
      return poseWithCovarianceMessage(estimate, names, serialization);
    case Output::Path:
      return pathMessage({{estimate.time, Rigid3()}, {estimate.time, estimate.state.world_from_body}}, names,
                         serialization);
    case Output::Landmarks:
      return landmarkCloud(points, estimate.time, names, serialization);
    case Output::Diagnostics:
      return diagnosticsMessage(estimate.time, {status, status}, serialization);
    case Output::Transforms:
      return transformsMessage(
          estimate.time, {bodyTransform(estimate, names), {names.map, names.world, Rigid3()}}, serialization);
  }
  return {};
}

TEST(NodeMessages, AreTheSameInBothSerializations) {
  const std::vector<Publication> topics = publications(true);
  for (const FrameNames& names :
       {FrameNames(), FrameNames{"a", "bc", "defg"}, FrameNames{"", "12345", "x"}}) {
    for (size_t i = 0; i < topics.size(); ++i) {
      const std::string& type = topics[i].type;
      const definitions::MessageConversion to_ros1(definitions::knownForm(type, Serialization::Cdr),
                                                   definitions::knownForm(type, Serialization::Ros1));
      const auto output = static_cast<Output>(i);
      EXPECT_EQ(to_ros1.convert(messageOf(output, names, Serialization::Cdr)),
                messageOf(output, names, Serialization::Ros1))
          << type;
    }
  }
}

TEST(NodeMessages, HoldNoMoreThanTheirFields) {
  const std::vector<Publication> topics = publications(true);
  for (size_t i = 0; i < topics.size(); ++i) {
    const definitions::MessageForm form = definitions::knownForm(topics[i].type, Serialization::Cdr);
    const wire::Bytes message = messageOf(static_cast<Output>(i), {}, Serialization::Cdr);
    definitions::FieldReader reader(message, Serialization::Cdr);
    reader.skip(form.type, form.type.root());
    EXPECT_EQ(reader.remaining(), 0U) << topics[i].type;
  }
}

TEST(NodeMessages, StateTheCovarianceRowByRow) {
  const FrameEstimate estimate = someEstimate();
  const wire::Bytes message = poseWithCovarianceMessage(estimate, {}, Serialization::Cdr);
  definitions::FieldReader reader(message, Serialization::Cdr);
  EXPECT_EQ(reader.number<int32_t>(), 1'500'000'000);
  EXPECT_EQ(reader.number<uint32_t>(), 123'456'789U);
  EXPECT_EQ(reader.text(), "odom");
  EXPECT_EQ(reader.number<double>(), 1.0);
  reader.numbers(sizeof(double), 6);
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) {
      EXPECT_EQ(reader.number<double>(), estimate.covariance(row, column)) << row << ' ' << column;
    }
  }
}

TEST(NodeMessages, RefuseTimesThatTheyCannotHold) {
  FrameEstimate estimate;
  estimate.time = Time::fromSeconds(2'200'000'000.0);  // in 2039
  EXPECT_THROW(poseMessage(estimate, {}, Serialization::Cdr), std::runtime_error);
  EXPECT_NO_THROW(poseMessage(estimate, {}, Serialization::Ros1));
}

}  // namespace
}  // namespace lodeline
