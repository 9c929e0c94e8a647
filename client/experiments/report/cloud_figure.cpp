#include "client/experiments/report/cloud_figure.hpp"

#include <array>
#include <cstdio>
#include <limits>
#include <random>

#include "client/experiments/formatted.hpp"
#include "client/experiments/report/html.hpp"
#include "proto/mixture/sampler.hpp"
#include "robots/kinematics/forward_kinematics.hpp"

namespace kinship::experiments {
namespace {

constexpr double kSide = 300, kMargin = 12, kTitle = 20;  // pixels

constexpr std::array<const char*, kCloudPostures> kPostureColours = {
    "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#7a3e9d"};

Eigen::Matrix3Xd posture_of(const kinematics::Chain& chain, const Eigen::Isometry3d& T_task_base,
                            const Eigen::VectorXd& q) {
  const std::vector<Eigen::Isometry3d> joints = kinematics::joint_poses(chain, q);
  Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(joints.size()) + 1);
  for (std::size_t i = 0; i < joints.size(); ++i)
    points.col(static_cast<Eigen::Index>(i)) = T_task_base * joints[i].translation();
  points.rightCols<1>() = T_task_base * kinematics::T_base_transfer(chain, q).translation();
  return points;
}

/// The corners of a box's outline as seen; empty for other shapes.
Eigen::Matrix3Xd outline_of(const SceneObject& object, View view) {
  const auto* const box = std::get_if<BoxShape>(&object.shape);
  if (box == nullptr)
    return {};
  const Eigen::Vector3d half = box->size / 2;
  const int up = view == View::Top ? 1 : 2;
  Eigen::Matrix3Xd corners = Eigen::Matrix3Xd::Zero(3, 4);
  corners.row(0) << -half.x(), half.x(), half.x(), -half.x();
  corners.row(up) << -half[up], -half[up], half[up], half[up];
  for (auto&& corner : corners.colwise())
    corner = object.T_task_object * Eigen::Vector3d(corner);
  return corners;
}

/// Metres to pixels: all points of a cloud fit, both axes alike.
class Frame {
 public:
  Frame(const Cloud& cloud, View view) : up_(view == View::Top ? 1 : 2) {
    take(cloud.transfer_frames);
    for (const Eigen::Matrix3Xd& posture : cloud.postures)
      take(posture);
    for (const SceneObject& object : cloud.scene.objects)
      take(outline_of(object, view));
    scale_ = (kSide - 2 * kMargin) / (high_ - low_).maxCoeff();
  }

  std::string at(const Eigen::Vector3d& point) const {
    const double x = kMargin + scale_ * (point.x() - low_.x());
    const double y = kTitle + kSide - kMargin - scale_ * (point[up_] - low_.y());
    return formatted("%.1f %.1f", x, y);
  }

  std::string line(const Eigen::Matrix3Xd& points) const {
    std::string path;
    for (const auto& point : points.colwise())
      path += (path.empty() ? "M" : "L") + at(point);
    return path;
  }

 private:
  void take(const Eigen::Matrix3Xd& points) {
    for (const auto& point : points.colwise()) {
      const Eigen::Vector2d seen(point.x(), point[up_]);
      low_ = low_.cwiseMin(seen);
      high_ = high_.cwiseMax(seen);
    }
  }

  int up_;
  Eigen::Vector2d low_ = Eigen::Vector2d::Constant(std::numeric_limits<double>::max());
  Eigen::Vector2d high_ = Eigen::Vector2d::Constant(std::numeric_limits<double>::lowest());
  double scale_ = 1;
};

}  // namespace

Cloud draw_cloud(const kinematics::Chain& chain, const Eigen::Isometry3d& T_task_base,
                 const Mixture& mixture, const Scene& scene, std::uint64_t seed) {
  Eigen::Matrix2Xd limits(2, chain.dof());
  limits << chain.lower().transpose(), chain.upper().transpose();
  const mixture::Sampler sampler(mixture, limits);
  std::mt19937_64 generator(seed);
  Cloud cloud{Eigen::Matrix3Xd(3, kCloudSamples), {}, scene};
  Eigen::Index count = 0;
  for (int i = 0; i < kCloudSamples; ++i) {
    const auto q = sampler.sample(generator);
    if (!q)
      continue;
    cloud.transfer_frames.col(count++) =
        T_task_base * kinematics::T_base_transfer(chain, *q).translation();
    if (cloud.postures.size() < kCloudPostures)
      cloud.postures.push_back(posture_of(chain, T_task_base, *q));
  }
  cloud.transfer_frames.conservativeResize(Eigen::NoChange, count);
  return cloud;
}

std::string cloud_figure(const Cloud& cloud, View view, const std::string& title) {
  const Frame frame(cloud, view);
  std::string svg = formatted("<svg viewBox=\"0 0 %.0f %.0f\" width=\"%.0f\" font-size=\"12\">",
                              kSide, kSide + kTitle, kSide) +
                    "<text x=\"12\" y=\"14\">" + html::escaped(title) + "</text>\n";
  for (const SceneObject& object : cloud.scene.objects) {
    const Eigen::Matrix3Xd outline = outline_of(object, view);
    if (outline.cols() > 0)
      svg += "<path d=\"" + frame.line(outline) + "Z\" fill=\"#c9d1d9\" fill-opacity=\"0.7\"/>\n";
  }
  std::string dots;
  for (const auto& point : cloud.transfer_frames.colwise())
    dots += "M" + frame.at(point) + "h0";
  svg += "<path d=\"" + dots +
         "\" stroke=\"#0072b2\" stroke-width=\"1.6\" stroke-linecap=\"round\" "
         "stroke-opacity=\"0.45\"/>\n";
  for (std::size_t i = 0; i < cloud.postures.size(); ++i)
    svg += "<path d=\"" + frame.line(cloud.postures[i]) + "\" fill=\"none\" stroke=\"" +
           kPostureColours[i % kPostureColours.size()] +
           "\" stroke-width=\"2.5\" stroke-linejoin=\"round\" stroke-linecap=\"round\"/>\n";
  return svg + "</svg>\n";
}

}  // namespace kinship::experiments
