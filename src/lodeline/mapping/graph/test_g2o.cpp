#include "lodeline/mapping/graph/test_g2o.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <fstream>
#include <sstream>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

Rigid3 readPose(std::istream* line) {
  Vec3 p;
  Eigen::Vector4d q;
  for (double* value : {&p.x(), &p.y(), &p.z(), &q[0], &q[1], &q[2], &q[3]}) *line >> *value;
  return Rigid3(Quat(q).normalized(), p);
}

Mat6 readCovariance(std::istream* line, const Quat& from_to) {
  Mat6 information;
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) {
      *line >> information(i, j);
      information(j, i) = information(i, j);
    }
  }
  Mat6 to_axes = Mat6::Zero();
  to_axes.topLeftCorner<3, 3>() = from_to.toRotationMatrix();
  to_axes.bottomRightCorner<3, 3>() = 2.0 * from_to.toRotationMatrix();  // dtheta = 2 dq
  return to_axes * information.inverse() * to_axes.transpose();
}

}  // namespace

G2oGraph readG2o(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw InputError(fmt::format("cannot read {}", file.string()));
  G2oGraph graph;
  int number = 0;
  for (std::string text; std::getline(stream, text);) {
    ++number;
    std::istringstream line(text);
    std::string kind;
    if (!(line >> kind)) continue;
    if (kind == "VERTEX_SE3:QUAT") {
      KeyframeId id = -1;
      line >> id;
      graph.nodes[id] = readPose(&line);
    } else if (kind == "EDGE_SE3:QUAT") {
      GraphEdge edge;
      line >> edge.from >> edge.to;
      edge.relative.from_from_to = readPose(&line);
      edge.relative.covariance = readCovariance(&line, edge.relative.from_from_to.rotation);
      edge.robust = edge.to != edge.from + 1;
      graph.edges.push_back(edge);
    } else {
      throw InputError(fmt::format("{} line {}: unknown element {}", file.string(), number, kind));
    }
    if (!line) throw InputError(fmt::format("{} line {}: too few numbers", file.string(), number));
  }
  return graph;
}

}  // namespace lodeline
