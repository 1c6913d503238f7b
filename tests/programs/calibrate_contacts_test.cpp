// SPDX-License-Identifier: BSD-3-Clause
// calibrate --contacts, with and without measured poses, on a simulated arm.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "run_command.hpp"
#include "temporary_folder.hpp"
#include "touched_objects.hpp"
#include "vernier/core/register_points.hpp"
#include "vernier/core/sha256.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/identification/frames.hpp"
#include "vernier/identification/object_errors.hpp"
#include "vernier/io/model_file.hpp"
#include "vernier/simulation/error_sources.hpp"

namespace vernier::calibrate_contacts_test {
namespace {

using vernier_test::actual_arm;
using vernier_test::CommandResult;
using vernier_test::IrbArm;
using vernier_test::lengths;
using vernier_test::registered_mean;
using vernier_test::TemporaryFolder;
using vernier_test::three_planes;
using vernier_test::touched;

/// Contacts as a file.
std::string text_of(const std::vector<Contact>& contacts) {
  std::string out = "contact_id,kind,offset_mm,radius_mm,q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad\n";
  for (const Contact& contact : contacts)
    for (Index i = 0; i < contact.size(); ++i) {
      const bool ball = contact.kind() == ContactKind::ball;
      const std::string length = message(contact.known()(i) * 1e3);
      out += message(contact.name(), ',', name_of(contact.kind()), ',', ball ? "" : length, ',', ball ? length : "");
      for (Index j = 0; j < 6; ++j) out += message(',', contact.joints()(i, j));
      out += '\n';
    }
  return out;
}

class CalibrateContacts : public ::testing::Test {
 protected:
  CommandResult calibrate(const std::string& arguments) {
    const std::string robot = arguments.starts_with("--robot") ? "" : "--robot abb_irb120 ";
    return vernier_test::run_command("cd '" + folder_.path().string() + "'; '" + VERNIER_EXAMPLES_DIR +
                                         "/calibrate' --date 2024-05-01 --out figures " + robot + arguments,
                                     folder_.path());
  }
  void refused(const std::string& arguments, int code, const std::string& reason) {
    const CommandResult result = calibrate(arguments);
    EXPECT_EQ(result.exit_code, code) << arguments;
    EXPECT_TRUE(result.one_line_of_errors()) << result.errors;
    EXPECT_NE(result.errors.find(reason), std::string::npos) << result.errors;
  }
  TemporaryFolder folder_{"calibrate_contacts"};
};

TEST_F(CalibrateContacts, WithoutPosesNamesWhatIsNotObservableAndSavesTheArm) {
  write_file(folder_ / "contacts.csv", text_of(three_planes(true, 20, 0.03e-3)));
  // the catalogue's arm has no tool: the tip, 115 mm from the flange, is found
  const CommandResult result = calibrate("--contacts contacts.csv --save model.json --json out.json");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  for (const char* part :
       {"60 touches of 3 objects, no measured poses: the geometry alone is identified",
        "Contacts do not observe (15 of 45 directions)", "the base frame (6 directions)", "table: plane, 20 touches"})
    EXPECT_NE(result.output.find(part), std::string::npos) << result.output;
  EXPECT_EQ(result.output.find("the scale of the arm"), std::string::npos) << result.output;
  const auto robot = load<6>(folder_ / "model.json");
  EXPECT_EQ(robot.provenance().measured, "contacts");
  EXPECT_EQ(robot.provenance().rows, 60);
  EXPECT_EQ(robot.identified().base().matrix(), Isometry3::Identity().matrix());
  EXPECT_LT(registered_mean(robot), 0.25e-3);
  ASSERT_NE(robot.estimate(), nullptr);
  EXPECT_EQ(robot.estimate()->covariance.rows(), 21);
  EXPECT_TRUE(robot.provenance().fitted_to(sha256(read_file(folder_ / "contacts.csv"))));
  EXPECT_GT(registered_mean(robot.nominal()), 1e-3);
  const auto json = nlohmann::json::parse(read_file(folder_ / "out.json"));
  EXPECT_EQ(json.at("unobservable_directions"), 15);
  EXPECT_EQ(json.at("scale_observable"), true);
  EXPECT_EQ(json.at("objects").size(), 3u);
  EXPECT_EQ(json.at("parameters").size(), 21u);
}

/// Five objects: a bar and a ball that are held out by every fourth, and three planes.
std::vector<Contact> five_objects() {
  std::vector<Contact> out = three_planes(true, 20, 0.03e-3);
  out.insert(out.begin(), touched({ContactKind::socket, {0.3, 0.1, 0.4}, Vector3(0.6, 0, -0.8)}, "bar",
                                  lengths(20, 10, 0.15), 0.03e-3, 8));
  out.push_back(
      touched({ContactKind::ball, {0.4, 0.1, 0.3}, Vector3::UnitZ()}, "ball", VectorX::Constant(20, 0.02), 0.03e-3, 9));
  return out;
}

TEST_F(CalibrateContacts, HeldOutObjectsTestTheArm) {
  const std::vector<Contact> all = five_objects();
  write_file(folder_ / "all.csv", text_of(all));
  const CommandResult result =
      calibrate("--contacts all.csv --test-every 4 --save model.json --report report.html --json out.json");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("60 touches of 3 objects"), std::string::npos) << result.output;
  EXPECT_NE(result.output.find("every object i with i % 4 = 0"), std::string::npos) << result.output;
  const auto json = nlohmann::json::parse(read_file(folder_ / "out.json"));
  const auto& objects = json.at("held_out_objects");
  ASSERT_EQ(objects.size(), 2u);
  double sum = 0;
  for (const auto& object : objects) {
    EXPECT_EQ(object.at("touches"), 20);
    EXPECT_LT(object.at("rms_mm"), 0.25) << object;
    EXPECT_GT(object.at("rms_designed_mm").get<double>(), 4 * object.at("rms_mm").get<double>()) << object;
    EXPECT_LT(std::abs(object.at("length_error_mm").get<double>()), 0.2) << object;
  }
  const auto robot = load<6>(folder_ / "model.json");
  for (const std::size_t k : {0, 4})
    sum += object_errors(ArmGeometry(robot.identified().around(robot.identified().chain())), all[k]).distances.sum();
  EXPECT_NEAR(robot.provenance().held_out_error, sum / 40, 1e-9);
  const std::string page = read_file(folder_ / "report.html");
  for (const char* part : {"Calibration by contacts", "40 held-out touches", "<h2>Objects</h2>", "fitted to 60 others",
                           "Not observed: the base frame"})
    EXPECT_NE(page.find(part), std::string::npos) << part;

