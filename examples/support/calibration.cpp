#include "calibration.hpp"

#include <cmath>

#include "calibration_stages.hpp"
#include "dispatch.hpp"
#include "joint_units.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/data/split.hpp"
#include "vernier/evaluation/statistics.hpp"
#include "vernier/io/model_file.hpp"

namespace support {

namespace {

using vernier::Index;
using vernier::message;

/// A number for a sentence, three digits that count.
inline std::string brief(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.3g", value);
  return buffer;
}

/// Root of the mean squared distance from the mean of points [m].
inline double spread(const vernier::PointRows& points) {
  return std::sqrt((points.rowwise() - points.colwise().mean()).rowwise().squaredNorm().mean());
}

/// Measured poses, their columns checked against the arm.
template <int N>
vernier::Dataset<N> read_poses(const std::filesystem::path& path, const vernier::DhChain<N>& chain,
                               bool positions_only) {
  vernier::Dataset<N> data = vernier::read_dataset<N>(path);
  require_joint_units(path, chain);
  if (positions_only) data = vernier::Dataset<N>(data.joints(), data.positions());
  return data;
}

/// Rows to learn from and to judge by, and how they were chosen.
template <int N>
vernier::Split<N> hold_out(const vernier::DhChain<N>& chain, const CalibrationSettings& settings, std::string& words) {
  vernier::Dataset<N> data = read_poses(settings.data, chain, settings.positions_only);
  if (!settings.test.empty()) {
    words = "all rows of " + settings.test.string();
    return {std::move(data), read_poses(settings.test, chain, settings.positions_only)};
  }
  if (data.size() < 2)
    throw CalibrationFailure(settings.data.string() +
                             ": a single row; a calibration needs many poses, and some to judge it by");
  if (settings.test_fraction) {
    words = message(*settings.test_fraction * 100, " % of the rows, at random, seed ", settings.seed);
    return vernier::split(data, {.test_fraction = *settings.test_fraction, .seed = settings.seed});
  }
  words = message("every row i with i % ", settings.test_every, " = 0, counted from 0");
  return vernier::split_every(data, settings.test_every);
}

/// Stops where registering base and tool leaves errors that no real arm has: the data are of another arm, or in other
/// units.
template <int N>
void require_plausible(const vernier::NominalArm<N>& arm, const vernier::Dataset<N>& train, double frames_rms,
                       const std::string& file) {
  const vernier::PointRows nominal = vernier::positions(arm.chain, train.joints());
  const double expected = spread(nominal), measured = spread(train.positions());
  const double limit = std::min(0.05, 0.1 * std::max(expected, measured));
  if (frames_rms <= std::max(limit, 1e-3)) return;  // an arm that stood still is another matter
  std::string hint = "wrong robot, units or columns?";
  const double ratio = measured / expected;
  double largest = 0;
  for (int i = 0; i < N; ++i)
    if (arm.chain.row(i).joint == vernier::JointType::revolute)
      largest = std::max(largest, train.joints().col(i).cwiseAbs().maxCoeff());
  if (largest > 15)
    hint = "a joint of " + brief(largest) + " rad looks like degrees in a _rad column";
  else if (largest < 0.15)
    hint = "no joint passes " + brief(largest) + " rad: radians in a _deg column?";
  else if (ratio > 300)
    hint = "the measured positions spread " + brief(ratio) + " times as wide as the arm's: x, y, z in mm called _m?";
  else if (ratio < 1.0 / 300)
    hint = "the arm's positions spread " + brief(1 / ratio) +
           " times as wide as the measured ones: x, y, z in m called _mm?";
  throw CalibrationFailure(file + ": after registering the frames the model of " + arm.name + " misses by " +
                           brief(frames_rms * 1e3) + " mm (rms): " + hint);
}

/// Stops where an identification must not be used.
template <class Identified>
void require_usable(const Identified& identified, const std::string& stage) {
  using vernier::IdentifyStatus;
  if (identified.status == IdentifyStatus::underdetermined)
    throw CalibrationFailure(stage + " is underdetermined: " + identified.message +
                             "; measure more poses, with every joint moved widely, or hold parameters with --fix");
  if (identified.status == IdentifyStatus::not_converged)
    throw CalibrationFailure(stage + " did not converge: " + identified.message +
                             "; look for outliers (--loss huber), wrong units or a wrong robot");
}

template <int N>
CalibrationReport calibrate_arm(const vernier::RobotDescription& robot, const CalibrationSettings& settings) {
  namespace vn = vernier;
  const vn::NominalArm<N> arm = robot.arm<N>();
  CalibrationReport report;
  const vn::Split<N> split = hold_out(arm.chain, settings, report.split);
  const vn::Dataset<N>&train = split.train, &test = split.test;
  report.train_rows = train.size();
  report.test_rows = test.size();

  const bool oriented = train.has_orientations() && test.has_orientations();
  const auto judge = [&](const char* key, const char* title, const auto& model) {
    report.stages.push_back(
        {key, title, vn::position_errors(model, test), oriented ? vn::rotation_errors(model, test) : vn::VectorX()});
  };

  vn::IdentifyOptions options;
  options.frames = vn::Frames::base_and_tool;
  options.loss = settings.loss;
  options.fixed = settings.fixed;
  options.base_start = arm.base;
  options.geometry = false;
  const auto registered = identify_arm<N>(arm.chain, train, options);
  require_plausible(arm, train, registered.rms_after, settings.data.string());
  require_usable(registered, "registering the frames");
  judge("frames", "frames", registered.model);

  options.geometry = true;
  const auto identified = identify_arm<N>(arm.chain, train, options);
  require_usable(identified, "identifying the geometry");
  judge("geometry", "geometry", identified.model);

  const vn::ThreadExecutor executor(settings.threads);
  const LearnedError<N> learned = learn_residual<N>(
      identified.model, train, {.seed = settings.seed, .executor = executor, .observer = settings.observer});
  const bool learned_something = !learned.predictor.beta().isZero(0);
  vn::CalibratedRobot<N> hybrid(arm.name, arm.chain, identified.model.actual(), arm.limits,
                                {settings.data.filename().string(), train.size(), settings.date});
  if (learned_something) hybrid = hybrid.with_learned(learned.predictor, learned.gate);
  judge("geometry_pso_elm", "geometry + PSO-ELM", hybrid);

  report.summary = identified.summary();
  report.parameters = identified.parameters;
  report.rank = identified.rank;
  report.free = static_cast<vn::Index>(identified.free.size());
  report.condition = identified.condition;
  report.weak = identified.names(vn::ParameterState::weak);
  if (!learned_something) report.remarks.push_back("The PSO-ELM found nothing to learn in what the geometry leaves.");
  const vn::VectorX left = vn::position_errors(identified.model, train);
  const vn::ErrorStatistics leftover = vn::ErrorStatistics::of(left);
  if (const auto far = (left.array() > 8 * leftover.median).count();
      far > 0 && leftover.median > 1e-6 && settings.loss == vn::Loss::squared)
    report.remarks.push_back(vn::message(far, " of the training rows miss by more than eight times the median of ",
                                         brief(leftover.median * 1e3),
                                         " mm: outliers? --loss huber makes them count less."));

  if (!settings.save.empty()) vn::save_calibrated_robot(settings.save, hybrid);
  return report;
}

}  // namespace

CalibrationReport calibrate(const vernier::RobotDescription& robot, const CalibrationSettings& settings) {
  return dispatch_dof(robot.dof(), [&](auto n) { return calibrate_arm<n()>(robot, settings); });
}

}  // namespace support
