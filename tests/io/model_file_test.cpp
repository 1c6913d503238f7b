// SPDX-License-Identifier: BSD-3-Clause
// Saved and loaded calibrations: the same bits, and an arm that corrects the same.
#include "vernier/io/model_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "temporary_folder.hpp"
#include "vernier/core/sha256.hpp"
#include "vernier/io/export_c.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::model_file_test {
namespace {

static_assert(KinematicModel<CalibratedRobot<6>> && Compensator<CalibratedRobot<6>>);
static_assert(KinematicModel<CalibratedRobot<6>::Approached>);
static_assert(KinematicModel<CalibratedRobot<3>> && Compensator<CalibratedRobot<9>>);

Isometry3 frame(double x, double y, double z, double rx, double ry, double rz) {
  return FrameParameters(Vector6{x, y, z, rx, ry, rz}).isometry();
}

using Model = CalibratedRobot<6>::Model;

/// An arm with frames alone, or with all that a model can have.
CalibratedRobot<6> example(bool learned) {
  const auto robot = robots::abb_irb120();
  const auto actual = with_geometric_errors(robot.chain, {}, 3);
  const Isometry3 base = frame(1.2, -0.4, 0.05, 0.1, -0.7, 2.0), tool = frame(0, 0.01, 0.109, 0, 0.02, 0);
  const Provenance from{"poses.csv", 120, "2024-05-01", "commanded", "positions", 3e-5, 8e-5, 7e-5};
  if (!learned) return {"an arm", Model(robot.chain, Model::Arm(actual, base, tool)), robot.limits, from};
  const JointRows<6> joints = sample_joints(robot.limits, 80, 5);
  JointTerms terms(6);
  terms.gear_ratio = terms.coupling = true;
  terms.gravity.emplace(robot.chain, Vector3(0, 0.6, -0.8));
  terms.linear_ranges = std::vector<JointRange>(6, {-0.8, 0.6});
  terms.hysteresis = {0.01, 0.3};
  terms.tilt.emplace(robot.chain, Vector3(0, 0.6, -0.8));
  terms.payload.emplace(detail::ChainTable(robot.chain.view()), Vector3(0, 0.6, -0.8),
                        Payload{1.25, Vector3(0.01, 0.02, 0.1)});
  const JointErrors few(terms, VectorX::LinSpaced(terms.size(), -1e-4, 2e-4));
  for (int i = 0; i < 5; ++i) terms.transmission[static_cast<std::size_t>(i)] = Fourier::up_to(3 + i);
  const JointErrors all(terms, VectorX::LinSpaced(terms.size(), -3e-4, 3e-4));
  auto coverage = JointCoverage<6>::covering(joints.topRows(30));
  coverage.periodic = {true, false, true, true, false, true};
  const Model model(robot.chain, Model::Arm({actual, all}, base, tool), Model::Arm({robot.chain, few}, tool, base),
                    coverage);
  const Model thermal = model.with_thermal({21.5, 19, 24.25, VectorX::LinSpaced(42, -1e-5, 2e-5)});
  const CalibratedRobot<6> out("an arm", thermal, robot.limits, from);
  const HiddenLayer layer{.nodes = 12, .input_map = InputMap::sines_and_cosines};
  const Eigen::Matrix<double, Eigen::Dynamic, 3> beta = 1e-4 * joints.topLeftCorner<12, 3>();
  const ElmPredictor<6, 3> network(layer, {VectorX::Constant(12, 0.01), VectorX::Constant(12, 0.9)}, layer.draw(6, 2),
                                   beta, Vector3(1e-5, 0, -2e-5));
  return out.with_learned(network, JointCoverage<6>::covering(joints));
}

/// The same with kernels in place of a network.
CalibratedRobot<6> example_of_kernels() {
  const CalibratedRobot<6> out = example(true);
  const JointRows<6> joints = sample_joints(out.limits(), 30, 6);
  const KernelPredictor<6, 3> kernels(Kernel::squared_exponential, InputMap::raw,
                                      {VectorX::Constant(6, 0.01), VectorX::Constant(6, 0.9)}, joints,
                                      1e-4 * joints.leftCols<3>(), Vector3(1e-5, 0, -2e-5));
  return out.with_learned(kernels, JointCoverage<6>::covering(joints));
}

void expect_same_bits(const Model::Arm& a, const Model::Arm& b) {
  EXPECT_TRUE(a.chain() == b.chain());
  EXPECT_TRUE(a.model().joint_errors().coefficients() == b.model().joint_errors().coefficients());
  const auto &before = a.model().joint_errors().terms().payload, &after = b.model().joint_errors().terms().payload;
  ASSERT_EQ(before.has_value(), after.has_value());
  if (before) {
    EXPECT_EQ(after->reference().mass, before->reference().mass);
    EXPECT_EQ(after->reference().centre, before->reference().centre);
    EXPECT_EQ(after->down(), before->down());
  }
  EXPECT_EQ(a.model().joint_errors().load().weight, b.model().joint_errors().load().weight);
  EXPECT_EQ(a.model().joint_errors().load().moment, b.model().joint_errors().load().moment);
  EXPECT_TRUE(a.base_frame().values() == b.base_frame().values());
  EXPECT_TRUE(a.tool_frame().values() == b.tool_frame().values());
}

class ModelFile : public ::testing::Test {
 protected:
  vernier_test::TemporaryFolder folder_{"model_file"};
};

TEST_F(ModelFile, LoadsTheBitsThatWereSaved) {
  for (const auto& saved : {example(false), example(true), example_of_kernels()}) {
    const bool learned = saved.learned() != nullptr;
    const auto path = folder_ / "m.json";
    save(path, saved);
    const SavedModel read = read_model(path);
    EXPECT_EQ(read.dof(), 6);
    EXPECT_FALSE(read.modified());
    EXPECT_EQ(read.name(), saved.name());
    EXPECT_EQ(read.provenance(), saved.provenance());
    EXPECT_EQ(read.file(), path);
    EXPECT_EQ(read.hash(), sha256(read_file(path)));
    const auto loaded = read.as<6>();
    EXPECT_EQ(loaded.name(), saved.name());
    EXPECT_EQ(loaded.provenance(), saved.provenance());
    EXPECT_TRUE(loaded.nominal().parameters() == saved.nominal().parameters());
    expect_same_bits(loaded.identified(), saved.identified());
    EXPECT_EQ(loaded.model().fallback() != nullptr, learned);
    ASSERT_EQ(loaded.model().thermal() != nullptr, learned);
    EXPECT_TRUE(!learned || *loaded.model().thermal() == *saved.model().thermal());
    EXPECT_TRUE(loaded.limits().lower == saved.limits().lower && loaded.limits().upper == saved.limits().upper);
    EXPECT_EQ(loaded.learned() != nullptr, learned);
    const JointRows<6> samples = sample_joints(saved.limits(), 50, 9);
    for (Index i = 0; i < samples.rows(); ++i) {
      const JointVector<6> joints = samples.row(i).transpose();
      EXPECT_TRUE(loaded.pose(joints).matrix() == saved.pose(joints).matrix());
      EXPECT_TRUE(loaded.jacobian(joints) == saved.jacobian(joints));
      const auto a = loaded.correct(joints), b = saved.correct(joints);
      EXPECT_TRUE(a.command == b.command && a.predicted_error == b.predicted_error && a.gate == b.gate);
      const JointVector<6> previous = samples.row((i + 1) % 50).transpose();
      const auto approached = loaded.approached_from(previous);
      EXPECT_TRUE(approached.pose(joints).matrix() == saved.approached_from(previous).pose(joints).matrix());
      if (learned) {
        EXPECT_GT((approached.position(joints) - loaded.position(joints)).norm(), 1e-6);
      } else {
        EXPECT_TRUE(approached.pose(joints).matrix() == loaded.pose(joints).matrix());
      }
    }
    // and once more through the file: the text is a fixed point
    save(folder_ / "again.json", loaded);
    EXPECT_EQ(read_file(path), read_file(folder_ / "again.json"));
  }
}

TEST_F(ModelFile, PrismaticJointsAndLimitsOfOneSideSurvive) {
  const DhChain<3> scara{{{
      {.a = 0.3},
      {.a = 0.25, .beta = 0.001},
      {.alpha = 3.141592653589793, .joint = JointType::prismatic},
  }}};
  JointLimits<3> limits;
  limits.lower(0) = -1.5;   // no upper
  limits.upper(1) = -0.25;  // no lower
  limits.upper(2) = 0.15;
  const CalibratedRobot<3> saved("scara", {scara, CalibratedRobot<3>::Model::Arm(scara)}, limits, {});
  save(folder_ / "m.json", saved);
  const auto loaded = load<3>(folder_ / "m.json");
  EXPECT_TRUE(loaded.nominal().model() == scara);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(loaded.limits().lower, JointVector<3>(-1.5, -infinity, -infinity));
  EXPECT_EQ(loaded.limits().upper, JointVector<3>(infinity, -0.25, 0.15));
  EXPECT_EQ(loaded.provenance(), Provenance{});
}

TEST_F(ModelFile, TheConventionIsPartOfTheFile) {
  const auto robot = robots::puma560_modified();
  using Saved = CalibratedRobot<6, ModifiedDh>;
  const Saved saved("puma", {robot.chain, Saved::Model::Arm(with_geometric_errors(robot.chain, {}, 3))}, robot.limits,
                    Provenance{});
  save(folder_ / "m.json", saved);
  EXPECT_EQ(read_model(folder_ / "m.json").dof(), 6);
  EXPECT_TRUE(read_model(folder_ / "m.json").modified());
  const auto loaded = load<6, ModifiedDh>(folder_ / "m.json");
  EXPECT_TRUE(loaded.identified().chain() == saved.identified().chain());
  EXPECT_TRUE(loaded.nominal().model() == robot.chain);
  EXPECT_THROW((void)load<6>(folder_ / "m.json"), DataError);
}

TEST_F(ModelFile, CorrectsTowardsTheNominalArmInTheIdentifiedFrames) {
  const auto robot = example(true);
  const OperatingRegion<6> region = abb_irb120_operating_region();
  const JointRows<6> samples = region.sample(robot.nominal().model(), 40, 11);
  for (Index i = 0; i < samples.rows(); ++i) {
    const JointVector<6> q = samples.row(i).transpose();
    const auto correction = robot.correct(q);
    ASSERT_EQ(correction.status, IkStatus::converged);
    const Vector6 left = pose_difference(robot.nominal().pose(q), robot.pose(correction.command));
    EXPECT_LT(left.head<3>().norm(), 1e-6);
    EXPECT_LT(left.tail<3>().norm(), 1e-6);
    EXPECT_GT((correction.command - q).norm(), 1e-4);  // it did something
  }
}

TEST_F(ModelFile, CorrectsForTheDirectionOfApproach) {
  const auto robot = example(true);
  const OperatingRegion<6> region = abb_irb120_operating_region();
  const JointRows<6> samples = region.sample(robot.nominal().model(), 40, 11);
  JointVector<6> previous = samples.row(39).transpose();
  for (Index i = 0; i < samples.rows(); ++i) {
    const JointVector<6> q = samples.row(i).transpose();
    const auto correction = robot.correct(q, previous);
    ASSERT_EQ(correction.status, IkStatus::converged);
    const auto lands = [&](const JointVector<6>& command) {
      return (robot.approached_from(previous).position(command) - robot.nominal().position(q)).norm();
    };
    EXPECT_LT(lands(correction.command), 1e-6);
    EXPECT_GT(lands(robot.correct(q).command), 1e-5);  // corrected for the middle of both directions
    previous = correction.command;
  }
}

TEST_F(ModelFile, OlderFilesStandOnALine) {
  const auto saved = example(true);
  save(folder_ / "m.json", saved);
  auto document = nlohmann::ordered_json::parse(read_file(folder_ / "m.json"));
  document["schema_version"] = 2;
  for (auto& joint : document["coverage"]) joint.erase("periodic");
  for (const char* arm : {"arm", "outside_arm"}) {
    auto& errors = document[arm]["joint_errors"];
    errors.erase("hysteresis");
    errors.erase("tilt");
    errors.erase("linear_ranges");
    errors["coefficients"] = errors["coefficients"].get<int>() - 12 - 36;
    if (!errors.contains("transmission")) continue;
    for (auto& joint : errors["transmission"]) {
      joint["harmonics"] = joint["orders"].size();  // orders 1 .. harmonics
      joint.erase("orders");
    }
  }
  write_file(folder_ / "old.json", document.dump(1));
  const auto loaded = load<6>(folder_ / "old.json");
  EXPECT_EQ(loaded.model().coverage()->periodic, (std::array<bool, 6>{}));
  const JointErrors &old = loaded.identified().model().joint_errors(), &now = saved.identified().model().joint_errors();
  EXPECT_EQ(old.terms().transmission, now.terms().transmission);
  EXPECT_TRUE(old.terms().hysteresis.empty() && old.terms().linear_ranges.empty() && !old.tilts());
  EXPECT_EQ(old.coefficients().tail(50), now.coefficients().tail(50));
}

TEST_F(ModelFile, AnArmThatIsNotFiniteIsNotSaved) {
  const auto robot = robots::abb_irb120();
  auto p = robot.chain.parameters();
  p(7) = std::numeric_limits<double>::quiet_NaN();
  const CalibratedRobot<6> broken("nan", {robot.chain, Model::Arm(robot.chain.with_parameters(p))}, robot.limits, {});
  EXPECT_THROW(save(folder_ / "m.json", broken), std::invalid_argument);
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST_F(ModelFile, TheWrongNumberOfJointsIsRefused) {
  save(folder_ / "m.json", example(false));
  try {
    (void)load<7>(folder_ / "m.json");
    FAIL();
  } catch (const DataError& e) {
    EXPECT_NE(std::string(e.what()).find("m.json: joints: has 6 entries, must have 7"), std::string::npos) << e.what();
  }
}

TEST_F(ModelFile, IsReadOnceSoThatAPipeWillDo) {
  const CalibratedRobot<6> saved = example(true);
  const std::string file = folder_ / "m.json", pipe = folder_ / "pipe";
  save(file, saved);
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const auto through_pipe = [&](auto&& use) {
    std::thread writer([&] { std::ofstream(pipe, std::ios::binary) << read_file(file); });
    use();
    writer.join();
  };
  through_pipe([&] {
    const SavedModel read = read_model(pipe);
    EXPECT_EQ(read.dof(), 6);
    EXPECT_EQ(read.hash(), sha256(read_file(file)));
    save(folder_ / "again.json", read.as<6>());
    EXPECT_EQ(c_source(read), c_source(file));
  });
  EXPECT_EQ(read_file(file), read_file(folder_ / "again.json"));
  through_pipe([&] { EXPECT_EQ(load<6>(pipe).provenance(), saved.provenance()); });
}

}  // namespace
}  // namespace vernier::model_file_test
