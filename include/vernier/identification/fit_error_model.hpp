#pragma once

/// @file
/// Fits geometry, frames and joint errors together, to poses measured from one place or several.

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "vernier/identification/error_model.hpp"
#include "vernier/identification/error_model_problem.hpp"
#include "vernier/identification/frames.hpp"
#include "vernier/identification/identified.hpp"

namespace vernier {

/// Options of `fit_error_model`: which joint errors there may be, how large they are expected, how good the sensor is.
/// The defaults serve every robot; how far the data support a block is decided by leave-one-pose-out on those data.
struct ErrorModelOptions {
  bool compliance = true;             ///< joints give way under gravity
  bool gear_ratio = false;            ///< joint errors proportional to the joint
  bool coupling = false;              ///< joint errors proportional to the joint before
  int harmonics = 60;                 ///< of the Fourier terms of each joint; 0: none
  int joint_nodes = 0;                ///< hidden nodes that read one joint, in place of Fourier terms; 0: none
  bool own_tools = false;             ///< every station has a tool of its own, not just a base
  bool use_orientations = true;       ///< measured orientations count too, where there are any
  Vector3 down{0, 0, -1};             ///< direction of gravity in the arm's base frame
  double position_sigma = 0.03e-3;    ///< of the sensor, per component [m]
  double orientation_sigma = 0.1e-3;  ///< of the sensor, per component [rad]
  double joint_sigma = 0;             ///< of the joint readings [rad, m]; above 0: errors in variables
  double compliance_size = 1e-3;      ///< expected product of compliance and weight [rad/m]
  double gear_ratio_size = 1e-4;      ///< expected relative error of a gear ratio
  double coupling_size = 1e-4;        ///< expected coupling
  double transmission_size = 0.3e-3;  ///< expected amplitude of a first harmonic [rad]; harmonic k: a k-th of it
  Loss loss = Loss::huber;            ///< how residuals are weighed; huber survives a few wrong poses
  Index left_out = 200;               ///< about so many poses are left out, one at a time, to judge a block

  /// @throws std::invalid_argument naming the value
  void validate() const {
    for (const auto& [name, value] : {std::pair{"position_sigma", position_sigma},
                                      {"orientation_sigma", orientation_sigma},
                                      {"compliance_size", compliance_size},
                                      {"gear_ratio_size", gear_ratio_size},
                                      {"coupling_size", coupling_size},
                                      {"transmission_size", transmission_size}})
      require(value > 0 && std::isfinite(value), "ErrorModelOptions: ", name, " is ", value, ", must be positive");
    require(joint_sigma >= 0 && std::isfinite(joint_sigma), "ErrorModelOptions: joint_sigma is ", joint_sigma,
            ", must not be negative");
    require(harmonics >= 0 && harmonics <= 500, "ErrorModelOptions: harmonics is ", harmonics, ", must lie in 0..500");
    require(joint_nodes >= 0 && joint_nodes <= 1000, "ErrorModelOptions: joint_nodes is ", joint_nodes,
            ", must lie in 0..1000");
    require(harmonics == 0 || joint_nodes == 0 || harmonics == 60,
            "ErrorModelOptions: either harmonics or joint_nodes");
    require(left_out >= 1, "ErrorModelOptions: left_out is ", left_out, ", must be at least 1");
    require(std::abs(down.norm() - 1) < 1e-6, "ErrorModelOptions: down has length ", down.norm(), ", must be 1");
  }
};

/// What leave-one-pose-out said of a block of joint errors.
struct BlockChoice {
  std::string name;      ///< `elastic` (gravity, gears, coupling) or `jointwise` (transmission)
  double without = 0;    ///< mean position error of poses left out, without the block [m]
  double with = 0;       ///< with it, as it was fitted [m]; what it would have been where it was not used
  bool used = false;     ///< whether it is in the model
  double tightness = 1;  ///< of its prior: 1 for the expected sizes, t for sizes divided by sqrt(t)
};

/// A predicted pose, and how well it is known.
struct PredictedPose {
  Isometry3 pose;                          ///< base_T_tool
  Eigen::Matrix<double, 6, 6> covariance;  ///< of one visit: position [m^2], then orientation [rad^2], base frame
  double gate = 1;                         ///< share of the joint-wise terms in it
};

/// An error model with all that is known of it.
template <class Chain>
struct FittedErrorModel {
  /// Number of joints.
  static constexpr int N = Chain::dof;

