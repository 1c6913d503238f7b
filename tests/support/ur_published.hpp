// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Published factory calibrations of Universal Robots' arms: facts from UniversalRobots/Universal_Robots_ROS2_Driver,
// ur_calibration/test/calibration_test.cpp (the values of its parameterised test and its table of nominal rows).

#include <array>
#include <string>

#include "vernier/core/check.hpp"
#include "vernier/io/robot_file.hpp"

namespace vernier_test {

/// What a controller adds to its nominal rows [rad, m].
struct UrDeltaSet {
  const char* name;
  std::array<double, 6> theta, a, d, alpha;

  /// As the controller's calibration.conf.
  std::string conf() const {
    const auto list = [](const std::array<double, 6>& values) {
      std::string out = "[";
      for (const double value : values) out += (out.size() > 1 ? ", " : " ") + vernier::message(value);
      return out + "]\n";
    };
    return "[mounting]\ndelta_theta = " + list(theta) + "delta_a = " + list(a) + "delta_d = " + list(d) +
           "delta_alpha = " + list(alpha) +
           "joint_checksum = [ 0xb3241580, 0xb10112f1, 0x290cac88, 0xa8d3f155, 0xa8b7e9eb, 0xa8dbbfa3]\n"
           "calibration_status = 2 # 0 == notInitialized / 1 == notLinearised / 2 == Linearised\n";
  }
};

inline const std::array<UrDeltaSet, 3>& ur_delta_sets() {
  static const std::array<UrDeltaSet, 3> sets{{
      {"ur10",
       {-7.290070070824746e-05, -0.01713897289704999, -0.03707159413492756, 0.054279462160583214, 1.488984257025741e-07,
        1.551499479707493e-05},
       {4.6311376834935676e-05, -0.00012568315331862312, 0.00186216581161458, 9.918593870679266e-05,
        4.215462720453189e-06, 0},
       {0.00065609212979853, 1.4442162376284788, 0.854147723854608, -2.2989425877563705, -1.573498686836816e-05,
        1.9072435590711256e-05},
       {0.000211987863869334, -0.0072553625957652995, -0.013483226769541364, 0.0013495820227329425,
        -0.001263136163679901, 0}},
      {"ur10e a",
       {1.59613525316931737e-07, -0.917209621528830232, 7.12936131346499469, 0.0710299029424392298,
        -1.64258976526054923e-06, 9.17286101034808787e-08},
       {0.000108651068627930392, 0.240324175250532346, 0.00180628180213493472, 2.63076149165684402e-05,
        3.96638632500012715e-06, 0},
       {-0.000144894975118076141, 303.469135666158195, -309.88394307789747, 6.41459904397394975,
        -4.48232900190081995e-05, -0.00087071402790364627},
       {-0.000444781952841921679, -0.00160215112531214153, 0.00631917793331091861, -0.00165055247340828437,
        0.000763682515545038854, 0}},
      {"ur10e b",
       {-2.41478068943590252e-07, 1.60233952386694556, -1.68607190752171299, 0.0837331147700118711,
        -1.01260355871157781e-07, 3.91986209186123702e-08},
       {2.12234865571205891e-05, 0.632017132627700651, 0.00229833638891230319, -4.61409023720933908e-05,
        -6.39280053471801522e-05, 0},
       {-0.000160188285741325043, 439.140974079900957, -446.027059806332147, 6.88618689642360149,
        -3.86588496858186748e-05, -0.00087908274257374186},
       {-0.000650246557584166496, 0.00139416666825590402, 0.00693818880325995126, -0.000811641562390219562,
        0.000411120504570705592, 0}},
  }};
  return sets;
}

/// Nominal rows of the UR10e.
inline vernier::RobotDescription ur10e() {
  using namespace vernier::literals;
  vernier::RobotDescription out = vernier::RobotDescription::of(vernier::robots::ur10());
  out.name = "ur10e";
  const double d[] = {0.1807, 0, 0, 0.17415, 0.11985, 0.11655}, a[] = {0, -0.6127, -0.57155, 0, 0, 0};
  for (std::size_t i = 0; i < 6; ++i) {
    out.rows[i].d = d[i];
    out.rows[i].a = a[i];
  }
  return out;
}

/// The nominal arm of a set.
inline vernier::RobotDescription ur_nominal(const UrDeltaSet& set) {
  return std::string(set.name) == "ur10" ? vernier::RobotDescription::of(vernier::robots::ur10()) : ur10e();
}

/// The controller's own pose: products of its rows, deltas added, in long double, as lengths reach 440 m.
inline vernier::Isometry3 ur_controller_pose(const vernier::RobotDescription& nominal, const UrDeltaSet& set,
                                             const vernier::JointVector<6>& q) {
  using Real = long double;
  using Matrix = std::array<std::array<Real, 4>, 4>;
  Matrix pose{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
  for (std::size_t i = 0; i < 6; ++i) {
    const vernier::DhRow& row = nominal.rows[i];
    const Real theta = Real(row.theta) + Real(set.theta[i]) + Real(q(static_cast<vernier::Index>(i)));
    const Real alpha = Real(row.alpha) + Real(set.alpha[i]), a = Real(row.a) + Real(set.a[i]),
               d = Real(row.d) + Real(set.d[i]);
    const Real c = std::cos(theta), s = std::sin(theta), ca = std::cos(alpha), sa = std::sin(alpha);
    const Matrix before = pose,
                 step{{{c, -s * ca, s * sa, a * c}, {s, c * ca, -c * sa, a * s}, {0, sa, ca, d}, {0, 0, 0, 1}}};
    for (std::size_t r = 0; r < 4; ++r)
      for (std::size_t k = 0; k < 4; ++k) {
        pose[r][k] = 0;
        for (std::size_t m = 0; m < 4; ++m) pose[r][k] += before[r][m] * step[m][k];
      }
  }
  vernier::Isometry3 out;
  for (int r = 0; r < 4; ++r)
    for (int k = 0; k < 4; ++k)
      out(r, k) = static_cast<double>(pose[static_cast<std::size_t>(r)][static_cast<std::size_t>(k)]);
  return out;
}

}  // namespace vernier_test
