// SPDX-License-Identifier: BSD-3-Clause
// Every program that reads CSV files takes --separator and --decimal, and names them where they are needed.

#include <gtest/gtest.h>

#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "program_runs.hpp"
#include "vernier/data/csv.hpp"

namespace vernier::csv_options_test {
namespace {

class CsvOptionsOfPrograms : public ::testing::Test, protected vernier_test::ProgramRuns {
 protected:
  CsvOptionsOfPrograms() : ProgramRuns("csv_options") {}
  /// The same file with semicolons and decimal commas, and a column that means nothing.
  void as_a_spreadsheet(const std::string& from, const std::string& to) const {
    std::string out;
    bool header = true;
    for (const char c : read_file(folder_ / from)) {
      if (c == '\n') out += header ? ";Remark" : ";-";
      if (c == '\n') header = false;
      out += c == ',' ? ';' : c == '.' ? ',' : c;
    }
    write_file(folder_ / to, "\xEF\xBB\xBF" + out);
  }
};

TEST_F(CsvOptionsOfPrograms, AreNamedAndTaken) {
  done("plan_poses' --robot ur5 --count 40 --candidates 200 --out plan.csv");
  done("simulate_measurements' --robot ur5 --poses plan.csv --positions-only --out measured.csv");
  done("calibrate' --robot ur5 --data measured.csv --harmonics 0 --save model.json --out figures --json first.json");
  write_file(folder_ / "targets.csv", "q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad\n0.1,-1.2,1.1,0.3,0.4,0.5\n");
  write_file(folder_ / "touches.csv",
             "contact_id,kind,q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad\nA,socket,.1,.2,.3,.4,.5,.6\n");
  write_file(folder_ / "wire.csv", "q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad,distance_mm\n.1,.2,.3,.4,.5,.6,1500.5\n");
  write_file(folder_ / "visits.csv", "pose,cycle,x_mm,y_mm,z_mm\n1,1,100.5,0,0\n1,2,100.25,0,0.5\n");
  write_file(folder_ / "commanded.csv", "pose,x_mm,y_mm,z_mm\n1,100.5,0,0\n");
  for (const char* file : {"plan", "measured", "targets", "touches", "wire", "visits", "commanded"})
    as_a_spreadsheet(std::string(file) + ".csv", std::string(file) + ".txt");

  const std::string options = " --separator ';' --decimal ,";
  for (const auto& [command, file] : std::vector<std::pair<std::string, std::string>>{
           {"simulate_measurements' --robot ur5 --poses plan.txt --out a.csv", "plan"},
           {"plan_poses' --robot ur5 --count 10 --candidates 50 --region plan.txt --out b.csv", "plan"},
           {"plan_poses' --robot ur5 --add 5 --candidates 50 --data measured.txt --out b.csv", "measured"},
           {"plan_poses' --robot ur5 --choose 10 --from measured.txt --out b.csv", "measured"},
           {"calibrate' --robot ur5 --data measured.txt --harmonics 0 --out figures --json second.json", "measured"},
           {"calibrate' --robot ur5 --data measured.csv --test measured.txt --out figures", "measured"},
           {"calibrate' --robot ur5 --data measured.csv --distances wire.txt --out figures", "wire"},
           {"calibrate' --robot ur5 --contacts touches.txt", "touches"},
           {"calibrate' --model model.json --free base --data measured.txt --save moved.json", "measured"},
           {"correct' --model model.json --targets targets.txt --out c.csv", "targets"},
           {"verify_calibration' --model model.json --data measured.txt --accept-mm 5", "measured"},
           {"iso9283' --data visits.txt --commanded commanded.txt", "commanded"},
           {"export_robot' --robot ur5 --data measured.txt --ur-kinematics d.yaml", "measured"},
           {"compare' --robot ur5 --data measured.txt --methods none --poses 0 --seeds 1,2 --out table", "measured"}}) {
    SCOPED_TRACE(command);
    const auto refused = run(command);
    EXPECT_EQ(refused.exit_code, 1);
    EXPECT_TRUE(refused.one_line_of_errors()) << refused.errors;
    EXPECT_NE(
        refused.errors.find(file + ".txt, line 1: columns are separated by ';', not ','; state that: --separator ';'"),
        std::string::npos)
        << refused.errors;
    if (command.find(".csv --") != std::string::npos && command.find("model.json") == std::string::npos) continue;
    if (file == "touches") continue;  // two files in two forms; too few touches
    const auto taken = run(command + options);
    EXPECT_EQ(taken.exit_code, 0) << taken.errors;
    const std::string remark = file + ".txt: columns that are not read: Remark";
    const auto said = taken.output.find(remark);
    ASSERT_NE(said, std::string::npos) << taken.output;
    EXPECT_EQ(taken.output.find(remark, said + 1), std::string::npos) << taken.output;  // once
  }
  // nothing but the form is another
  done("simulate_measurements' --robot ur5 --poses plan.csv --out e.csv");
  EXPECT_EQ(read_file(folder_ / "a.csv"), read_file(folder_ / "e.csv"));
  EXPECT_EQ(read_dataset<6>(folder_ / "measured.txt", {}, {';', ',', [](const std::string&) {}}).positions(),
            read_dataset<6>(folder_ / "measured.csv").positions());
}

TEST_F(CsvOptionsOfPrograms, ThatCannotBeAreRefused) {
  write_file(folder_ / "q.csv", "q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad\n0,0,0,0,0,0\n");
  for (const auto& [options, said] : std::vector<std::pair<std::string, std::string>>{
           {"--decimal ,", "--separator and --decimal are both ','"},
           {"--decimal x", "--decimal is . or ,"},
           {"--separator ';;'", "--separator takes one character, or tab or space"},
           {"--separator a", "--separator: 'a' cannot be one"},
           {"--separator .", "--separator and --decimal are both '.'"},
           {"--columns q1_deg", "--columns takes our name, = and the file's, as q1_deg=A1; not 'q1_deg'"},
           {"--columns Q1_DEG=A1", "--columns: no file has a column 'Q1_DEG'; is it q1_deg?"}}) {
    const auto result = run("simulate_measurements' --robot ur5 --poses q.csv --out a.csv " + options);
    EXPECT_EQ(result.exit_code, 2) << options;
    EXPECT_NE(result.errors.find(said), std::string::npos) << result.errors;
  }
}

// --degrees: q1_deg, and q1_mm of prismatic joints.
TEST_F(CsvOptionsOfPrograms, WriteDegrees) {
  const auto row_of = [&](const std::string& file) {  // the numbers of the joints in the first row
    std::istringstream text(read_file(folder_ / file));
    std::string line;
    std::getline(text, line);
    std::getline(text, line);
    std::istringstream cells(line);
    std::vector<double> out;
    for (std::string cell; out.size() < 6 && std::getline(cells, cell, ',');) out.push_back(std::stod(cell));
    return out;
  };
  const auto expect_degrees = [&](const std::string& command, const std::string& head) {
    SCOPED_TRACE(command);
    done(command + " --out rad.csv");
    done(command + " --out deg.csv --degrees");
    EXPECT_TRUE(read_file(folder_ / "deg.csv").starts_with(head)) << read_file(folder_ / "deg.csv").substr(0, 80);
    const std::vector<double> radians = row_of("rad.csv"), degrees = row_of("deg.csv");
    for (std::size_t j = 0; j < 6; ++j)
      EXPECT_NEAR(degrees[j], radians[j] * 180 / std::numbers::pi, 1e-9) << "joint " << j + 1;
  };
  const std::string head = "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,";
  expect_degrees("plan_poses' --robot ur5 --count 40 --candidates 200", head + "visit");
  done("simulate_measurements' --robot ur5 --poses deg.csv --positions-only --out measured.csv");
  done("calibrate' --robot ur5 --data measured.csv --harmonics 0 --save model.json --out figures");
  write_file(folder_ / "targets.csv", "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n10,-70,60,0,45,5\n");
  expect_degrees("correct' --model model.json --targets targets.csv --no-radius", head + "status");
  EXPECT_NEAR(row_of("deg.csv")[1], -70, 1);

  write_file(folder_ / "rail.json", R"({"name": "rail", "convention": "standard", "joints": [
    {"type": "prismatic", "a_mm": 0, "alpha_deg": -90, "d_mm": 0, "theta_deg": 0, "lower_mm": 0, "upper_mm": 2000},
    {"a_mm": 300, "alpha_deg": 90, "d_mm": 0, "theta_deg": 0, "lower_deg": -90, "upper_deg": 90},
    {"a_mm": 200, "alpha_deg": 0, "d_mm": 0, "theta_deg": 0, "lower_deg": -90, "upper_deg": 90}]})");
  done("plan_poses' --robot rail.json --count 20 --candidates 100 --out deg.csv --degrees");
  EXPECT_TRUE(read_file(folder_ / "deg.csv").starts_with("q1_mm,q2_deg,q3_deg,visit"))
      << read_file(folder_ / "deg.csv");
  const auto refused = run("plan_poses' --robot ur5 --choose 10 --from measured.csv --out b.csv --degrees");
  EXPECT_EQ(refused.exit_code, 2);
}