  std::vector<ErrorModel<Chain>> models{};    ///< one a station; they differ in their frames
  std::vector<ErrorModel<Chain>> elastic{};   ///< the same before transmission terms
  std::vector<ErrorModel<Chain>> geometry{};  ///< the same before all joint errors
  bool converged = false;                     ///< whether every solve ended where steps died away
  std::vector<BlockChoice> blocks{};          ///< what was decided, in order
  double position_sigma = 0;                  ///< of a visit, per component: sensor, and what the model lacks [m]
  double joint_sigma = 0;                     ///< of a visit, joints that do not repeat [rad]
  double orientation_sigma = 0;               ///< of a visit, per component [rad]; 0 for positions alone
  detail::ErrorModelDesign<Chain> design;     ///< unknowns and where they ended
  MatrixX covariance{};                       ///< of all unknowns, in units of their sizes

  /// The model of the first, or only, station.
  const ErrorModel<Chain>& model() const { return models.front(); }

  /// What a transmission adds over some angles beyond its mean, which is the joint's zero; one value an angle [rad].
  struct JointFunction {
    VectorX value;  ///< mean taken off
    VectorX std;    ///< standard deviations of that
  };
  /// See `JointFunction`.
  /// @param joint  from 0
  /// @param angles n >= 1 values [rad]
  JointFunction transmission(int joint, const std::vector<double>& angles) const {
    require(!angles.empty(), "transmission: no angles");
    const auto& terms = models.front().arm().model().joint_errors().terms();
    const Index n = static_cast<Index>(angles.size());
    const Index count = size_of(terms.transmission[static_cast<std::size_t>(joint)]);
    if (count == 0) return {VectorX::Zero(n), VectorX::Zero(n)};
    const Index first = terms.transmission_begin(joint) - terms.few();
    MatrixX rows(n, count);
    VectorX all;
    for (Index k = 0; k < n; ++k) {
      design.functions(JointVector<N>::Constant(angles[static_cast<std::size_t>(k)]), all);
      rows.row(k) = all.segment(first, count).transpose();
    }
    rows.rowwise() -= rows.colwise().mean().eval();
    const Index at = design.dense() + first;
    return {rows * design.steps().segment(at, count),
            (rows * covariance.block(at, at, count, count)).cwiseProduct(rows).rowwise().sum().cwiseMax(0).cwiseSqrt()};
  }

  /// Where the arm will be at q, with the covariance of parameters, joint-wise coefficients and repeatability.
  /// @complexity O(unknowns^2); allocates
  PredictedPose predicted(const JointVector<N>& q, int station = 0) const {
    const auto& model = models[static_cast<std::size_t>(station)];
    detail::PoseRows at;
    const detail::Rows6 rows = design.rows(station, q, at);
    PredictedPose out{model.pose(q), rows * covariance * rows.transpose(), model.gate(q)};
    out.covariance += joint_sigma * joint_sigma * at.joint * at.joint.transpose();
    if (out.gate < 1)  // errors that the terms held back would have taken off
      out.covariance.diagonal().template head<3>().array() +=
          std::pow((1 - out.gate) * blocks.back().without / 1.6, 2);  // a mean norm is 1.6 sigma of a component
    out.covariance.diagonal().template head<3>().array() += position_sigma * position_sigma;
    out.covariance.diagonal().template tail<3>().array() += orientation_sigma * orientation_sigma;
    return out;
  }
};

namespace detail {

/// The steps of `fit_error_model`, in the order in which they are taken.
template <class Chain>
class ErrorModelFit {
 public:
  static constexpr int N = Chain::dof;

  ErrorModelFit(const Identified<Chain>& start, std::span<const Dataset<N>> stations, const ErrorModelOptions& options)
      : nominal_(start.model.reference().model()),
        options_(options),
        stations_(stations),
        problem_(ErrorModelDesign<Chain>(arms(start, stations), unknowns(start, stations.size(), options)),
                 sensors(stations, options), options.loss),
        stride_(std::max<Index>(1, problem_.poses() / options.left_out)) {}

  FittedErrorModel<Chain> run() {
    FittedErrorModel<Chain> out{.design = problem_.design};
    out.converged = problem_.solve();
    for (int s = 0; s < problem_.design.stations(); ++s) out.geometry.push_back({nominal_, problem_.design.arm(s)});

    JointTerms<Chain> few;
    few.gear_ratio = options_.gear_ratio;
    few.coupling = options_.coupling;
    if (options_.compliance) few.gravity.emplace(nominal_, options_.down);
    if (few.size() > 0) add(out, "elastic", few);
    for (int s = 0; s < problem_.design.stations(); ++s) out.elastic.push_back({nominal_, problem_.design.arm(s)});

    JointTerms<Chain> all = few;
    const auto coverage = JointCoverage<N>::covering(all_joints());
    for (int j = 0; j < N; ++j) all.transmission[static_cast<std::size_t>(j)] = basis(j);
    const bool jointwise = all.size() > few.size() && add(out, "jointwise", all);
    if (jointwise && few.size() > 0) {  // sag shows better once the rest is clean
      const BlockChoice again = choose("elastic", 0, few.size());
      out.converged = problem_.solve() && out.converged;
      out.blocks.back().with = again.with;
    }
    for (int s = 0; s < problem_.design.stations(); ++s) {
      if (jointwise)
        out.models.push_back(
            {nominal_, problem_.design.arm(s), out.elastic[static_cast<std::size_t>(s)].arm(), coverage});
      else
        out.models.push_back(out.elastic[static_cast<std::size_t>(s)]);
    }
    out.design = problem_.design;
    assess(out);
    return out;
  }