  // the same objects in a file of their own
  write_file(folder_ / "train.csv", text_of({all[1], all[2], all[3]}));
  write_file(folder_ / "held.csv", text_of({all[0], all[4]}));
  const CommandResult apart = calibrate("--contacts train.csv --test held.csv --json apart.json");
  ASSERT_EQ(apart.exit_code, 0) << apart.errors;
  EXPECT_EQ(nlohmann::json::parse(read_file(folder_ / "apart.json")).at("held_out_objects"), objects);
}

TEST_F(CalibrateContacts, ATouchThatSlippedIsNamed) {
  std::vector<Contact> all = five_objects();
  MatrixX joints = all[2].joints();
  joints(7, 1) += 3e-3;
  const double off = std::abs(actual_arm().position(JointVector<6>(joints.row(7).transpose())).x() - 0.45) * 1e3;
  ASSERT_GT(off, 0.25);
  all[2] = Contact("front", ContactKind::plane, joints, all[2].known());
  write_file(folder_ / "slipped.csv", text_of(all));
  const CommandResult result = calibrate("--contacts slipped.csv --json out.json");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("Suspect touch: slipped.csv, line 49 (front)"), std::string::npos) << result.output;
  const auto json = nlohmann::json::parse(read_file(folder_ / "out.json"));
  ASSERT_EQ(json.at("suspects").size(), 1u) << json.at("suspects");
  EXPECT_NEAR(json.at("suspects")[0].at("error_mm").get<double>(), off, 0.1);
}