TEST_F(CsvOptionsOfPrograms, NameColumns) {
  write_file(folder_ / "q.csv", "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n10,-70,60,0,45,5\n");
  write_file(folder_ / "a.csv", "A1,A2,A3,A4,Pitch,q6_deg\n10,-70,60,0,45,5\n");
  done("simulate_measurements' --robot ur5 --poses q.csv --out ours.csv");
  const auto refused = run("simulate_measurements' --robot ur5 --poses a.csv --out theirs.csv");
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_NE(refused.errors.find("a.csv, line 1: no column q1_rad or q1_deg in the header (A1, A2, A3, A4, Pitch, "
                                "q6_deg); if that is A1, state --columns 'q1_rad=A1' or 'q1_deg=A1'"),
            std::string::npos)
      << refused.errors;
  done(
      "simulate_measurements' --robot ur5 --poses a.csv --out theirs.csv "
      "--columns q1_deg=A1,q2_deg=A2,q3_deg=A3 --columns q4_deg=A4,q5_deg=Pitch");
  EXPECT_EQ(read_file(folder_ / "ours.csv"), read_file(folder_ / "theirs.csv"));
}

// The table of points has these options already; those of the joints have names of their own.
TEST_F(CsvOptionsOfPrograms, OfJoinedFiles) {
  std::string joints = "target;q1_deg;q2_deg;q3_deg;q4_deg;q5_deg;q6_deg;Remark;time_ms\n", points;
  for (int k = 0; k < 8; ++k) {
    joints += message("\"P", k, "\";1", k, ",5;-7", k % 3, ",25;60;", 10 * k, ";45;0;a, b;", 1714561234250 + k, "\n");
    points += message("P", k, " ", 100 + k, ".5 0 300\n");
  }
  write_file(folder_ / "joints.txt", joints);
  write_file(folder_ / "points.txt", points);
  const std::string command =
      "join_measurements' --joints joints.txt --points points.txt --columns name,x,y,z --separator space --unit mm "
      "--key target --out measured.csv";
  const auto refused = run(command);
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_NE(refused.errors.find(
                "joints.txt, line 1: columns are separated by ';', not ','; state that: --joints-separator ';' "
                "--joints-decimal ','"),
            std::string::npos)
      << refused.errors;
  done(command + " --joints-separator ';' --joints-decimal ,");
  const std::string text = read_file(folder_ / "measured.csv");
  EXPECT_EQ(text.substr(0, text.find('\n', text.find('\n') + 1)),
            "target,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,Remark,time_ms,x_mm,y_mm,z_mm,joints_line,points_line\n"
            "P0,10.5,-70.25,60,0,45,0,\"a, b\",1714561234250,100.5,0,300,2,1");
  const auto data = read_dataset<6>(folder_ / "measured.csv");
  EXPECT_EQ(data.times()(7), 1714561234.257);
  EXPECT_EQ(data.size(), 8);
}

}  // namespace
}  // namespace vernier::csv_options_test
