#include "calibration.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <numbers>
#include <span>

#include "calibration_stages.hpp"
#include "dispatch.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/data/split.hpp"
#include "vernier/evaluation/statistics.hpp"
#include "vernier/identification/frames.hpp"
#include "vernier/identification/stations.hpp"
#include "vernier/io/model_file.hpp"

namespace support {

namespace {

using vernier::Index;
using vernier::message;

/// A number for a sentence, three digits that count.
std::string brief(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.3g", value);
  return buffer;
}

/// Root of the mean squared distance from the mean of points [m].
double spread(const vernier::PointRows& points) {
  return std::sqrt((points.rowwise() - points.colwise().mean()).rowwise().squaredNorm().mean());
}

/// Rows of one station to learn from and to judge by.
template <int N>
vernier::Split<N> hold_out(vernier::Dataset<N> data, const CalibrationSettings& settings) {
  using vernier::Face;
  const auto region = [&](Face far, Face near) {
    return vernier::split_region(
        data, {.test_fraction = settings.test_fraction, .face = settings.seed % 2 == 1 ? far : near});
  };
  switch (settings.hold_out) {
    case HoldOut::every: return vernier::split_every(data, settings.test_every);
    case HoldOut::random: return vernier::split(data, {.test_fraction = settings.test_fraction, .seed = settings.seed});
    case HoldOut::region_x: return region(Face::x_high, Face::x_low);
    case HoldOut::region_z: return region(Face::z_high, Face::z_low);
    case HoldOut::time: return vernier::split_time(data, settings.test_fraction);
  }
  return {};
}

/// How that was done, in words.
std::string hold_out_words(const CalibrationSettings& settings) {
  const std::string share = brief(settings.test_fraction * 100) + " % of the rows, ";
  switch (settings.hold_out) {
    case HoldOut::every: return message("every row i with i % ", settings.test_every, " = 0, counted from 0");
    case HoldOut::random: return share + message("at random, seed ", settings.seed);
    case HoldOut::region_x: return share + (settings.seed % 2 == 1 ? "those of the largest x" : "those of the least x");
    case HoldOut::region_z: return share + (settings.seed % 2 == 1 ? "those of the largest z" : "those of the least z");
    case HoldOut::time: return share + "the last ones";
  }
  return {};
}

/// Training and test poses of every station.
template <int N>
struct Stations {
  std::vector<vernier::Dataset<N>> train{}, test{};

  Stations(const vernier::DhChain<N>& chain, const CalibrationSettings& settings, std::string& words) {
    const auto read = [&](const auto& path) {
      const auto data = vernier::read_dataset<N>(path, chain.joint_types());
      return settings.positions_only ? data.without_orientations() : data;
    };
    words = settings.test.empty() ? hold_out_words(settings) : "the rows of ";
    for (std::size_t s = 0; s < settings.data.size(); ++s) {
      vernier::Dataset<N> data = read(settings.data[s]);
      if (settings.test.empty()) {
        if (data.size() < 2)
          throw CalibrationFailure(settings.data[s].string() +
                                   ": a single row; a calibration needs many poses, and some to judge it by");
        vernier::Split<N> split = hold_out(std::move(data), settings);
        train.push_back(std::move(split.train));
        test.push_back(std::move(split.test));
      } else {
        words += (s > 0 ? ", " : "") + settings.test[s].string();
        train.push_back(std::move(data));
        test.push_back(read(settings.test[s]));
      }
      if (settings.train_rows > 0) {
        const vernier::Index n = train.back().size();
        if (settings.train_rows > n)
          throw CalibrationFailure(message(settings.data[s].string(), ": --train asks for ", settings.train_rows,
                                           " rows, there are ", n, " to learn from"));
        const auto order = vernier::Rng(settings.seed).permutation(n);
        train.back() = train.back().rows(
            std::span<const vernier::Index>(order).first(static_cast<std::size_t>(settings.train_rows)));
      }
    }
  }