 private:
  /// The identified arm in every station's own base.
  static std::vector<Framed<Chain>> arms(const Identified<Chain>& start, std::span<const Dataset<N>> stations) {
    const Framed<Chain>& first = start.model.actual();
    std::vector<Framed<Chain>> out;
    for (const Dataset<N>& data : stations) {
      require(data.size() >= 1, "fit_error_model: a station without poses");
      if (stations.size() == 1) {
        out.push_back(first);
        break;
      }
      const Framed<Chain> unregistered(first.model(), {}, first.tool());
      out.emplace_back(first.model(), register_points(positions(unregistered, data.joints()), data.positions()),
                       first.tool());
    }
    return out;
  }

  static std::vector<GeometricUnknown> unknowns(const Identified<Chain>& start, std::size_t stations,
                                                const ErrorModelOptions& options) {
    std::vector<GeometricUnknown> out;
    const auto own = [&](Index k) {
      return k < 6 || (options.own_tools && k >= 6 + Chain::num_parameters);  // a base, or a tool
    };
    for (const Index k : start.free) {
      const ParameterEstimate& p = start.parameters[static_cast<std::size_t>(k)];
      const bool of_chain = k >= 6 && k < 6 + Chain::num_parameters;
      // thirty expected sizes bind nothing that is determined
      const double deviation = std::isfinite(p.prior) ? p.prior / p.size : 30;
      const double precision = of_chain ? 1 / (deviation * deviation) : 0;
      const std::size_t copies = own(k) ? stations : 1;
      for (std::size_t s = 0; s < copies; ++s)
        out.push_back({k, copies > 1 ? static_cast<int>(s) : -1, p.size, precision});
    }
    return out;
  }

  static std::vector<Station<N>> sensors(std::span<const Dataset<N>> stations, const ErrorModelOptions& options) {
    std::vector<Station<N>> out;
    for (const Dataset<N>& data : stations)
      out.push_back({&data, options.use_orientations && data.has_orientations(), options.position_sigma,
                     options.orientation_sigma, options.joint_sigma});
    return out;
  }

  JointRows<N> all_joints() const {
    JointRows<N> out(problem_.poses(), N);
    for (Index b = 0; b < out.rows(); ++b) out.row(b) = problem_.joints(b).transpose();
    return out;
  }

  AngleBasis basis(int joint) const {
    if (nominal_.row(joint).joint != JointType::revolute) return Fourier{0};
    if (options_.joint_nodes == 0) return Fourier{options_.harmonics};
    const auto column = all_joints().col(joint).eval();
    const double lower = column.minCoeff(), upper = column.maxCoeff();
    return upper - lower > 1e-6 ? AngleBasis(JointNodes::spread(options_.joint_nodes, lower, upper))
                                : AngleBasis(Fourier{0});
  }

  /// Expected sizes of the coefficients of some terms.
  VectorX sizes(const JointTerms<Chain>& terms) const {
    VectorX out(terms.size());
    Index at = 0;
    const auto fill = [&](Index count, double size) {
      out.segment(at, count).setConstant(size);
      at += count;
    };
    if (terms.gear_ratio) fill(N, options_.gear_ratio_size);
    if (terms.coupling) fill(N - 1, options_.coupling_size);
    if (terms.gravity) fill(GravityCompliance<Chain>::size, options_.compliance_size);
    for (const AngleBasis& basis : terms.transmission)
      std::visit(
          [&](const auto& b) {
            for (Index k = 0; k < b.size(); ++k) out(at++) = options_.transmission_size * b.relative_size(k);
          },
          basis);
    return out;
  }

