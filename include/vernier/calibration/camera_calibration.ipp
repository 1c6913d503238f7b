// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/calibration/camera_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include "vernier/calibration/calibration_failure.hpp"
#include "vernier/camera/detail/camera_problem.hpp"
#include "vernier/camera/hand_eye.hpp"
#include "vernier/camera/planar_pose.hpp"
#include "vernier/core/check.hpp"
#include "vernier/core/data_error.hpp"
#include "vernier/core/detail/number_text.hpp"
#include "vernier/core/register_points.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/identification/detail/identification_plan.hpp"
#include "vernier/identification/identifiable_parameters.hpp"
#include "vernier/least_squares/prior_choice.hpp"

namespace vernier {

namespace detail {

/// Unknowns that are estimated or not, together.
struct NamedBlock {
  const char* name;
  std::array<bool, 9> intrinsics;
  bool bend;
};
inline constexpr std::array<NamedBlock, 6> camera_blocks{{
    {"radial distortion", {false, false, false, false, true, true, false, false, false}, false},
    {"tangential distortion", {false, false, false, false, false, false, true, true, false}, false},
    {"focal lengths", {true, true, false, false, false, false, false, false, false}, false},
    {"principal point", {false, false, true, true, false, false, false, false, false}, false},
    {"radial distortion of sixth order", {false, false, false, false, false, false, false, false, true}, false},
    {"bent board", {false, false, false, false, false, false, false, false, false}, true},
}};

using ViewNumbers = std::vector<std::size_t>;

/// Parameters of the chain that images determine beside frames and intrinsics: those that these absorb stay as
/// designed.
VERNIER_LOCAL std::vector<Index> determined_parameters(const CameraProblem& at) {
  CameraProblem problem = at;
  problem.free.arm = true;
  problem.free.scale = false;  // a gauge, which its prior holds
  const MatrixX rows = problem.dense_rows();
  const auto of_arm = static_cast<Index>(problem.priors.arm.size());
  const Index others = rows.cols() - 1 - of_arm;
  MatrixX columns(rows.rows(), rows.cols() - 1);
  columns.leftCols(others) = rows.middleCols(of_arm, others);
  columns.rightCols(of_arm) = rows.leftCols(of_arm);
  const IdentifiableParameters found(columns);
  std::vector<Index> out;
  for (Index j = 0; j < of_arm; ++j)
    if (std::find(found.base.begin(), found.base.end(), others + j) != found.base.end())
      out.push_back(problem.priors.arm[static_cast<std::size_t>(j)]);
  return out;
}

/// One calibration by cameras.
class CameraRun {
 public:
  VERNIER_LOCAL CameraRun(const std::optional<ArmGeometry>& nominal, const Board& board, const CornerViews& views,
                          const ImageRows& rows, const CameraOptions& options);

  VERNIER_LOCAL CameraReport run();

 private:
  /// A fit and the freedom that it has.
  struct Fit {
    CameraProblem problem;
    Index ambiguous;
  };

  VERNIER_LOCAL CameraFreedom first_freedom() const;
  VERNIER_LOCAL static bool adds(const CameraFreedom& free, const NamedBlock& block);
  VERNIER_LOCAL static CameraFreedom with(CameraFreedom free, const NamedBlock& block);
  VERNIER_LOCAL CameraPriors priors(const std::vector<Camera>& cameras) const;
  VERNIER_LOCAL CameraProblem problem_of(const ViewNumbers& numbers, CameraState state) const;
  /// Intrinsics of unknown cameras by images alone.
  VERNIER_LOCAL std::vector<Camera> starting_cameras(const ViewNumbers& numbers) const;
  /// Base and tool frames in closed form.
  VERNIER_LOCAL Index start_frames(const ViewNumbers& numbers, CameraState& state) const;
  /// From nothing to a fit, in stages.
  VERNIER_LOCAL Fit fit(const ViewNumbers& numbers, const CameraFreedom& free) const;
  /// Frames and links alone, with intrinsics and shape that are held; what is free is set for the report.
  VERNIER_LOCAL Fit fit_held(const ViewNumbers& numbers, const CameraFreedom& free) const;
  /// Frees unknowns and settles the noise.
  VERNIER_LOCAL void settle(CameraProblem& problem, const CameraFreedom& free) const;
  /// Decides on blocks by left-out images.
  VERNIER_LOCAL CameraFreedom choose(const ViewNumbers& numbers, std::vector<CameraBlock>* out) const;
  /// Groups of views to be left out together.
  VERNIER_LOCAL std::vector<ViewNumbers> folds(const ViewNumbers& numbers) const;
  /// Some of the images, where a fit of all has brought everything.
  VERNIER_LOCAL CameraProblem started(const ViewNumbers& numbers, const CameraProblem& of_all) const;
  /// The fit of some of the images, near that of all.
  VERNIER_LOCAL CameraProblem nearby(const ViewNumbers& numbers, const CameraProblem& of_all) const;
  /// Median distance on the board of each view, predicted without its group, from the fit of all as a start.
  VERNIER_LOCAL VectorX left_out_medians(const ViewNumbers& numbers, const CameraProblem& of_all) const;
  VERNIER_LOCAL void report_images(const CameraProblem& problem, CameraReport& out) const;
  VERNIER_LOCAL void report_left_out(const CameraProblem& of_all, CameraReport& out) const;
  VERNIER_LOCAL void report_unknowns(const CameraProblem& problem, CameraReport& out) const;
  /// Work of `choose` with some groups of views [fits].
  VERNIER_LOCAL double work_of_choice(double groups) const;
  /// Tells the observer that some more fits are done.
  VERNIER_LOCAL void did(double fits) const;

