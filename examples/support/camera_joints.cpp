// SPDX-License-Identifier: BSD-3-Clause
#include "camera_joints.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "calibration_instances.hpp"
#include "camera_calibration.hpp"
#include "dispatch.hpp"
#include "saved_model.hpp"
#include "vernier/calibration/joints_by_camera.hpp"

namespace support {

namespace {

namespace vn = vernier;

/// The parts of common errors that belong to the poses of a fit, found by their lines.
template <int N>
std::vector<vn::SharedErrors> of_training(const std::vector<vn::SharedErrors>& all, const vn::ImageRows& rows,
                                          const vn::CameraReport& camera, const MeasuredFiles<N>& measured) {
  std::vector<vn::SharedErrors> out;
  std::size_t set = 0;
  for (std::size_t base = 0; base < camera.in_base.size() && set < all.size(); ++base) {
    std::map<vn::Index, std::size_t> at;  // by line
    std::size_t count = 0;
    for (const vn::ImagePose& pose : camera.poses)
      if (pose.base == static_cast<vn::Index>(base))
        at.emplace(rows.origin.line[static_cast<std::size_t>(pose.row)], count++);
    if (count == 0) continue;
    vn::SharedErrors one;
    const vn::Dataset<N>& train = measured.train.poses()[set];
    one.joints = train.joints();
    for (const vn::Index line : train.origin().line) {
      one.covariances.push_back(all[set].covariances[at.at(line)]);
      one.effects.push_back(all[set].effects[at.at(line)]);
    }
    out.push_back(std::move(one));
    ++set;
  }
  return out;
}

template <int N>
CameraJoints calibrate_arm(const vn::RobotDescription& description, const CalibrationOptions& given,
                           const vn::FitOptions& fit) {
  CalibrationOptions o = options_for(given, description, 1);
  vn::ErrorModelOptions& errors = o.calibrate.errors;
  errors.tilt = errors.straightness = errors.drift = false;  // no errors of joint values
  CameraInputs in = read_camera_inputs(o);
  in.format.controller = description.controller;
  const vn::DescribedRobot<N> robot = description.arm<N>();
  const std::vector<vn::JointType> types = description.joint_types();
  const vn::ImageRows rows = vn::read_image_joints(o.data.front(), N, types, in.format);

  std::optional<vn::SavedModel> earlier;
  std::optional<vn::ArmPrior> prior;
  if (!o.prior.empty()) {
    earlier = vn::read_model(o.prior);
    prior = prior_of(*earlier, N);
  }
  vn::CalibrateOptions of_round = o.calibrate;
  if (prior) of_round.errors.prior = &*prior;
  of_round.remainder.on_geometry = of_round.remainder.on_error_model = false;
  of_round.errors.find_lines = false;  // high orders say nothing of the camera, and the last fit has them
  of_round.errors.harmonics = std::min(of_round.errors.harmonics, 60);
  of_round.keep_outliers = true;  // the loss weighs them down; the last fit names them
  of_round.fit = fit;
  // shares of the time that are over with each part, on average over 63 and 315 images; rounds come before the last fit
  constexpr double of_first = 0.18, of_images = 0.5, of_second = 0.67, of_rounds = 0.84;
  const auto part = [&o](double from, double to) {
    return [&o, from, to](const vn::Progress& progress) {
      o.reached(from + (to - from) * share_of_fit(progress.generation));
    };
  };
  const auto first = part(0, of_first), second = part(of_images, of_second), last = part(of_rounds, 1);
  const auto images = [&o](const vn::Progress& progress) {
    o.reached(of_first + (of_images - of_first) * share_of_images(progress.generation));
  };
  in.options.observer = images;
  int fits = 0;
  auto found = vn::calibrate_joints_by_camera(robot.arm, in.board, in.views, rows, in.options,
                                              [&](const vn::Measurements<N>& poses) {
                                                of_round.errors.observer = fits == 0   ? vn::ObserverRef(first)
                                                                           : fits == 1 ? vn::ObserverRef(second)
                                                                                       : vn::ObserverRef();
                                                ++fits;
                                                const auto calibration = vn::calibrate(robot.arm, poses, of_round);
                                                return vn::JointFit{calibration.errors, of_round.sensors, fit.executor};
                                              });
  MeasuredFiles<N> measured = hold_out_poses<N>(found.poses, o, types, fit.seed);
  measured.camera = setup_of(found.camera);
  measured.camera_error = found.camera.left_out_mean;
  double square = 0, held_out = 0;
  for (const vn::Dataset<N>& test : measured.test.poses())
    for (const vn::Matrix6& covariance : test.covariances()) {
      for (vn::Index k = 0; k < 3; ++k) square += covariance(k, k);
      ++held_out;
    }
  const double image_error = std::sqrt(square / std::max(held_out, 1.0));
  const std::vector<vn::SharedErrors> shared =
      of_training<N>(vn::shared_errors(found.camera, rows), rows, found.camera, measured);
  measured.covariance = [shared, common = found.camera.shared.covariance](const vn::ErrorModelEstimate& estimate) {
    return vn::covariance_with_shared_errors(estimate, shared, common);
  };
  measured.held_out += "; images held out have their share in the intrinsics";
  o.calibrate.errors.observer = last;
  const auto all = std::make_shared<const MeasuredFiles<N>>(std::move(measured));
  return {calibrate_measured<N>(description, o, fit, [&] { return all; }), found.camera, found.moved, found.converged,
          image_error};
}

}  // namespace

CameraJoints calibrate_joints_by_camera(const vernier::RobotDescription& robot, const CalibrationOptions& options,
                                        const vernier::FitOptions& fit) {
  return dispatch_dof(robot.dof(), [&](auto n) { return calibrate_arm<n()>(robot, options, fit); });
}

}  // namespace support