TEST_F(CalibrateContacts, FreshPosesConfirmTheModel) {
  write_file(folder_ / "all.csv", text_of(five_objects()));
  ASSERT_EQ(calibrate("--contacts all.csv --save model.json").exit_code, 0);
  const auto verified = [&](const IrbArm& arm) {
    write_dataset(folder_ / "fresh.csv",
                  measure(arm, abb_irb120_operating_region().sample(robots::abb_irb120().chain, 20, 15),
                          {.position = 0.03e-3, .with_orientations = false}, 16));
    return vernier_test::run_command("cd '" + folder_.path().string() + "'; '" + VERNIER_EXAMPLES_DIR +
                                         "/verify_calibration' --model model.json --data fresh.csv",
                                     folder_.path());
  };
  const CommandResult same = verified(actual_arm());
  EXPECT_EQ(same.exit_code, 0) << same.output << same.errors;
  auto links = actual_arm().chain().parameters();
  links(5 * 2 + 3) += 3e-3;  // the zero of joint 3
  const CommandResult moved =
      verified(IrbArm(actual_arm().chain().with_parameters(links), {}, actual_arm().tool_frame()));
  EXPECT_EQ(moved.exit_code, 1) << moved.output << moved.errors;
  EXPECT_NE(moved.output.find("the zero of joint 3 moved"), std::string::npos) << moved.output;
}

TEST_F(CalibrateContacts, AnEarlierCalibrationIsThePrior) {
  write_file(folder_ / "few.csv", text_of(three_planes(true, 5, 0.03e-3)));
  write_dataset(folder_ / "poses.csv",
                measure(actual_arm(), abb_irb120_operating_region().sample(robots::abb_irb120().chain, 40, 5),
                        {.position = 0.1e-3, .with_orientations = false}, 6));
  ASSERT_EQ(calibrate("--data poses.csv --harmonics 0 --threads 1 --save earlier.json").exit_code, 0);
  const CommandResult result = calibrate("--contacts few.csv --prior earlier.json --save model.json --json out.json");
  ASSERT_EQ(result.exit_code, 0) << result.errors;  // alone they do not determine the arm
  EXPECT_NE(result.output.find("Prior: earlier.json"), std::string::npos) << result.output;
  const double before = registered_mean(load<6>(folder_ / "earlier.json")),
               after = registered_mean(load<6>(folder_ / "model.json"));
  EXPECT_LT(before, 0.2e-3);
  EXPECT_LT(after, 1.05 * before);
  EXPECT_EQ(nlohmann::json::parse(read_file(folder_ / "out.json")).at("prior").at("model"), "earlier.json");
  EXPECT_NE(load<6>(folder_ / "model.json").estimate(), nullptr);
}

TEST_F(CalibrateContacts, JointErrorsOfAnEarlierCalibrationAreHeld) {
  using Geared = Framed<WithJointErrors<DhChain<6>>>;
  const JointErrorSizes sizes{.gear_ratio = 0, .coupling = 0, .compliance = 0, .harmonic = 0.4e-3, .harmonics = 2};
  const Geared arm({actual_arm().chain(), draw_joint_errors(actual_arm().chain(), sizes, 3)}, {},
                   actual_arm().tool_frame());
  const auto region = abb_irb120_operating_region();
  write_dataset(folder_ / "poses.csv", measure(arm, region.sample(robots::abb_irb120().chain, 150, 5),
                                               {.position = 0.02e-3, .with_orientations = false}, 6));
  write_file(folder_ / "few.csv",
             text_of({touch(arm, vernier_test::table, "table", lengths(8, 4, 0.1), region.limits, 0.02e-3, 1),
                      touch(arm, vernier_test::front, "front", lengths(8), region.limits, 0.02e-3, 2),
                      touch(arm, vernier_test::side, "side", lengths(8), region.limits, 0.02e-3, 3)}));
  ASSERT_EQ(calibrate("--data poses.csv --harmonics 2 --no-tilt --no-drift --threads 1 --save earlier.json").exit_code,
            0);
  const CommandResult result = calibrate("--contacts few.csv --prior earlier.json --save model.json --json out.json");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const auto earlier = load<6>(folder_ / "earlier.json"), model = load<6>(folder_ / "model.json");
  const VectorX& held = earlier.identified().model().joint_errors().coefficients();
  ASSERT_GT(held.size(), 0);
  EXPECT_EQ(model.identified().model().joint_errors().coefficients(), held);
  EXPECT_GT(model.estimate()->covariance.rows(), held.size());
  const auto error = [&](const auto& of) {
    const JointRows<6> joints = region.sample(robots::abb_irb120().chain, 100, 9);
    PointRows points(100, 3), actual(100, 3);
    for (Index i = 0; i < 100; ++i) {
      set_point(points, i, of.position(configuration(joints, i)));
      set_point(actual, i, arm.position(configuration(joints, i)));
    }
    const Isometry3 base = register_points(points, actual);
    double sum = 0;
    for (Index i = 0; i < 100; ++i) sum += (transformed(base, point(points, i)) - point(actual, i)).norm() / 100;
    return sum;
  };
  EXPECT_LT(error(earlier), 0.05e-3);
  EXPECT_LT(error(model), 0.05e-3);  // its tool point is that of 24 touches
}

