// SPDX-License-Identifier: BSD-3-Clause
// Arms with prismatic joints on the whole way: every program takes what the one before has written.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "program_runs.hpp"
#include "vernier/data/csv.hpp"

namespace vernier::joint_types_test {
namespace {

struct Arm {
  const char* name;
  std::string joints;   ///< of its file
  std::string options;  ///< of calibrate
  std::vector<JointType> types;
  std::string targets;
};

std::string rotating(double a, double alpha, double d, double theta, double limit) {
  return message("{\"a_mm\":", a, ",\"alpha_deg\":", alpha, ",\"d_mm\":", d, ",\"theta_deg\":", theta,
                 ",\"lower_deg\":", -limit, ",\"upper_deg\":", limit, "}");
}
std::string sliding(double alpha, double d, double theta, double upper) {
  return message("{\"type\":\"prismatic\",\"a_mm\":0,\"alpha_deg\":", alpha, ",\"d_mm\":", d, ",\"theta_deg\":", theta,
                 ",\"lower_mm\":0,\"upper_mm\":", upper, "}");
}

constexpr JointType turn = JointType::revolute, slide = JointType::prismatic;

std::vector<Arm> arms() {
  return {{"rail",
           sliding(-90, 0, 0, 3000) + "," + rotating(100, 90, 400, 0, 150) + "," + rotating(500, 0, 0, 90, 100) + "," +
               rotating(400, 90, 0, 0, 120),
           "",
           {slide, turn, turn, turn},
           "q1_mm,q2_deg,q3_deg,q4_deg\n1500,20,-30,40\n700,-15,10,55\n"},
          {"scara",
           rotating(325, 0, 400, 0, 130) + "," + rotating(225, 180, 0, 0, 145) + "," + sliding(0, 100, 0, 200) + "," +
               rotating(0, 0, 50, 0, 360),
           " --fix tool_z",
           {turn, turn, slide, turn},
           "q1_rad,q2_rad,q3_m,q4_rad\n0.1,0.8,0.1,0.3\n-0.5,1.2,0.05,-1\n"},
          {"gantry",
           sliding(-90, 0, 0, 2000) + "," + sliding(90, 0, 90, 1500) + "," + sliding(0, 0, 0, 800) + "," +
               rotating(0, 90, 100, 0, 180) + "," + rotating(150, 0, 0, 0, 90),
           "",
           {slide, slide, slide, turn, turn},
           "q1_m,q2_mm,q3_um,q4_mrad,q5_deg\n1,700,400000,300,20\n0.5,900,300000,-500,-35\n"}};
}

class JointTypes : public ::testing::TestWithParam<Arm>, protected vernier_test::ProgramRuns {
 protected:
  JointTypes() : ProgramRuns("joint_types") {}
  /// The first columns of a file.
  std::string header(const std::string& name) const {
    const std::string text = read_file(folder_ / name);
    return text.substr(0, text.find('\n'));
  }
};

TEST_P(JointTypes, PlanSimulateCalibrateCorrect) {
  const Arm& arm = GetParam();
  write_file(folder_ / "arm.json",
             message("{\"name\":\"", arm.name, "\",\"convention\":\"standard\",\"joints\":[", arm.joints, "]}"));
  write_file(folder_ / "targets.csv", arm.targets);
  std::string names, from;
  for (std::size_t j = 0; j < arm.types.size(); ++j) {
    const std::string name = message("q", j + 1, arm.types[j] == slide ? "_m" : "_rad");
    names += (j > 0 ? "," : "") + name;
    from += "from_" + name + ",";
  }

  done("plan_poses' --robot arm.json --count 40 --candidates 400 --orientations --out plan.csv");
  EXPECT_EQ(header("plan.csv"), names + ",visit");
  const std::string simulated = done("simulate_measurements' --robot arm.json --poses plan.csv --out measured.csv");
  EXPECT_EQ(simulated.find("not read"), std::string::npos) << simulated;
  EXPECT_EQ(header("measured.csv"), names + ",x_mm,y_mm,z_mm,rx_rad,ry_rad,rz_rad");
  done(
      "plan_poses' --robot arm.json --from measured.csv --choose 20 --test-every 4 --held-out held.csv --out some.csv");
  EXPECT_EQ(header("some.csv"), from + "time_s," + names + ",x_mm,y_mm,z_mm,rx_rad,ry_rad,rz_rad");
  EXPECT_EQ(header("held.csv"), header("some.csv"));
  done("plan_poses' --robot arm.json --data some.csv --add 5 --candidates 200 --out more.csv");
  const std::string calibrated = done(
      "calibrate' --robot arm.json --data measured.csv --test held.csv --save model.json --out figures "
      "--harmonics 0 --no-approach --verbose" +
      arm.options);
  done("correct' --model model.json --targets targets.csv --out commands.csv --no-radius");
  EXPECT_EQ(header("commands.csv").find(names + ",status,"), 0u);
  done("simulate_measurements' --robot arm.json --poses commands.csv --out again.csv --seed 3");
  EXPECT_EQ(header("again.csv"), header("measured.csv"));
  if (std::string(arm.name) != "scara") {  // whose model has no covariance
    const auto checked = run("verify_calibration' --model model.json --data held.csv");
    EXPECT_NE(checked.output.find("12 poses of held.csv"), std::string::npos) << checked.output << checked.errors;
  }

  // the measured ranges are those of the rows to learn from, in mm and deg
  const std::size_t ranges = calibrated.find("Measured joint ranges [deg, mm]: q1 ");
  ASSERT_NE(ranges, std::string::npos);
  int lower = 0, upper = 0;
  ASSERT_EQ(std::sscanf(calibrated.c_str() + ranges, "Measured joint ranges [deg, mm]: q1 %d..%d", &lower, &upper), 2);
  double least = 1e9, greatest = -1e9;
  const CsvText rows = read_csv_text(folder_ / "measured.csv");
  const std::string held_out = read_file(folder_ / "held.csv");
  for (const auto& row : rows.rows) {
    if (held_out.find("," + row[0] + "," + row[1] + ",") != std::string::npos) continue;
    const double value = std::stod(row[0]) * (arm.types[0] == slide ? 1e3 : 180 / std::numbers::pi);
    least = std::min(least, value);
    greatest = std::max(greatest, value);
  }
  EXPECT_EQ(lower, std::llround(least));
  EXPECT_EQ(upper, std::llround(greatest));
}

INSTANTIATE_TEST_SUITE_P(Arms, JointTypes, ::testing::ValuesIn(arms()),
                         [](const auto& arm) { return std::string(arm.param.name); });

}  // namespace
}  // namespace vernier::joint_types_test
