// SPDX-License-Identifier: BSD-3-Clause
// calibrate --contacts, with and without measured poses, on a simulated arm.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "run_command.hpp"
#include "temporary_folder.hpp"
#include "touched_objects.hpp"
#include "vernier/core/sha256.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/identification/frames.hpp"
#include "vernier/io/model_file.hpp"

namespace vernier::calibrate_contacts_test {
namespace {

using vernier_test::actual_arm;
using vernier_test::CommandResult;
using vernier_test::registered_mean;
using vernier_test::TemporaryFolder;
using vernier_test::three_planes;

/// Contacts as a file.
std::string text_of(const std::vector<Contact>& contacts) {
  std::string out = "contact_id,kind,offset_mm,q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad\n";
  for (const Contact& contact : contacts)
    for (Index i = 0; i < contact.size(); ++i) {
      out += message(contact.name(), ',', name_of(contact.kind()), ',', contact.known()(i) * 1e3);
      for (Index j = 0; j < 6; ++j) out += message(',', contact.joints()(i, j));
      out += '\n';
    }
  return out;
}

class CalibrateContacts : public ::testing::Test {
 protected:
  CommandResult calibrate(const std::string& arguments) {
    return vernier_test::run_command("cd '" + folder_.path().string() + "'; '" + VERNIER_EXAMPLES_DIR +
                                         "/calibrate' --robot abb_irb120 --date 2024-05-01 --out figures " + arguments,
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
  write_file(folder_ / "kind.csv", text + "table,socket,0,0,0,0,0,0,0\n");
  refused("--contacts kind.csv", 1,
          "kind.csv, line 17, column kind: contact table is a socket here, and a plane above");
  write_file(folder_ / "nan.csv", text + "table,plane,0,0,nan,0,0,0,0\n");
  refused("--contacts nan.csv", 1, "nan.csv, line 17, column q2_rad: 'nan' is not finite");
  std::string degrees = text_of(three_planes(true, 20));
  degrees.replace(degrees.find("q1_rad"), 6, "q1_deg");
  write_file(folder_ / "degrees.csv", degrees);
  refused("--contacts degrees.csv", 1, "wherever its objects are, touches of the best arm miss them by");
  refused("--contacts missing.csv", 1, "missing.csv");
  refused("--contacts few.csv --prior model.json", 2, "--prior needs --data");
  refused("", 2, "--data is required (or --contacts, to calibrate without measured poses)");
  refused("--data few.csv --contact-sigma 0.1", 2, "--contact-sigma");
}

}  // namespace
}  // namespace vernier::calibrate_contacts_test
