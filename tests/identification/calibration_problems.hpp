// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Problems of identification: an arm with every kind of joint error, seen from two places, or from one beside a wire.

#include <cmath>
#include <utility>
#include <vector>

#include "random_blocks.hpp"
#include "real_matrix.hpp"
#include "set_of.hpp"
#include "vernier/identification/detail/calibration_problem.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier_test::calibration_problems {

using namespace vernier;
using Chain = DhChain<6>;
using Problem = vernier::detail::CalibrationProblem;

/// An arm with every kind of joint error, measured from two places of which only the first sees orientations.
struct Measured {
  Robot<6> robot = robots::abb_irb120();
  Dataset<6> first, second;

  explicit Measured(Index poses) {
    const Chain actual = with_geometric_errors(robot.chain, {}, 12);
    // orientations are far off: so is the derivative of the logarithm from the identity
    first = measure(Framed<Chain>(actual, start_base(0), tool), sample_joints(robot.limits, poses, 13),
                    {.position = 1e-3, .orientation = 0.3}, 14);
    second = measure(Framed<Chain>(actual, start_base(1), tool), sample_joints(robot.limits, poses / 2, 15),
                     {.position = 1e-3, .with_orientations = false}, 16);
  }

  FrameParameters tool{Vector6{0.02, -0.1, 0.15, 0.3, -0.2, 0.5}};
  static FrameParameters start_base(int station) {
    return FrameParameters(station == 0 ? Vector6{0.5, -1, 0.2, 0.3, -0.8, 1.5} : Vector6{-2, 0.3, 1, -1.1, 0.2, 0.7});
  }

  /// Chain, tool and both bases free, and every joint error; away from where it started.
  /// @param size of the units
  Problem problem(double joint_sigma, double size) const {
    std::vector<GeometricUnknown> unknowns;
    for (int k = 0; k < 6; ++k)
      for (const int station : {0, 1}) unknowns.push_back({k, station, size, 0.5});
    for (Index k = 6; k < Framed<Chain>::num_parameters; ++k)
      unknowns.push_back({k, -1, size * (1 + 0.1 * static_cast<double>(k)), 2});
    ArmParameterisation arm({ArmGeometry(Framed<Chain>(robot.chain, start_base(0), tool)),
                             ArmGeometry(Framed<Chain>(robot.chain, start_base(1), tool))},
                            unknowns);
    JointTerms terms(6);
    terms.gear_ratio = terms.coupling = true;
    terms.gravity.emplace(robot.chain, Vector3(0.6, 0, -0.8));
    terms.transmission = {Fourier::up_to(3), Fourier::up_to(2), Fourier{},
                          Fourier::up_to(1), Fourier::up_to(2), Fourier::up_to(12)};
    Rng rng(17);
    VectorX sizes = random_vector(rng, terms.size());
    for (double& x : sizes) x = size * (1 + std::abs(x));
    arm.set_terms(terms, sizes, VectorX::Constant(terms.size(), 3));
    arm.move(random_vector(rng, arm.size(), 1e-3 / size));
    const SensorModel of_first{.position_sigma = 0.03e-3, .orientation_sigma = 0.1e-3};
    const SensorModel of_second{.position_sigma = 0.05e-3};
    return {std::move(arm),
            {vernier_test::set_of(first, of_first), vernier_test::set_of(second, of_second)},
            Loss::squared,
            joint_sigma};
  }
};

/// One unknown moved.
inline VectorX step_of(Index k, Index size, double step) {
  VectorX out = VectorX::Zero(size);
  out(k) = step;
  return out;
}

/// Three elements of a column.
inline Vector3 three(const Vector6& column, Index first) {
  return {column(first), column(first + 1), column(first + 2)};
}

inline RealMatrix expanded(const Problem& problem, Index block, RowBlock& rows) {
  problem(block, 1, &rows);
  Rows6 out(6, problem.arm.size());
  rows.expand(problem.arm.group_sizes(), out);
  return out;
}

inline RealMatrix residual_of(const Problem& problem, Index block) {
  RowBlock rows;
  problem(block, 1, &rows);
  return rows.residual;
}

/// Poses from one place and distances from another fixed point; the base of each is free.
struct WithWire {
  Measured measured;
  Distances<6> wire;

  explicit WithWire(Index poses)
      : measured(poses),
        wire(measure_distances(Framed<Chain>(measured.robot.chain, Measured::start_base(1), measured.tool),
                               Vector3::Zero(), sample_joints(measured.robot.limits, 21, 31), 2e-3, 32)) {}

  Problem problem(Loss loss, bool poses_too = true) const {
    const ArmGeometry here(Framed<Chain>(measured.robot.chain, Measured::start_base(0), measured.tool)),
        there(Framed<Chain>(measured.robot.chain, Measured::start_base(1), measured.tool));
    const MeasuredSet lengths = vernier_test::set_of(wire, {.distance_sigma = 0.5e-3});
    if (!poses_too) return {ArmParameterisation({there}, {{0, 0, 1e-3, 0}}), {lengths}, loss};
    return {ArmParameterisation({here, there}, {{0, 0, 1e-3, 0}, {0, 1, 1e-3, 0}}),
            {vernier_test::set_of(measured.first, {}), lengths},
            loss};
  }
};

}  // namespace vernier_test::calibration_problems