  static vernier::Index rows(const std::vector<vernier::Dataset<N>>& of) {
    vernier::Index sum = 0;
    for (const auto& data : of) sum += data.size();
    return sum;
  }
  static bool oriented(const std::vector<vernier::Dataset<N>>& of) {
    return std::all_of(of.begin(), of.end(), [](const auto& data) { return data.has_orientations(); });
  }
};

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

/// Likewise for distances, once the frames are known.
template <class Model, int N>
void require_plausible(const Model& registered, const vernier::Distances<N>& data, const std::string& file) {
  const vernier::PointRows points = vernier::positions(registered, data.joints());
  const vernier::Vector3 fixed_point = vernier::trilaterate(points, data.lengths());
  const vernier::VectorX modelled = (points.rowwise() - fixed_point.transpose()).rowwise().norm();
  const double rms = std::sqrt((modelled - data.lengths()).squaredNorm() / static_cast<double>(data.size()));
  if (!(rms <= 0.05))
    throw CalibrationFailure(file + ": from no fixed point do these distances fit the arm, the best one misses by " +
                             brief(rms * 1e3) + " mm (rms): wrong units, columns or rows?");
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
                             "; look for outliers, wrong units or a wrong robot");
}

/// Errors of all stations, one after the other.
template <int N, class F>
vernier::VectorX over_stations(const std::vector<vernier::Dataset<N>>& stations, F&& errors) {
  vernier::VectorX out(Stations<N>::rows(stations));
  Index at = 0;
  for (std::size_t s = 0; s < stations.size(); ++s) {
    out.segment(at, stations[s].size()) = errors(s, stations[s]);
    at += stations[s].size();
  }
  return out;
}

/// Poses of all stations as the first one would have seen them, by what their own models say of each.
template <int N>
vernier::Dataset<N> seen_from_first(const std::vector<vernier::ErrorModel<vernier::DhChain<N>>>& models,
                                    const std::vector<vernier::Dataset<N>>& stations) {
  if (stations.size() == 1) return stations.front();
  const Index rows = Stations<N>::rows(stations);
  vernier::JointRows<N> joints(rows, N);
  vernier::PointRows positions(rows, 3);
  Index at = 0;
  for (std::size_t s = 0; s < stations.size(); ++s) {
    const vernier::Matrix3 turn = models.front().arm().base().linear() * models[s].arm().base().linear().transpose();
    for (Index i = 0; i < stations[s].size(); ++i, ++at) {
      const vernier::JointVector<N> q = stations[s].joints(i);
      joints.row(at) = q.transpose();
      positions.row(at) =
          (models.front().position(q) - turn * (models[s].position(q) - stations[s].position(i))).transpose();
    }
  }
  return {joints, positions};
}

/// Joints, errors and functions for the figures.
template <int N>
std::vector<JointPicture> joint_pictures(const vernier::FittedErrorModel<vernier::DhChain<N>>& fitted,
                                         const std::vector<vernier::Dataset<N>>& test, const vernier::VectorX& before,
                                         const vernier::VectorX& after, const vernier::JointCoverage<N>& coverage) {
  std::vector<JointPicture> out(N);
  for (int j = 0; j < N; ++j) {
    JointPicture& picture = out[static_cast<std::size_t>(j)];
    for (const auto& data : test)
      picture.angle.insert(picture.angle.end(), data.joints().col(j).begin(), data.joints().col(j).end());
    picture.before.assign(before.begin(), before.end());
    picture.after.assign(after.begin(), after.end());
    for (const auto& range : coverage.ranges[static_cast<std::size_t>(j)]) {
      picture.measured_ranges.emplace_back(range.lower, range.upper);
      for (int k = 0; k <= 360; ++k) picture.at.push_back(range.lower + (range.upper - range.lower) * k / 360);
    }
    if (picture.at.empty()) continue;
    const auto f = fitted.transmission(j, picture.at);
    picture.value.assign(f.value.begin(), f.value.end());
    picture.std.assign(f.std.begin(), f.std.end());
  }
  return out;
}

/// Names joints of a pose in degrees (mm for prismatic ones).
template <int N>
std::string pose_words(const vernier::DhChain<N>& chain, const vernier::JointVector<N>& q) {
  std::string out = "(";
  for (int i = 0; i < N; ++i) {
    const bool revolute = chain.row(i).joint == vernier::JointType::revolute;
    const double value = q(i) * (revolute ? 180 / std::numbers::pi : 1e3);
    out += message(i > 0 ? ", " : "", std::llround(value));
  }
  return out + ")";
}

/// Advice on weakly determined parameters: poses within reach that would determine them.
template <int N>
std::vector<std::string> advice(const vernier::NominalArm<N>& arm, const CalibrationReport& report,
                                const vernier::FittedErrorModel<vernier::DhChain<N>>& fitted,
                                const vernier::ErrorModelOptions& options, bool oriented) {
  std::vector<std::string> out;
  if (report.weak.empty()) return out;
  vernier::Rng rng(1);
  std::vector<vernier::JointVector<N>> joints;
  std::vector<vernier::MatrixX> rows;
  const Index dense = fitted.design.dense();
  for (int c = 0; c < 200; ++c) {
    vernier::JointVector<N> q;
    for (int i = 0; i < N; ++i) {
      const double widest = arm.chain.row(i).joint == vernier::JointType::revolute ? std::numbers::pi : 0.5;
      q(i) = rng.uniform(std::max(arm.limits.lower(i), -widest), std::min(arm.limits.upper(i), widest));
    }
    vernier::detail::PoseRows at_q;
    fitted.design.effect(0, q, at_q);
    vernier::MatrixX whitened = at_q.dense.topRows(oriented ? 6 : 3);
    whitened.topRows(3) /= options.position_sigma;
    if (oriented) whitened.bottomRows(3) /= options.orientation_sigma;
    joints.push_back(q);
    rows.push_back(std::move(whitened));
  }
  const auto names = fitted.design.names();
  const vernier::VectorX sizes = fitted.design.sizes();
  for (const std::string& weak : report.weak) {
    const auto at = std::find(names.begin(), names.end(), weak) - names.begin();
    if (at >= dense) continue;
    const auto helpful = vernier::helpful_poses(fitted.covariance.topLeftCorner(dense, dense), rows, at, 3);
    if (helpful.poses.empty()) continue;
    const double now = std::sqrt(fitted.covariance(at, at)) * sizes(at) * 1e3;
    const bool length =
        report.parameters[static_cast<std::size_t>(fitted.design.geometric()[static_cast<std::size_t>(at)].parameter)]
            .kind == vernier::ParameterKind::length;
    if (out.size() == 3) {
      out.push_back(message(report.weak.size() - 3, " more are weakly determined and held near nominal."));
      break;
    }
    std::string line = message(weak, " is weakly determined (to ", brief(now), length ? " mm" : " mrad", ')');
    const double then = std::sqrt(helpful.variances.back()) * sizes(at) * 1e3;
    if (then > 0.9 * now) {
      out.push_back(line + (oriented ? "; no poses would cure that: hold it with --fix, or measure with another tool."
                                     : "; no more positions would cure that: measure orientations, or with the tool "
                                       "point off the last axis, or hold it with --fix."));
      continue;
    }
    line += ": add poses like ";
    for (std::size_t k = 0; k < helpful.poses.size(); ++k)
      line += (k > 0 ? ", " : "") + pose_words(arm.chain, joints[static_cast<std::size_t>(helpful.poses[k])]);
    out.push_back(line + message("; three of them bring it to ", brief(then), "."));
  }
  return out;
}

/// What an engineer should take away.
template <int N>
std::vector<std::string> verdict(const vernier::NominalArm<N>& arm, const CalibrationReport& report,
                                 const vernier::VectorX& gates) {
  std::vector<std::string> out;
  const vernier::VectorX& last = report.stages.back().position;
  std::vector<double> inside;
  for (Index i = 0; i < last.size(); ++i)
    if (gates(i) == 1) inside.push_back(last(i) * 1e3);
  if (!inside.empty()) {
    const auto e = vernier::ErrorStatistics::of(
        Eigen::Map<const vernier::VectorX>(inside.data(), static_cast<Index>(inside.size())));
    out.push_back(message("Good to ", brief(e.mean), " mm mean, ", brief(e.p95), " mm (95 %), ", brief(e.max),
                          " mm at worst, inside the measured joint ranges: ", e.n, " of ", last.size(),
                          " held-out poses. None of them is worse than with geometry alone",
                          report.worst_harm > 0 ? " by more than " + brief(report.worst_harm * 1e3) + " mm." : "."));
  }
  if (report.gated > 0)
    out.push_back(message(report.gated,
                          " held-out poses lie outside those ranges; there all that was learned over the joints fades "
                          "out."));
  std::string ranges;
  for (int j = 0; j < N; ++j) {
    const bool revolute = arm.chain.row(j).joint == vernier::JointType::revolute;
    const double unit = revolute ? 180 / std::numbers::pi : 1e3;
    ranges += message(j > 0 ? "; " : "", 'q', j + 1);
    const auto& own = report.joints[static_cast<std::size_t>(j)].measured_ranges;
    for (std::size_t k = 0; k < own.size() && k < 4; ++k)
      ranges +=
          message(k > 0 ? "," : "", ' ', std::llround(own[k].first * unit), "..", std::llround(own[k].second * unit));
    if (own.size() > 4) ranges += message(", and ", own.size() - 4, " more");
  }
  out.push_back("Measured joint ranges [deg, mm]: " + ranges + ".");
  for (const vernier::BlockChoice& block : report.blocks) {
    const std::string errors =
        message("(poses left out: ", brief(block.without * 1e3), " mm without, ", brief(block.with * 1e3), " mm with)");
    static const std::map<std::string_view, std::pair<const char*, const char*>> words{
        {"elastic", {"Gravity compliance helps ", "Gravity compliance alone does not help "}},
        {"jointwise",
         {"Joint-wise terms help ",
          "Joint-wise terms are left out: this robot's errors are no functions of single joints "}},
        {"elastic_with_jointwise",
         {"Beside joint-wise terms gravity compliance is in ", "Beside joint-wise terms gravity compliance is out "}},
        {"gears", {"Gear ratios and coupling help ", "Gear ratios and coupling do not help "}},
        {"tuned_priors", {"Tuned priors help ", "Tuned priors are left out: they do not help "}}};
    const auto& [helps, does_not] = words.at(block.name);
    out.push_back(message(block.used ? helps : does_not, errors, "."));
  }
  return out;
}

template <int N>
CalibrationReport calibrate_arm(const vernier::RobotDescription& robot, const CalibrationSettings& settings) {
  namespace vn = vernier;
  const vn::NominalArm<N> arm = robot.arm<N>();
  CalibrationReport report;
  const Stations<N> stations(arm.chain, settings, report.split);
  const auto& train = stations.train;
  const auto& test = stations.test;
  report.train_rows = stations.rows(train);
  report.test_rows = stations.rows(test);
  std::vector<vn::Distances<N>> distances;
  for (const auto& file : settings.distances) distances.push_back(vn::read_distances<N>(file, arm.chain.joint_types()));
  for (const auto& data : distances) report.distances += data.size();
  const bool oriented = stations.oriented(train) && stations.oriented(test);

  vn::ErrorModelOptions errors;
  errors.harmonics = settings.harmonics;
  errors.joint_nodes = settings.joint_nodes;
  errors.distance_sigma = settings.distance_sigma;
  errors.loss = settings.loss;
  errors.own_tools = settings.own_tools;
  vn::IdentifyOptions options;
  options.frames = vn::Frames::base_and_tool;
  options.loss = settings.loss;
  options.fixed = settings.fixed;
  options.base_start = arm.base;
  options.geometry = false;
  std::vector<vn::Identified<vn::DhChain<N>>> registered;
  std::vector<vn::Isometry3> bases;
  for (std::size_t s = 0; s < train.size(); ++s) {
    registered.push_back(identify_arm<N>(arm.chain, train[s], options));
    bases.push_back(registered.back().model.actual().base());
    require_plausible(arm, train[s], registered.back().rms_after, settings.data[s].string());
    require_usable(registered.back(), "registering the frames");
  }
  for (std::size_t d = 0; d < distances.size(); ++d)
    require_plausible(registered.front().model, distances[d], settings.distances[d].string());
  const auto judge = [&](const char* key, const char* title, auto&& model) {
    report.stages.push_back(
        {key, title,
         over_stations(test, [&](std::size_t s, const auto& data) { return vn::position_errors(model(s), data); }),
         oriented
             ? over_stations(test, [&](std::size_t s, const auto& data) { return vn::rotation_errors(model(s), data); })
             : vn::VectorX()});
  };
  judge("frames", "frames", [&](std::size_t s) { return registered[s].model; });

  const auto began = std::chrono::steady_clock::now();
  options.geometry = true;
  const auto identified =
      identify_arm<N>(arm.chain, vn::in_one_frame<N>(std::span<const vn::Dataset<N>>(train), bases), options);
  require_usable(identified, "identifying the geometry");
  const vn::ThreadExecutor executor(settings.threads);
  const vn::FitOptions learning{.seed = settings.seed, .executor = executor, .observer = settings.observer};
  const auto search = [&](const vn::PriorObjective& objective, const vn::Box& box) {
    return search_priors(objective, box, settings.priors == PriorTuning::ga, learning);
  };
  const auto fitted = fit_errors<N>(identified, train, distances, errors,
                                    settings.priors == PriorTuning::none ? vn::PriorSearch() : search);
  report.fit_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  if (!fitted.converged) report.remarks.push_back("The fit of the joint errors stopped before its steps died away.");
  judge("geometry", "geometry", [&](std::size_t s) { return fitted.geometry[s]; });

  // the classical learned alternative: an ELM on what the geometry leaves
  const auto learn = [&](const auto& models, const char* key, const char* title, const vn::VectorX& rotation) {
    LearnedError<N> learned = learn_residual<N>(models.front(), seen_from_first<N>(models, train), learning);
    const vn::CartesianCorrected hybrid(models.front(), learned.predictor, learned.gate);
    report.stages.push_back({key, title, vn::position_errors(hybrid, seen_from_first<N>(models, test)), rotation});
    return learned;
  };
  learn(fitted.geometry, "geometry_pso_elm", "geometry + PSO-ELM", report.stages.back().rotation);
  judge("elastic", "elastic", [&](std::size_t s) { return fitted.elastic[s]; });
  judge("jointwise", "joint-wise", [&](std::size_t s) { return fitted.models[s]; });
  const LearnedError<N> learned =
      learn(fitted.models, "jointwise_pso_elm", "joint-wise + PSO-ELM", report.stages.back().rotation);
  const bool learned_something = !learned.predictor.beta().isZero(0);
  if (!learned_something)
    report.remarks.push_back("The PSO-ELM found nothing to learn in what the joint-wise model leaves.");

  report.summary = identified.summary();
  report.parameters = identified.parameters;
  report.rank = identified.rank;
  report.free = static_cast<vn::Index>(identified.free.size());
  report.condition = identified.condition;
  report.weak = identified.names(vn::ParameterState::weak);
  report.correlated = identified.strongly_correlated();
  report.observability = identified.observability;
  report.blocks = fitted.blocks;

  vn::JointRows<N> measured(report.train_rows + report.distances, N);
  Index at = 0;
  const auto append = [&](const auto& data) {
    measured.middleRows(at, data.size()) = data.joints();
    at += data.size();
  };
  for (const auto& data : train) append(data);
  for (const auto& data : distances) append(data);
  const auto coverage = vn::JointCoverage<N>::covering(measured);
  const vn::VectorX gates = over_stations(test, [&](std::size_t, const vn::Dataset<N>& data) {
    vn::VectorX out(data.size());
    for (Index i = 0; i < data.size(); ++i) out(i) = coverage(data.joints(i));
    return out;
  });
  report.gated = (gates.array() < 1).count();
  const vn::VectorX within = over_stations(test, [&](std::size_t s, const vn::Dataset<N>& data) {
    vn::VectorX out(data.size());
    for (Index i = 0; i < data.size(); ++i) {
      const vn::PredictedPose predicted = fitted.predicted(data.joints(i), static_cast<int>(s));
      const vn::Vector3 e = predicted.pose.translation() - data.position(i);
      const vn::Matrix3 covariance = predicted.covariance.template topLeftCorner<3, 3>();
      out(i) = e.dot(covariance.inverse() * e) <= 7.8147 ? 1 : 0;  // 95 % of chi squared with 3 degrees of freedom
    }
    return out;
  });
  report.within_ellipsoids = within.mean();
  const auto stage = [&](std::string_view key) -> const StageErrors& {
    return *std::find_if(report.stages.begin(), report.stages.end(), [&](const auto& s) { return s.key == key; });
  };
  const vn::VectorX &geometry = stage("geometry").position, &jointwise = stage("jointwise").position;
  report.joints = joint_pictures<N>(fitted, test, geometry, jointwise, coverage);
  for (Index i = 0; i < gates.size(); ++i)
    if (gates(i) == 1) report.worst_harm = std::max(report.worst_harm, jointwise(i) - geometry(i));
  report.verdict = verdict(arm, report, gates);
  for (auto& line : advice(arm, report, fitted, errors, oriented)) report.verdict.push_back(std::move(line));

  vn::VectorX left = over_stations(
      train, [&](std::size_t s, const auto& data) { return vn::position_errors(fitted.models[s], data); });
  const vn::ErrorStatistics leftover = vn::ErrorStatistics::of(left);
  if (const auto far = (left.array() > 8 * leftover.median).count(); far > 0 && leftover.median > 1e-6)
    report.remarks.push_back(vn::message(far, " of the training rows miss by more than eight times the median of ",
                                         brief(leftover.median * 1e3), " mm: outliers?",
                                         settings.loss == vn::Loss::squared
                                             ? " --loss huber makes them count less."
                                             : " They count less in the fit; look at them."));

  if (!settings.save.empty()) {
    std::string files;
    for (const auto& file : settings.data) files += (files.empty() ? "" : ",") + file.filename().string();
    vn::CalibratedRobot<N> hybrid(arm.name, fitted.model(), arm.limits,
                                  {files, report.train_rows, settings.date, "commanded",
                                   stations.oriented(train) ? "poses" : "positions", fitted.position_sigma});
    if (learned_something) hybrid = hybrid.with_learned(learned.predictor, learned.gate);
    vn::save_calibrated_robot(settings.save, hybrid);
  }
  return report;
}

}  // namespace

CalibrationReport calibrate(const vernier::RobotDescription& robot, const CalibrationSettings& settings) {
  return dispatch_dof(robot.dof(), [&](auto n) { return calibrate_arm<n()>(robot, settings); });
}

}  // namespace support
