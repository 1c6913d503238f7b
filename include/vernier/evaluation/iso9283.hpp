// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Accuracy and repeatability of poses and distances from repeated visits, as ISO 9283 defines them.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vernier/core/types.hpp"
#include "vernier/evaluation/iso9283_visit.hpp"

namespace vernier {

/// Settings of `iso9283`.
struct Iso9283Options {
  bool orientations = true;  ///< whether orientations were measured; else all angles are NaN
  int draws = 2000;          ///< of the bootstrap behind the intervals of RP; 0: no intervals
  std::uint64_t seed = 1;    ///< of the bootstrap
  int drift_visits = 10;     ///< visits of a pose in one group of the drift, at least 2
};

/// Accuracy (AP) and repeatability (RP) of a pose [m]. Angles a, b, c are the components of small rotation vectors
/// in the frame of the commanded poses [rad]: of the mean orientation with respect to the commanded one (AP), and of
/// each visit's with respect to the mean (RP). What needs two visits (RP) or more is NaN without them.
struct Iso9283Pose {
  int pose = 1;                            ///< its number
  int direction = 0;                       ///< of approach, as in `Iso9283Visit`
  Index n = 0;                             ///< number of visits
  Isometry3 mean = Isometry3::Identity();  ///< barycentre of the positions, Karcher mean of the orientations
  double ap = 0;                           ///< distance of the barycentre from the command
  /// `sqrt(AP^2 - (s_x^2 + s_y^2 + s_z^2) / n)`, 0 where that is negative: AP without what scatter adds to it, so that
  /// of n = 30 visits of a perfect arm it does not read 0.29 s.
  double ap_debiased = 0;
  /// AP after the commanded positions of all poses were registered to the barycentres; NaN without three poses that
  /// are not on one line. Of five poses it is smaller than the arm's error: six of fifteen coordinates are fitted.
  double ap_registered = 0;
  Vector3 ap_xyz = Vector3::Zero();  ///< barycentre minus command
  Vector3 ap_abc = Vector3::Zero();  ///< likewise, angles
  double rp = 0;                     ///< mean distance from the barycentre plus three of its standard deviations
  double rp_low = 0;                 ///< lower end of the 95 % interval of RP by the bootstrap-t; NaN for fewer than
                                     ///< three visits
  double rp_high = 0;                ///< upper end, likewise
  Vector3 rp_xyz = Vector3::Zero();  ///< three standard deviations
  Vector3 rp_abc = Vector3::Zero();  ///< likewise, angles
};

/// Accuracy (AD) and repeatability (RD) of the distance between two poses of a cycle, P2 and P4 [m, rad]. Per axis and
/// angle they are those of absolute differences.
struct Iso9283Distance {
  int first = 2;                     ///< number of the one pose
  int second = 4;                    ///< number of the other
  Index n = 0;                       ///< number of cycles that have both
  double ad = 0;                     ///< mean measured minus commanded distance
  double rd = 0;                     ///< three standard deviations; NaN for one cycle
  Vector3 ad_xyz = Vector3::Zero();  ///< AD of each axis
  Vector3 ad_abc = Vector3::Zero();  ///< AD of each angle
  Vector3 rd_xyz = Vector3::Zero();  ///< RD of each axis
  Vector3 rd_abc = Vector3::Zero();  ///< RD of each angle
};

/// Multi-directional pose accuracy variation: the largest difference between the means of two directions of approach.
struct Iso9283Variation {
  int pose = 1;                       ///< its number
  int directions = 0;                 ///< number of directions
  double vap = 0;                     ///< between barycentres [m]
  Vector3 vap_abc = Vector3::Zero();  ///< between mean orientations, each angle [rad]
};

/// Accuracy and repeatability of a pose over time.
struct Iso9283Drift {
  /// Some visits in sequence.
  struct Group {
    double time_s = 0;  ///< mean time of measuring; NaN where unknown
    double ap = 0;      ///< as in `Iso9283Pose`
    double rp = 0;      ///< likewise
  };
  int pose = 1;                 ///< its number
  std::vector<Group> groups{};  ///< at least two
  double dap = 0;               ///< largest change of AP since the first group [m]
  double drp = 0;               ///< that of RP [m]
};

/// Result of `iso9283`.
struct Iso9283 {
  std::vector<Iso9283Pose> poses{};            ///< in ascending order
  std::optional<Iso9283Distance> distance{};   ///< between P2 and P4, where a cycle has both
  std::vector<Iso9283Variation> variations{};  ///< of the poses visited from several directions
  std::vector<Iso9283Drift> drift{};           ///< of the poses with two groups of visits
  /// What takes the commanded positions nearest to the barycentres; empty where `ap_registered` is NaN.
  std::optional<Isometry3> registration{};
  /// Each way in which the data are not those of the norm, in words; empty where they are.
  std::vector<std::string> departures{};
};

/// Evaluates repeated visits as ISO 9283 does: AP, RP, AD, RD, vAP, dAP, dRP, and how the data depart from the norm.
///
/// What data do not tell is not checked: load, speed, warm-up, the place of the cube.
///
/// AP compares with the command: unless the frame of the measurements is the robot's base, it contains the error of the
/// registration, see `ap_registered`. One visit of a pose gives its error, which is no AP. AP, RP, AD, RD and the drift
/// are those of one direction of approach: of direction 0, or else of the lowest number.
///
/// RP of n = 30 visits is uncertain by a fifth. Its interval is for the RP of infinitely many visits, each of
/// the same distribution, independent of the others; of normally distributed visits it contains that in 92 % of tests
/// of 30 cycles, 89 % of 10 (the percentiles of a bootstrap: 81 %, 63 %).
/// @param visits    in any order
/// @param commanded pose k is entry k - 1
/// @param options   see there
/// @throws std::invalid_argument without visits; for a visit of no commanded pose, two visits of the same pose, cycle
///         and direction, a pose that is not finite or no rotation, options out of range
/// @complexity O(draws n)
/// @cite ISO 9283; Efron and Tibshirani 1993; Moakher 2002; Umeyama 1991
VERNIER_API Iso9283 iso9283(std::span<const Iso9283Visit> visits, std::span<const Isometry3> commanded,
                            const Iso9283Options& options = {});

namespace detail {

/// The rotation with the smallest sum of squared angles to some near each other; n >= 1.
VERNIER_API Matrix3 karcher_mean(std::span<const Matrix3> rotations);
/// Rotation vectors of rotations with respect to a reference, in the outer frame, n x 3.
VERNIER_API PointRows rotation_vectors_from(std::span<const Matrix3> rotations, const Matrix3& reference);
/// `mean(l) + 3 std(l)` of the distances l from the barycentre; NaN for one point.
VERNIER_API double repeatability(const PointRows& points);
/// Three standard deviations of each column; NaN for one row.
VERNIER_API VectorX three_deviations(const ConstMatrixRef& values);

}  // namespace detail

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/evaluation/iso9283.ipp"
#endif
