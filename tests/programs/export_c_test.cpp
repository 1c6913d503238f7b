// SPDX-License-Identifier: BSD-3-Clause
// Runs export_c on models made here, compiles what it writes, and runs the demonstrations with it.

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "run_command.hpp"
#include "temporary_folder.hpp"
#include "vernier/io/model_file.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::export_c_program_test {
namespace {

using vernier_test::CommandResult;

class ExportCProgram : public ::testing::Test {
 protected:
  ExportCProgram() { save(folder_ / "model.json", robot_); }

  CommandResult run(const std::string& command) {
    return vernier_test::run_command("cd '" + folder_.path().string() + "'; " + command, folder_.path());
  }
  CommandResult export_c(const std::string& arguments) {
    return run("'" VERNIER_EXAMPLES_DIR "/export_c' --model model.json " + arguments);
  }
  void write_results(const std::string& robot, int rows) {
    const nlohmann::json results{{"robot", robot},
                                 {"train_rows", rows},
                                 {"chosen", "jointwise"},
                                 {"stages", {{"geometry", {{"mean_mm", 0.4}}}, {"jointwise", {{"mean_mm", 0.086}}}}}};
    write_file(folder_ / "results.json", results.dump());
  }

  vernier_test::TemporaryFolder folder_{"export_c"};
  Robot<6> catalogue_ = robots::abb_irb120();
  using Model = CalibratedRobot<6>::Model;
  Model::Arm actual_{with_geometric_errors(catalogue_.chain, {}, 21), FrameParameters(Vector6{1, 2, 0.5, 0, 0, 1}),
                     FrameParameters(Vector6{0, 0, 0.1, 0, 0, 0})};
  CalibratedRobot<6> robot_{"irb", Model(catalogue_.chain, actual_), catalogue_.limits, {"p.csv", 90, "2026-01-02"}};
};

TEST_F(ExportCProgram, WritesAHeaderThatTheDemonstrationsUse) {
  if (run("command -v gcc").exit_code != 0) GTEST_SKIP() << "gcc is not here to compile what is exported";
  write_results("irb", 90);
  const CommandResult done = export_c("--results results.json --out arm.h --json r.json");
  ASSERT_EQ(done.exit_code, 0) << done.errors;
  EXPECT_NE(done.output.find("cc -O2 -shared -fPIC -DARM_API= -x c arm.h -o arm.so -lm\n"), std::string::npos);
  const std::string source = read_file(folder_ / "arm.h");
  EXPECT_NE(source.find("#define ARM_HELD_OUT_ERROR 8.599"), std::string::npos);
  EXPECT_NE(source.find("#define ARM_MODEL_DATE \"2026-01-02\"\n"), std::string::npos);
  const auto report = nlohmann::json::parse(read_file(folder_ / "r.json"));
  EXPECT_EQ(report.at("bytes"), source.size());
  EXPECT_NEAR(report.at("held_out_error_mm"), 0.086, 1e-12);

  const auto demos = std::filesystem::absolute(__FILE__).parent_path().parent_path().parent_path() / "examples" / "c";
  ASSERT_EQ(run("cp '" + (demos / "demo.c").string() + "' '" + (demos / "demo.py").string() + "' .").exit_code, 0);
  const CommandResult in_c = run("gcc -std=c99 -pedantic -Wall -Wextra -Werror -O2 demo.c -o demo -lm && ./demo");
  EXPECT_EQ(in_c.exit_code, 0) << in_c.errors;
  EXPECT_NE(in_c.output.find("irb, calibrated 2026-01-02, model "), std::string::npos) << in_c.output;
  const auto met = [](const std::string& output) {
    std::size_t count = 0;
    for (std::size_t at = 0; (at = output.find(" 0.0000 mm left", at)) != std::string::npos; ++at) ++count;
    return count;
  };
  EXPECT_EQ(met(in_c.output), 3u) << in_c.output;

  const std::string python = std::filesystem::exists("/usr/bin/python3") ? "/usr/bin/python3" : "python3";
  if (run(python + " -c 'import numpy'").exit_code != 0) GTEST_SKIP() << "python3 with numpy is not here";
  ASSERT_EQ(run("gcc -O2 -shared -fPIC -DARM_API= -x c arm.h -o arm.so -lm").exit_code, 0);
  const CommandResult in_python = run(python + " demo.py ./arm.so 6");
  EXPECT_EQ(in_python.exit_code, 0) << in_python.errors;
  EXPECT_EQ(met(in_python.output), 3u) << in_python.output;
}

TEST_F(ExportCProgram, TheModelsHeldOutErrorIsStated) {
  ASSERT_EQ(export_c("--out arm.h --json r.json").exit_code, 0);
  EXPECT_EQ(read_file(folder_ / "arm.h").find("HELD_OUT_ERROR"), std::string::npos);
  EXPECT_FALSE(nlohmann::json::parse(read_file(folder_ / "r.json")).contains("held_out_error_mm"));
  Provenance from = robot_.provenance();
  from.held_out_error = 1.25e-4;
  save(folder_ / "model.json", CalibratedRobot<6>("irb", robot_.model(), robot_.limits(), from));
  ASSERT_EQ(export_c("--out arm.h --json r.json").exit_code, 0);
  EXPECT_NE(read_file(folder_ / "arm.h").find("#define ARM_HELD_OUT_ERROR 0.000125 "), std::string::npos);
  EXPECT_NEAR(nlohmann::json::parse(read_file(folder_ / "r.json")).at("held_out_error_mm"), 0.125, 1e-12);
  write_results("irb", 90);  // of other held-out poses
  ASSERT_EQ(export_c("--results results.json --out arm.h").exit_code, 0);
  EXPECT_NE(read_file(folder_ / "arm.h").find("#define ARM_HELD_OUT_ERROR 8.599"), std::string::npos);
}

TEST_F(ExportCProgram, RefusesInOneLine) {
  const auto refused = [&](const std::string& arguments, int code, const std::string& why) {
    const CommandResult done = export_c(arguments);
    EXPECT_EQ(done.exit_code, code) << arguments;
    EXPECT_TRUE(done.one_line_of_errors()) << done.errors;
    EXPECT_NE(done.errors.find(why), std::string::npos) << done.errors;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "x.h"));
  };
  refused("", 2, "--out is required");
  refused("--out x.h --name 'my arm'", 1, "the name 'my arm' is no C identifier");
  refused("--out x.h --results none.json", 1, "none.json");
  write_results("irb", 91);
  refused("--out x.h --results results.json", 1,
          "are results of another calibration: 'irb', 91 rows; the model: 'irb', 90 rows");
  write_results("another", 90);
  refused("--out x.h --results results.json", 1, "are results of another calibration: 'another', 90 rows");
  refused("--out x.h --results model.json", 1, "is missing");

  const JointRows<6> joints = sample_joints(robot_.limits(), 30, 6);
  const KernelPredictor<6, 3> kernels(Kernel::squared_exponential, InputMap::raw,
                                      {VectorX::Constant(6, 0.01), VectorX::Constant(6, 0.9)}, joints,
                                      1e-4 * joints.leftCols<3>(), Vector3(1e-5, 0, -2e-5));
  save(folder_ / "model.json", robot_.with_learned(kernels, JointCoverage<6>::covering(joints)));
  refused("--out x.h", 1, "a sum of 30 kernels (kernel ELM, Gaussian process), which is not written as C source");
  write_file(folder_ / "model.json", "{}");
  refused("--out x.h", 1, "is this a model that calibrate saved?");
}

}  // namespace
}  // namespace vernier::export_c_program_test