/// Distances from two fixed points as files, wire1.csv and wire2.csv.
/// @param law columns of joints: those of the chain, or others that follow from them
template <class Arm, class Law>
void write_wires(const TemporaryFolder& folder, const Arm& arm, const Law& law) {
  const JointRows<6> joints = abb_irb120_operating_region().sample(robots::abb_irb120().chain, 240, 5);
  for (const int wire : {1, 2}) {
    const auto distances =
        measure_distances(arm, wire == 1 ? Vector3(0.9, -0.4, 0.1) : Vector3(0.2, 0.9, 0.9),
                          joints.middleRows(120 * (wire - 1), 120), 0.03e-3, static_cast<std::uint64_t>(wire));
    std::string text = "q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad,distance_mm\n";
    for (Index i = 0; i < distances.size(); ++i) {
      const JointVector<6> q = law(JointVector<6>(distances.joints(i)));
      for (const double value : q) text += message(value, ',');
      text += message(distances.length(i) * 1e3, '\n');
    }
    write_file(folder / ("wire" + std::to_string(wire) + ".csv"), text);
  }
}

TEST_F(CalibrateContacts, DistancesAloneCalibrate) {
  write_wires(folder_, actual_arm(), [](const JointVector<6>& q) { return q; });
  const CommandResult result = calibrate(
      "--distances wire1.csv --distances wire2.csv --harmonics 0 --threads 1 --test-every 4 --save model.json --report "
      "report.html --json out.json");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("180 distances from 2 fixed points to learn from, 60 held out"), std::string::npos)
      << result.output;
  const auto json = nlohmann::json::parse(read_file(folder_ / "out.json"));
  const auto& stages = json.at("stages");
  EXPECT_GT(stages.at("frames").at("mean_mm"), 0.3) << stages;
  const auto robot = load<6>(folder_ / "model.json");
  EXPECT_EQ(robot.provenance().measured, "distances");
  EXPECT_EQ(robot.provenance().rows, 180);
  EXPECT_LT(robot.provenance().held_out_error, 0.06e-3);
  EXPECT_LT(registered_mean(robot), 0.1e-3);
  EXPECT_NE(read_file(folder_ / "report.html").find("60 held-out distances"), std::string::npos);
}

// Joint 3 follows motors 2 and 3, as the robot file says, and so do its errors.
TEST_F(CalibrateContacts, DistancesCalibrateAnArmWhoseMotorsErr) {
  const DhChain<6> designed = robots::abb_irb120().chain;
  std::string rows;
  for (int i = 0; i < 6; ++i) {
    const DhRow row = designed.row(i);
    rows += message(i == 0 ? "" : ", ", "{\"a_m\": ", row.a, ", \"alpha_rad\": ", row.alpha, ", \"d_m\": ", row.d,
                    ", \"theta_rad\": ", row.theta, "}");
  }
  write_file(folder_ / "arm.json", R"({"name": "arm", "convention": "standard", "joints": [)" + rows +
                                       R"(], "controller": {"chain": ["J1", "J2", "J3 - J2", "J4", "J5", "J6"],
                                          "errors": "motors"}})");
  const JointErrorSizes sizes{.gear_ratio = 0, .coupling = 0, .compliance = 0, .harmonic = 0.5e-3, .harmonics = 1};
  const Framed<WithJointErrors<DhChain<6>>> geared({actual_arm().chain(), draw_joint_errors(designed, sizes, 3)}, {},
                                                   actual_arm().tool_frame());
  write_wires(folder_, geared, [](JointVector<6> q) {
    q(2) += q(1);
    return q;
  });
  const CommandResult result = calibrate(
      "--robot arm.json --distances wire1.csv --distances wire2.csv --harmonics 1 --no-tilt --no-drift --threads 1 "
      "--save model.json");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const JointErrors errors = load<6>(folder_ / "model.json").identified().model().joint_errors();
  ASSERT_FALSE(errors.empty());
  EXPECT_FALSE(errors.terms().motors.none());
}