  const std::optional<ArmGeometry>& nominal_;
  const Board& board_;
  const CornerViews& views_;
  const ImageRows& rows_;
  const CameraOptions& options_;
  bool on_flange_;
  MatchedViews matched_;
  std::vector<PlacedView> placed_{};
  std::optional<ArmGeometry> chain_{};  // without frames
  std::vector<Isometry3> flanges_{};    // of the rows, nominal
  double work_ = 1;                     // in all [fits]
  mutable double done_ = 0;             // of it [fits]
};

/// Work of a group that is left out to decide on unknowns, beside that of a fit from its start.
inline constexpr double work_of_group = 0.5;

VERNIER_LOCAL ViewNumbers all_numbers(std::size_t size) {
  ViewNumbers out(size);
  std::iota(out.begin(), out.end(), std::size_t{0});
  return out;
}

VERNIER_LOCAL ViewNumbers without(const ViewNumbers& all, const ViewNumbers& left_out) {
  ViewNumbers out;
  for (const std::size_t k : all)
    if (std::find(left_out.begin(), left_out.end(), k) == left_out.end()) out.push_back(k);
  return out;
}

VERNIER_LOCAL double median_norm_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

VERNIER_IMPL CameraRun::CameraRun(const std::optional<ArmGeometry>& nominal, const Board& board,
                                  const CornerViews& views, const ImageRows& rows, const CameraOptions& options)
    : nominal_(nominal),
      board_(board),
      views_(views),
      rows_(rows),
      options_(options),
      on_flange_(options.mount == CameraMount::flange),
      matched_(match_images(views, rows)) {
  board.validate();
  demand(options.cameras.empty() || options.cameras.size() == views.cameras.size(),
         "CameraOptions: ", options.cameras.size(), " cameras for ", views.cameras.size(), " of the corners");
  if (options.held) {
    demand(options.held->cameras.size() == views.cameras.size(), "CameraOptions: ", options.held->cameras.size(),
           " held cameras for ", views.cameras.size(), " of the corners");
    demand(!options.choose && !options.left_out,
           "CameraOptions: held cameras beside choose or left_out, which estimate the intrinsics");
  }
  for (const std::string& name : options.free)
    demand(std::find(Camera::names.begin(), Camera::names.end(), name) != Camera::names.end(),
           "CameraOptions: no intrinsic is called '", name, "'");
  for (const Camera& camera : options.cameras) camera.validate();
  for (const View& view : views.views) {
    if (options.cameras.empty() || view.width == 0) continue;
    const Camera& camera = options.cameras[static_cast<std::size_t>(view.camera)];
    if (camera.width > 0 && (camera.width != view.width || camera.height != view.height))
      throw DataError(message(views.file, ", line ", view.line, ": image '", view.image, "' has ", view.width, " x ",
                              view.height, " pixels, the intrinsics are of ", camera.width, " x ", camera.height));
  }
  if (nominal_) {
    chain_ = nominal_->with_frames({}, {});
    flanges_ = chain_->poses(rows.joints);
  } else {
    flanges_ = rows.flanges;
  }
  for (std::size_t k = 0; k < matched_.views.size(); ++k) {
    const View& view = views.views[matched_.views[k]];
    placed_.push_back(
        {&view, matched_.rows[k], on_flange_ ? view.board : view.camera, on_flange_ ? view.camera : view.board});
  }
  if (placed_.size() < 4)
    throw CalibrationFailure(message(views.file, ": ", counted(placed_.size(), "image", "images"),
                                     " of a known pose of the arm; at least 4 are needed"));
}

VERNIER_IMPL CameraFreedom CameraRun::first_freedom() const {
  CameraFreedom out;
  out.scale = board_.scale_sigma > 0;
  out.arm = nominal_.has_value();
  out.bend = options_.bend;
  if (options_.cameras.empty()) std::fill_n(out.intrinsics.begin(), 6, true);  // up to k2
  for (const std::string& name : options_.free)
    out.intrinsics[static_cast<std::size_t>(std::find(Camera::names.begin(), Camera::names.end(), name) -
                                            Camera::names.begin())] = true;
  auto& free = out.intrinsics;  // no radial order without those below it: alone it has no bounds outside of the images
  constexpr std::size_t k1 = 4, k2 = 5, k3 = 8;
  free[k2] = free[k2] || free[k3];
  free[k1] = free[k1] || free[k2];
  return out;
}

VERNIER_IMPL bool CameraRun::adds(const CameraFreedom& free, const NamedBlock& block) {
  bool out = block.bend && !free.bend;
  for (std::size_t k = 0; k < free.intrinsics.size(); ++k) out = out || (block.intrinsics[k] && !free.intrinsics[k]);
  return out;
}

VERNIER_IMPL CameraFreedom CameraRun::with(CameraFreedom free, const NamedBlock& block) {
  free.bend = free.bend || block.bend;
  for (std::size_t k = 0; k < free.intrinsics.size(); ++k)
    free.intrinsics[k] = free.intrinsics[k] || block.intrinsics[k];
  return free;
}

VERNIER_IMPL CameraPriors CameraRun::priors(const std::vector<Camera>& cameras) const {
  CameraPriors out;
  out.cameras = cameras;
  const bool known = !options_.cameras.empty();
  const double focal = cameras.front().fx;
  out.intrinsics.resize(Camera::num_parameters);
  for (Index k = 0; k < 4; ++k) out.intrinsics(k) = (known ? 0.01 : 0.3) * focal;
  for (Index k = 4; k < Camera::num_parameters; ++k) out.intrinsics(k) = k == 6 || k == 7 ? 0.005 : 0.2;
  if (!known) {  // what images alone say of distortion is a start, no mean
    for (Camera& camera : out.cameras) camera.k1 = camera.k2 = camera.p1 = camera.p2 = camera.k3 = 0;
    for (Index k = 4; k < Camera::num_parameters; ++k) out.intrinsics(k) = k == 6 || k == 7 ? 0.01 : 0.5;
  }
  if (nominal_) {
    const IdentificationPlan plan(*nominal_, options_.geometry);
    out.arm_means = chain_->parameters();
    out.arm_scales = plan.scales;
    constexpr double wide = 3;  // images determine most of them
    out.arm_scales *= wide;
    for (const Index k : plan.candidates)
      if (plan.in_chain(k)) out.arm.push_back(k);
  }
  return out;
}

VERNIER_IMPL CameraProblem CameraRun::problem_of(const ViewNumbers& numbers, CameraState state) const {
  std::vector<PlacedView> some;
  for (const std::size_t k : numbers) some.push_back(placed_[k]);
  CameraPriors of_cameras = priors(options_.cameras.empty() ? state.cameras : options_.cameras);
  CameraProblem out(on_flange_, board_, std::move(some), rows_, std::move(state), std::move(of_cameras));
  out.loss = options_.loss;
  out.pixel_sigma = 0.2;  // [px], where the iteration starts
  return out;
}

VERNIER_IMPL std::vector<Camera> CameraRun::starting_cameras(const ViewNumbers& numbers) const {
  if (!options_.cameras.empty()) return options_.cameras;
  std::vector<Camera> out;
  for (std::size_t c = 0; c < views_.cameras.size(); ++c) {
    std::vector<Matrix3> homographies;
    Vector2 low(0, 0), high(0, 0);
    bool any = false;
    Index width = 0, height = 0;
    for (const std::size_t k : numbers) {
      const View& view = *placed_[k].view;
      if (view.camera != static_cast<Index>(c)) continue;
      width = view.width;
      height = view.height;
      for (const Vector2& pixel : view.pixels)
        for (Index axis = 0; axis < 2; ++axis) {
          low(axis) = any ? (std::min)(low(axis), pixel(axis)) : pixel(axis);
          high(axis) = any ? (std::max)(high(axis), pixel(axis)) : pixel(axis);
          if (axis == 1) any = true;
        }
      if (view.corners.size() < 8) continue;
      std::vector<Vector2> plane;
      for (const Index corner : view.corners) plane.emplace_back(board_.corner(corner)(0), board_.corner(corner)(1));
      const Matrix3 h = homography(plane, view.pixels);
      if (h.allFinite()) homographies.push_back(h);
    }
    Camera camera = camera_from_homographies(homographies);
    const Vector2 middle = width > 0 ? Vector2(static_cast<double>(width - 1) / 2, static_cast<double>(height - 1) / 2)
                                     : Vector2((low + high) / 2);
    const double size = width > 0 ? static_cast<double>((std::max)(width, height)) : (high - low).maxCoeff();
    const bool plausible = camera.fx > 0.2 * size && camera.fx < 20 * size && camera.fy > 0.2 * size &&
                           camera.fy < 20 * size && (Vector2(camera.cx, camera.cy) - middle).norm() < size;
    if (!plausible) {
      camera = Camera{.fx = size, .fy = size, .cx = middle(0), .cy = middle(1)};
      if (homographies.size() < 3)
        throw CalibrationFailure(message(views_.file, ": camera '", views_.cameras[c], "' has ", homographies.size(),
                                         " images of at least 8 corners, 3 are needed where its intrinsics are "
                                         "unknown; or state --intrinsics"));
    }
    camera.width = width;
    camera.height = height;
    out.push_back(camera);
  }
  // the images alone, wherever the arm was
  ViewNumbers rich;
  std::vector<Isometry3> poses;
  for (const std::size_t k : numbers) {
    const View& view = *placed_[k].view;
    if (view.corners.size() < 8) continue;
    const BoardPose pose =
        board_poses(out[static_cast<std::size_t>(view.camera)], board_, view.corners, view.pixels)[0];
    if (!std::isfinite(pose.rms)) continue;
    rich.push_back(k);
    poses.push_back(pose.camera_T_board);
  }
  CameraState state;
  state.cameras = out;
  CameraProblem images = problem_of(rich, state);
  images.free.intrinsics = {true, true, true, true, false, false, false, false, false};
  refine_cameras(images, poses);
  images.free.intrinsics = {true, true, true, true, true, true, false, false, false};
  refine_cameras(images, poses);
  for (std::size_t c = 0; c < out.size(); ++c) {
    const Camera& found = images.state.cameras[c];
    if (found.fx > 0 && found.fy > 0 && std::isfinite(found.parameters().sum())) out[c] = found;
  }
  return out;
}

/// The mean of poses.
VERNIER_LOCAL Isometry3 mean_pose(const std::vector<Isometry3>& poses) {
  Matrix3 turns = Matrix3::Zero();
  Vector3 shifts(0, 0, 0);
  for (const Isometry3& pose : poses) {
    turns += rotation(pose);
    shifts += translation(pose) / static_cast<double>(poses.size());
  }
  return rigid_motion(nearest_rotation(turns), shifts);
}

VERNIER_IMPL Index CameraRun::start_frames(const ViewNumbers& numbers, CameraState& state) const {
  const std::size_t places = views_.boards.size(), cameras = views_.cameras.size();
  state.bases.assign(on_flange_ ? places : cameras, Isometry3::Identity());
  state.tools.assign(on_flange_ ? cameras : places, Isometry3::Identity());
  struct Group {
    Index base, tool;
    std::vector<Isometry3> flanges{};
    std::vector<std::array<Isometry3, 2>> seen{};
  };
  std::vector<Group> groups;
  for (const std::size_t k : numbers) {
    const PlacedView& placed = placed_[k];
    const View& view = *placed.view;
    if (view.corners.size() < 4) continue;
    auto poses = board_poses(state.cameras[static_cast<std::size_t>(view.camera)], board_, view.corners, view.pixels);
    if (!std::isfinite(poses[0].rms)) continue;
    const Matrix3 turn = rotation(poses[1].camera_T_board) * rotation(poses[0].camera_T_board).transpose();
    const bool same = !std::isfinite(poses[1].rms) || log_so3(turn).norm() < 0.01;
    if (same || !(poses[1].rms < 30 * poses[0].rms + 3)) poses[1] = poses[0];
    auto group = std::find_if(groups.begin(), groups.end(),
                              [&](const Group& g) { return g.base == placed.base && g.tool == placed.tool; });
    if (group == groups.end()) group = groups.insert(group, Group{placed.base, placed.tool});
    group->flanges.push_back(flanges_[static_cast<std::size_t>(placed.row)]);
    std::array<Isometry3, 2> pair;
    for (std::size_t c = 0; c < 2; ++c)
      pair[c] = on_flange_ ? inverse_of(poses[c].camera_T_board) : poses[c].camera_T_board;
    group->seen.push_back(pair);
  }
  std::sort(groups.begin(), groups.end(),
            [](const Group& a, const Group& b) { return a.flanges.size() > b.flanges.size(); });
  std::vector<bool> base_known(state.bases.size(), false), tool_known(state.tools.size(), false);
  Index ambiguous = 0;
  for (const Group& group : groups) {
    const auto base = static_cast<std::size_t>(group.base), tool = static_cast<std::size_t>(group.tool);
    const std::string who = message("camera '", views_.cameras[on_flange_ ? tool : base], "' and board '",
                                    views_.boards[on_flange_ ? base : tool], "'");
    if (base_known[base] && tool_known[tool]) continue;
    if (group.flanges.size() < 3)
      throw CalibrationFailure(message(views_.file, ": ", who, ": ", counted(group.flanges.size(), "image", "images"),
                                       " of at least 4 corners, 3 or more are needed"));
    const HandEye found = consistent_hand_eye(group.flanges, group.seen);
    if (!base_known[base] && !tool_known[tool] && !(found.spread > 1e-5))
      throw CalibrationFailure(
          message(views_.file, ": ", who, ": the flange turned about one axis only; turn it about others, too"));
    if (!(found.rotation_rms < 0.5))
      throw CalibrationFailure(message(views_.file, ": ", who,
                                       ": the images do not agree with the poses of the arm (by ",
                                       std::round(found.rotation_rms * 180 / std::numbers::pi),
                                       " deg); wrong rows, another "
                                       "--camera-mount, or another robot?"));
    for (const std::size_t c : found.chosen) ambiguous += c == 1 ? 1 : 0;
    std::vector<Isometry3> frames;
    for (std::size_t i = 0; i < group.flanges.size(); ++i) {
      const Isometry3& seen = group.seen[i][found.chosen[i]];
      if (tool_known[tool])  // seen = base flange tool
        frames.push_back(composed(seen, inverse_of(composed(group.flanges[i], state.tools[tool]))));
      else if (base_known[base])
        frames.push_back(composed(inverse_of(composed(state.bases[base], group.flanges[i])), seen));
    }
    if (!base_known[base]) state.bases[base] = tool_known[tool] ? mean_pose(frames) : found.base;
    if (!tool_known[tool]) state.tools[tool] = base_known[base] ? mean_pose(frames) : found.tool;
    base_known[base] = tool_known[tool] = true;
  }
  for (std::size_t b = 0; b < base_known.size(); ++b)
    if (!base_known[b])
      throw CalibrationFailure(message(views_.file, ": ", on_flange_ ? "board '" : "camera '",
                                       on_flange_ ? views_.boards[b] : views_.cameras[b],
                                       "' is in no image of at least 4 corners and a known pose of the arm"));
  for (std::size_t t = 0; t < tool_known.size(); ++t)
    if (!tool_known[t])
      throw CalibrationFailure(message(views_.file, ": ", on_flange_ ? "camera '" : "board '",
                                       on_flange_ ? views_.cameras[t] : views_.boards[t],
                                       "' is in no image of at least 4 corners and a known pose of the arm"));
  return ambiguous;
}

VERNIER_IMPL void CameraRun::settle(CameraProblem& problem, const CameraFreedom& free) const {
  problem.free = free;
  problem.free.arm = false;
  problem.free.bend = false;
  problem.solve(60);
  for (int pass = 0; pass < 2; ++pass) {
    std::vector<double> norms;
    const std::vector<Isometry3> poses = problem.poses();
    for (std::size_t v = 0; v < poses.size(); ++v)
      for (const Vector2& r : problem.residuals(problem.views()[v], poses[v])) norms.push_back(r.norm());
    constexpr double median_of_two = 1.1774, least = 0.01;
    const auto values = static_cast<double>(problem.values()), spare = values - static_cast<double>(problem.unknowns());
    const double inflation = std::sqrt(values / (std::max)(spare, 0.2 * values));
    problem.pixel_sigma = (std::max)(least, inflation * median_norm_of(std::move(norms)) / median_of_two);
    problem.free = free;
    problem.solve(60);
  }
}

VERNIER_IMPL CameraRun::Fit CameraRun::fit(const ViewNumbers& numbers, const CameraFreedom& free) const {
  CameraState state;
  state.arm = chain_;
  state.cameras = starting_cameras(numbers);
  const Index ambiguous = start_frames(numbers, state);
  CameraProblem problem = problem_of(numbers, std::move(state));
  problem.solve(30);  // frames alone
  if (nominal_) problem.priors.arm = determined_parameters(problem);
  settle(problem, free);
  return {std::move(problem), ambiguous};
}

VERNIER_IMPL CameraRun::Fit CameraRun::fit_held(const ViewNumbers& numbers, const CameraFreedom& free) const {
  CameraState state;
  state.arm = chain_;
  state.cameras = options_.held->cameras;
  state.shape = {options_.held->board_scale - 1, options_.held->board_bend};
  const Index ambiguous = start_frames(numbers, state);
  CameraProblem problem = problem_of(numbers, std::move(state));
  problem.solve(30);  // frames alone
  if (nominal_) problem.priors.arm = determined_parameters(problem);
  CameraFreedom links;
  links.arm = free.arm;
  settle(problem, links);
  problem.free = free;
  return {std::move(problem), ambiguous};
}

VERNIER_IMPL std::vector<ViewNumbers> CameraRun::folds(const ViewNumbers& numbers) const {
  std::map<Index, Index> group_of_row;  // views of one image are left out together
  for (const std::size_t k : numbers) group_of_row.emplace(placed_[k].row, 0);
  constexpr Index most_alone = 20, groups = 10;
  const auto images = static_cast<Index>(group_of_row.size());
  const Index count = images <= most_alone ? images : groups;
  Index next = 0;
  for (auto& [row, group] : group_of_row) group = next++ % count;
  std::vector<ViewNumbers> out(static_cast<std::size_t>(count));
  for (const std::size_t k : numbers) out[static_cast<std::size_t>(group_of_row.at(placed_[k].row))].push_back(k);
  return out;
}

VERNIER_IMPL CameraProblem CameraRun::started(const ViewNumbers& numbers, const CameraProblem& of_all) const {
  CameraProblem problem = problem_of(numbers, of_all.state);
  problem.priors = of_all.priors;
  problem.pixel_sigma = of_all.pixel_sigma;
  problem.free = of_all.free;
  return problem;
}

VERNIER_IMPL CameraProblem CameraRun::nearby(const ViewNumbers& numbers, const CameraProblem& of_all) const {
  CameraProblem problem = started(numbers, of_all);
  settle(problem, of_all.free);
  return problem;
}

VERNIER_IMPL VectorX CameraRun::left_out_medians(const ViewNumbers& numbers, const CameraProblem& of_all) const {
  std::map<std::size_t, double> found;
  for (const ViewNumbers& fold : folds(numbers)) {
    CameraProblem problem = started(without(numbers, fold), of_all);
    problem.solve(30);
    did(work_of_group);
    for (const std::size_t k : fold) {
      const VectorX errors = problem.board_errors(placed_[k], problem.pose_of(placed_[k]));
      found[k] = median_norm_of({errors.begin(), errors.end()});
    }
  }
  VectorX out(static_cast<Index>(numbers.size()));
  for (std::size_t i = 0; i < numbers.size(); ++i) out(static_cast<Index>(i)) = found.at(numbers[i]);
  return out;
}

/// Unknowns that one problem has and another has not: their values in units of their scales, and their numbers.
VERNIER_LOCAL std::pair<VectorX, std::vector<Index>> added_unknowns(const CameraProblem& without,
                                                                    const CameraProblem& with) {
  std::vector<double> values;
  std::vector<Index> numbers;
  Index shared = (with.free.scale ? 1 : 0) + (with.free.bend ? 3 : 0);
  const auto cameras = static_cast<Index>(with.state.cameras.size());
  for (const bool free : with.free.intrinsics) shared += free ? cameras : 0;
  const VectorX scales = with.scales();
  Index at = with.unknowns() - shared;
  const auto add = [&](bool added, double value) {
    if (added) {
      values.push_back(value / scales(at));
      numbers.push_back(at);
    }
    ++at;
  };
  for (std::size_t c = 0; c < with.state.cameras.size(); ++c)
    for (Index k = 0; k < Camera::num_parameters; ++k)
      if (with.free.intrinsics[static_cast<std::size_t>(k)])
        add(!without.free.intrinsics[static_cast<std::size_t>(k)],
            with.state.cameras[c].parameters()(k) - without.state.cameras[c].parameters()(k));
  if (with.free.scale) ++at;
  for (Index k = 0; with.free.bend && k < 3; ++k) add(!without.free.bend, with.state.shape.bend(k));
  return {Eigen::Map<const VectorX>(values.data(), static_cast<Index>(values.size())), numbers};
}

/// Whether unknowns that were added differ from where they were held: Hotelling's test at 1 %. What the arm lacks is
/// common to the corners of an image, so images are what counts, unless pixels alone scatter more.
VERNIER_LOCAL bool differ(const CameraProblem& without, const CameraProblem& with) {
  const auto [values, numbers] = added_unknowns(without, with);
  const auto k = static_cast<double>(values.size()), images = static_cast<double>(with.views().size());
  if (!(images > k + 1)) return false;
  const auto part = [&numbers = numbers](const MatrixX& of) {
    const auto count = static_cast<Index>(numbers.size());
    MatrixX out(of.size() > 0 ? count : 0, count);
    for (Index r = 0; r < out.rows(); ++r)
      for (Index c = 0; c < count; ++c)
        out(r, c) = of(numbers[static_cast<std::size_t>(r)], numbers[static_cast<std::size_t>(c)]);
    return out;
  };
  MatrixX factor = part(with.covariance());
  if (const MatrixX by_images = part(with.jackknife()); by_images.size() > 0 && by_images.trace() > factor.trace())
    factor = by_images;
  if (factor.size() == 0 || !cholesky(factor)) return false;
  VectorX whitened = values;
  solve_lower(factor, whitened);
  // tail of F with k and images - k degrees of freedom, by Paulson's approximation
  const double dof = images - k, f = whitened.squaredNorm() * dof / (k * (images - 1)), a = 2 / (9 * k),
               b = 2 / (9 * dof);
  const double z = ((1 - b) * std::cbrt(f) - (1 - a)) / std::sqrt(b * std::cbrt(f * f) + a);
  constexpr double level_1_percent = 2.326;  // quantile of the standard normal distribution
  return z > level_1_percent;
}

VERNIER_IMPL CameraFreedom CameraRun::choose(const ViewNumbers& numbers, std::vector<CameraBlock>* out) const {
  CameraFreedom free = first_freedom();
  if (!options_.choose) return free;
  CameraProblem now = fit(numbers, free).problem;
  did(1);
  VectorX errors = left_out_medians(numbers, now);
  for (const NamedBlock& block : camera_blocks) {
    if (!adds(free, block)) continue;
    CameraProblem larger = now;
    settle(larger, with(free, block));
    did(1);
    const VectorX with_block = left_out_medians(numbers, larger);
    CameraBlock tried{block.name, errors.mean(), with_block.mean()};
    constexpr double relevant = 0.1;  // share of the error that an effect is which matters; they add in quadrature
    const double explained = tried.without * tried.without - tried.with * tried.with;
    tried.kept = differ(now, larger) && explained > relevant * relevant * tried.without * tried.without &&
                 !predicts_worse(with_block, errors);
    if (tried.kept) {
      free = larger.free;
      now = std::move(larger);
      errors = with_block;
    }
    if (out != nullptr) out->push_back(std::move(tried));
  }
  return free;
}

VERNIER_IMPL void CameraRun::report_images(const CameraProblem& problem, CameraReport& out) const {
  double sum = 0;
  Index corners = 0;
  const double ratio = out.pixel_sigma / problem.pixel_sigma, by_pixels = ratio > 0 ? ratio * ratio : 1;
  const Index shared = out.shared.covariance.rows(), first = problem.unknowns() - shared;
  const VectorX scales = problem.scales();
  out.shared.information = MatrixX::Zero(shared, shared);
  out.shared.gradient = VectorX::Zero(shared);
  const std::vector<Isometry3> poses = problem.poses();
  for (std::size_t v = 0; v < placed_.size(); ++v) {
    const View& view = *placed_[v].view;
    ImageError one{view.image, view.camera, view.board, static_cast<Index>(view.corners.size())};
    double squares = 0;
    const std::vector<Vector2> residuals = problem.residuals(placed_[v], poses[v]);
    for (std::size_t i = 0; i < residuals.size(); ++i) {
      squares += residuals[i].squaredNorm();
      const Vector2& pixel = view.pixels[i];
      out.residuals.push_back({static_cast<Index>(v), pixel(0), pixel(1), residuals[i](0), residuals[i](1)});
    }
    one.pixel_rms = std::sqrt(squares / static_cast<double>(one.corners));
    const VectorX errors = problem.board_errors(placed_[v], poses[v]);
    one.board_mean = errors.mean();
    const Isometry3 board = on_flange_ ? inverse_of(poses[v]) : poses[v];
    one.distance = transformed(board, board_.middle()).norm();
    one.tilt = std::acos((std::min)(1.0, std::abs(board(2, 2))));
    sum += errors.sum();
    corners += one.corners;
    for (std::size_t i = 0; i < view.corners.size(); ++i) out.downweighted += problem.weight(v, i) < 0.5 ? 1 : 0;
    out.images.push_back(std::move(one));
    const auto seen = problem.seen_pose(v);
    if (!seen) continue;
    if (shared > 0) problem.add_own(v, seen->first, out.shared.information, out.shared.gradient);
    if (!positive_definite(seen->second, 6)) continue;
    MatrixX by_shared(6, 0);
    if (shared > 0) by_shared = problem.effect_of_shared(v, seen->first);
    for (Index k = 0; k < shared; ++k)
      for (Index r = 0; r < 6; ++r) by_shared(r, k) /= scales(first + k);
    out.poses.push_back({placed_[v].row, placed_[v].base, placed_[v].tool, seen->first, by_pixels * seen->second,
                         std::move(by_shared)});
  }
  out.mean = sum / static_cast<double>(corners);
  out.shared.information /= by_pixels;  // the noise as it is
  out.shared.gradient /= by_pixels;
  const auto [precisions, steps] = problem.prior_terms();
  for (Index c = 0; c < shared; ++c) {
    out.shared.information(c, c) += precisions(first + c);  // priors count as stated
    out.shared.gradient(c) += precisions(first + c) * steps(first + c);
    out.shared.gradient(c) /= scales(first + c);
    for (Index r = 0; r < shared; ++r) out.shared.information(r, c) /= scales(first + r) * scales(first + c);
  }
}

VERNIER_IMPL void CameraRun::report_left_out(const CameraProblem& of_all, CameraReport& out) const {
  const ViewNumbers all = all_numbers(placed_.size());
  const std::vector<ViewNumbers> groups = folds(all);
  out.choices_repeated = groups.size() >= placed_.size();
  double sum = 0;
  Index corners = 0;
  for (const ViewNumbers& fold : groups) {
    const ViewNumbers kept = without(all, fold);
    // a tenth of many images moves nothing far: fits without it start from that of all
    const CameraProblem problem =
        out.choices_repeated ? fit(kept, choose(kept, nullptr)).problem : nearby(kept, of_all);
    did(1);
    for (const std::size_t k : fold) {
      const VectorX errors = problem.board_errors(placed_[k], problem.pose_of(placed_[k]));
      out.images[k].left_out_mean = errors.mean();
      out.images[k].left_out_max = errors.maxCoeff();
      out.left_out_max = (std::max)(out.left_out_max, errors.maxCoeff());
      sum += errors.sum();
      corners += static_cast<Index>(errors.size());
    }
  }
  out.left_out_mean = sum / static_cast<double>(corners);
}

/// Takes small motions of a pose to those of its inverse.
VERNIER_LOCAL Matrix6 motion_of_inverse(const Isometry3& pose) {
  const Matrix3 back = rotation(pose).transpose();
  Matrix6 out = Matrix6::Zero();
  out.topLeftCorner<3, 3>() = -back;
  out.topRightCorner<3, 3>() = -back * skew(translation(pose));
  out.bottomRightCorner<3, 3>() = -back;
  return out;
}

VERNIER_IMPL void CameraRun::report_unknowns(const CameraProblem& problem, CameraReport& out) const {
  const MatrixX inverse = problem.covariance();
  const bool known = inverse.size() > 0;
  const VectorX scales = problem.scales();
  // errors of the arm are common to the corners of an image: the larger of what pixels and what images say
  const MatrixX by_images = problem.jackknife();
  const auto larger = [&](Index first, Index count) {
    double of_pixels = 0, of_images = 0;
    for (Index k = first; k < first + count && by_images.size() > 0 && known; ++k) {
      of_pixels += inverse(k, k);
      of_images += by_images(k, k);
    }
    return of_images > of_pixels ? &by_images : &inverse;
  };
  const auto variance = [&](Index k) { return known ? (*larger(k, 1))(k, k) * scales(k) * scales(k) : 0; };
  out.pose_excess = std::sqrt(problem.scatter().poses);
  Index at = 0;
  if (problem.free.arm) {
    const VectorX now = problem.state.arm->parameters();
    const std::vector<std::string> names = problem.state.arm->parameter_names();
    const std::vector<ParameterKind> kinds = problem.state.arm->parameter_kinds();
    for (const Index k : problem.priors.arm) {
      const auto place = static_cast<std::size_t>(k);
      out.parameters.push_back({names[place], now(k) - problem.priors.arm_means(k), std::sqrt(variance(at)),
                                kinds[place] == ParameterKind::length});
      ++at;
    }
  }
  const auto frames = [&](const std::vector<Isometry3>& poses, bool inverted, std::vector<Isometry3>& found,
                          std::vector<Vector6>& stds) {
    for (const Isometry3& pose : poses) {
      Matrix6 covariance = Matrix6::Zero();
      const MatrixX& from = *larger(at, 6);
      for (Index r = 0; r < 6 && known; ++r)
        for (Index c = 0; c < 6; ++c) covariance(r, c) = from(at + r, at + c) * scales(at + r) * scales(at + c);
      const Matrix6 motion = inverted ? motion_of_inverse(pose) : Matrix6(Matrix6::Identity());
      const Matrix6 carried = motion * covariance * motion.transpose();
      Vector6 std;
      for (Index r = 0; r < 6; ++r) std(r) = std::sqrt(carried(r, r));
      found.push_back(inverted ? inverse_of(pose) : pose);
      stds.push_back(std);
      at += 6;
    }
  };
  frames(problem.state.bases, true, out.in_base, out.in_base_std);
  frames(problem.state.tools, false, out.in_flange, out.in_flange_std);
  if (const Index shared = problem.unknowns() - at; shared > 0 && known) {
    const MatrixX& from = *larger(at, shared);
    out.shared.covariance.resize(shared, shared);
    for (Index c = 0; c < shared; ++c)
      for (Index r = 0; r < shared; ++r)
        out.shared.covariance(r, c) = from(at + r, at + c) * scales(at + r) * scales(at + c);
  }
  for (std::size_t c = 0; c < problem.state.cameras.size(); ++c) {
    VectorX std = VectorX::Zero(Camera::num_parameters);
    std::vector<Index> estimated;
    const Index begin = at;
    for (Index k = 0; k < Camera::num_parameters; ++k)
      if (problem.free.intrinsics[static_cast<std::size_t>(k)]) {
        estimated.push_back(k);
        std(k) = std::sqrt(variance(at++));
      }
    MatrixX covariance = MatrixX::Zero(Camera::num_parameters, Camera::num_parameters);
    const auto count = static_cast<Index>(estimated.size());
    for (Index r = 0; r < count && known; ++r)  // correlations of the larger, with these standard deviations
      for (Index s = 0; s < count; ++s) {
        const MatrixX& from = *larger(begin, count);
        const Index row = estimated[static_cast<std::size_t>(r)], column = estimated[static_cast<std::size_t>(s)];
        covariance(row, column) = from(begin + r, begin + s) /
                                  std::sqrt(from(begin + r, begin + r) * from(begin + s, begin + s)) * std(row) *
                                  std(column);
      }
    out.camera_std.push_back(std);
    out.camera_covariances.push_back(covariance);
  }
  if (problem.free.scale) out.board_scale_std = std::sqrt(variance(at++));
  out.cameras = problem.state.cameras;
  out.board_scale = 1 + problem.state.shape.scale;
  out.board_bend = problem.state.shape.bend;
  if (!problem.state.arm) return;
  out.arm = problem.state.arm->with_frames(problem.state.bases.front(), problem.state.tools.front());
  double reach = 0;
  for (const Isometry3& flange : flanges_) reach = (std::max)(reach, translation(flange).norm());
  out.scale_effect = out.board_scale_std * reach;
}

VERNIER_IMPL double CameraRun::work_of_choice(double groups) const {
  if (!options_.choose) return 0;
  double tries = 1;
  for (const NamedBlock& block : camera_blocks) tries += adds(first_freedom(), block) ? 1 : 0;
  return tries * (1 + work_of_group * groups);
}

VERNIER_IMPL void CameraRun::did(double fits) const {
  done_ += fits;
  options_.observer({static_cast<Index>(std::floor(camera_steps * (std::min)(done_ / work_, 1.0))), 0, 0});
}

VERNIER_IMPL CameraReport CameraRun::run() {
  CameraReport out;
  out.mount = options_.mount;
  out.camera_names = views_.cameras;
  out.board_names = views_.boards;
  out.board = board_;
  out.without_row = matched_.without_row;
  out.without_corners = matched_.without_corners;
  const ViewNumbers all = all_numbers(placed_.size());
  const auto groups = static_cast<double>(folds(all).size());
  work_ = work_of_choice(groups) + 1;
  if (options_.left_out)
    work_ += groups * (1 + (groups < static_cast<double>(placed_.size()) ? 0 : work_of_choice(groups - 1)));
  const CameraFreedom free = choose(all, &out.blocks);
  const Fit best = options_.held ? fit_held(all, free) : fit(all, free);
  did(1);
  out.ambiguous = best.ambiguous;
  out.pixel_sigma = best.problem.scatter().pixels;
  report_unknowns(best.problem, out);
  report_images(best.problem, out);
  std::vector<double> of_images;
  for (const ImageError& image : out.images) of_images.push_back(image.board_mean);
  // [m]; more than any arm leaves once it is fitted, or has as designed where only poses of its flange are known
  const double implausible = nominal_ ? 5e-3 : 20e-3;
  if (const double median = median_norm_of(std::move(of_images)); !(median < implausible))
    throw CalibrationFailure(message(views_.file, ": the images do not agree with the poses of the arm: the best fit ",
                                     std::isfinite(median)
                                         ? "is off by " + fixed_digits(median * 1e3, 1) + " mm on the board"
                                         : std::string("has the board out of sight"),
                                     "; wrong rows, another --camera-mount, board or robot?"));
  if (options_.left_out) report_left_out(best.problem, out);
  return out;
}

VERNIER_IMPL CameraReport calibrate_cameras(const std::optional<ArmGeometry>& nominal, const Board& board,
                                            const CornerViews& views, const ImageRows& rows,
                                            const CameraOptions& options) {
  return CameraRun(nominal, board, views, rows, options).run();
}

}  // namespace detail

}  // namespace vernier