  /// Puts terms in if leave-one-pose-out supports those beyond the present ones.
  bool add(FittedErrorModel<Chain>& out, const char* name, const JointTerms<Chain>& terms) {
    const auto before = problem_.design;
    const Index old = before.terms().size();
    VectorX precisions = VectorX::Ones(terms.size());
    precisions.head(old) = before.precisions().tail(old);
    problem_.design.set_terms(terms, sizes(terms), precisions);
    out.blocks.push_back(choose(name, old, terms.size() - old));
    if (!out.blocks.back().used) {
      problem_.design = before;
      return false;
    }
    out.converged = problem_.solve() && out.converged;
    return true;
  }

  /// Settles the prior of some coefficients by leave-one-pose-out.
  BlockChoice choose(const char* name, Index first, Index count) {
    VectorX precisions = problem_.design.precisions();
    const Index at = static_cast<Index>(problem_.design.geometric().size()) + first;
    const PriorChoice choice = problem_.with_system([&](const PoseSystem& system) {
      return choose_prior(system, PoseNormalEquations(system), precisions, problem_.design.steps(), at, count, stride_);
    });
    precisions.segment(at, count).setConstant(choice.tightness);
    problem_.design.set_precisions(precisions.tail(problem_.design.terms().size()));
    const bool used = choice.tightness < nothing_left;
    return {name, choice.without, used ? choice.with : choice.best, used, choice.tightness};
  }

  /// Covariance of the unknowns, and what no unknown explains.
  void assess(FittedErrorModel<Chain>& out) const {
    problem_.with_system([&](const PoseSystem& system) {
      const PoseNormalEquations normal(system);
      const VectorX precisions = problem_.design.precisions();
      const FactorisedSystem solved(normal, precisions, problem_.design.steps());
      const Index p = system.unknowns();
      out.covariance = solved.factor.solve(MatrixX::Identity(p, p));
      const double explained = static_cast<double>(p) - out.covariance.diagonal().dot(precisions);
      const double values = static_cast<double>(problem_.measured_values());
      const double freedom = std::max(1.0, values - explained);
      out.covariance *= normal.cost / freedom;

      // left-out errors hold the noise of a visit and the uncertainty of the unknowns
      PoseRows rows;
      Rows6 all(6, p);
      double turned = 0, turned_values = 0;
      std::vector<LeftOutVisit> visits;
      const Eigen::Matrix3Xd left = left_out_errors(system, solved, stride_);
      for (Index b = 0; b < system.poses; ++b) {
        system.rows(b, rows);
        const Station<N>& station = problem_.station_of(b);
        if (station.oriented) {
          turned += (rows.root * rows.residual).tail<3>().squaredNorm() * station.orientation_sigma *
                    station.orientation_sigma;
          turned_values += 3;
        }
        if (b % stride_ != 0) continue;
        rows.expand(system.functions_of, all);
        const MatrixX position = rows.unit * (rows.root * all).topRows<3>();
        const MatrixX joint = rows.unit * (rows.root * rows.joint).topRows<3>();
        visits.push_back(
            {left.col(b / stride_), position * out.covariance * position.transpose(), joint * joint.transpose()});
      }
      if (turned_values > 0) out.orientation_sigma = std::sqrt(turned / turned_values * values / freedom);
      const VisitNoise noise = visit_noise(visits);
      out.position_sigma = noise.position;
      out.joint_sigma = noise.joint;
      out.covariance *= noise.model;
    });
  }

  Chain nominal_;
  ErrorModelOptions options_;
  std::span<const Dataset<N>> stations_;
  ErrorModelProblem<Chain> problem_;
  Index stride_;
};

}  // namespace detail

/// Geometry, frames and joint errors of an arm in one regularised least-squares problem, solved by Gauss-Newton on its
/// normal equations. Blocks that leave-one-pose-out does not support are left out.
/// @param start    an identified arm; its free parameters move again, its weak ones keep their priors
/// @param stations measured poses, one set a place of the sensor: the chain is shared, every base its own
/// @param options  which joint errors there may be, how large they are expected
/// @throws std::invalid_argument on an unusable option or no poses
/// @complexity O(n u^2 / 6) an iteration for n poses and u unknowns, memory O(u^2)
template <class Chain>
FittedErrorModel<Chain> fit_error_model(const Identified<Chain>& start, std::span<const Dataset<Chain::dof>> stations,
                                        const ErrorModelOptions& options = {}) {
  options.validate();
  require(!stations.empty(), "fit_error_model: no stations");
  return detail::ErrorModelFit<Chain>(start, stations, options).run();
}

/// The same from one station.
template <class Chain>
FittedErrorModel<Chain> fit_error_model(const Identified<Chain>& start, const Dataset<Chain::dof>& data,
                                        const ErrorModelOptions& options = {}) {
  return fit_error_model(start, std::span<const Dataset<Chain::dof>>(&data, 1), options);
}

}  // namespace vernier