TEST_F(CalibrateContacts, WithoutALengthTheScaleIsNamed) {
  write_file(folder_ / "contacts.csv", text_of(three_planes(false, 20, 0.03e-3)));
  const CommandResult result = calibrate("--contacts contacts.csv");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("the scale of the arm (1 direction): no contact has a known length"), std::string::npos)
      << result.output;
}

TEST_F(CalibrateContacts, BesidePosesBothAreUsed) {
  write_file(folder_ / "contacts.csv", text_of(three_planes(true, 40, 0.01e-3)));
  write_dataset(folder_ / "poses.csv",
                measure(actual_arm(), abb_irb120_operating_region().sample(robots::abb_irb120().chain, 50, 5),
                        {.position = 0.5e-3, .with_orientations = false}, 6));
  const CommandResult both = calibrate(
      "--data poses.csv --harmonics 0 --threads 1 --contacts contacts.csv --contact-sigma 0.01 --save both.json");
  ASSERT_EQ(both.exit_code, 0) << both.errors;
  EXPECT_NE(both.output.find("40 measurements (plane) to learn from: contact table"), std::string::npos) << both.output;
  // the poses alone bring 0.35 mm
  EXPECT_LT(registered_mean(load<6>(folder_ / "both.json")), 0.2e-3);
}

TEST_F(CalibrateContacts, RefusalsAreOneLine) {
  std::string text = text_of(three_planes(true, 5));
  write_file(folder_ / "few.csv", text);
  refused("--contacts few.csv", 1, "few.csv: 15 touches of 3 objects determine");
  refused("--contacts few.csv", 1, "touch more, at other joint values, or other objects");
  write_file(folder_ / "kind.csv", text + "table,socket,0,,0,0,0,0,0,0\n");
  refused("--contacts kind.csv", 1,
          "kind.csv, line 17, column kind: contact table is a socket here, and a plane above");
  write_file(folder_ / "nan.csv", text + "table,plane,0,,0,nan,0,0,0,0\n");
  refused("--contacts nan.csv", 1, "nan.csv, line 17, column q2_rad: 'nan' is not finite");
  std::string degrees = text_of(three_planes(true, 20));
  degrees.replace(degrees.find("q1_rad"), 6, "q1_deg");
  write_file(folder_ / "degrees.csv", degrees);
  refused("--contacts degrees.csv", 1, "wherever its objects are, touches of the best arm miss them by");
  refused("--contacts missing.csv", 1, "missing.csv");
  refused("--contacts few.csv --prior missing.json", 1, "missing.json");
  refused("--contacts few.csv --harmonics 3", 2, "--harmonics needs --data: contacts alone identify the geometry");
  refused("--contacts few.csv --split region-x", 2, "--split region-x holds measured positions out");
  refused("--contacts few.csv --test-every 2 --train 3", 1, "few.csv: --train asks for 3 objects, there are 1");
  refused("--contacts few.csv --distances few.csv", 2, "--contacts beside --distances needs --data");
  refused("--contacts few.csv --own-tools", 2, "--own-tools needs --data");
  refused("", 2, "--data is required (or --contacts or --distances, to calibrate without measured poses)");
  refused("--data few.csv --contact-sigma 0.1", 2, "--contact-sigma");
}

}  // namespace
}  // namespace vernier::calibrate_contacts_test
