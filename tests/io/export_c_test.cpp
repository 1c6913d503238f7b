// SPDX-License-Identifier: BSD-3-Clause
// Arms as C source: compiled here, equal to the library, and clean for every compiler at hand.
#include "vernier/io/export_c.hpp"

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <sstream>

#include "complaint.hpp"
#include "larger.hpp"
#include "random_chains.hpp"
#include "real_matrix.hpp"
#include "run_command.hpp"
#include "temporary_folder.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/sha256.hpp"
#include "vernier/io/detail/c_tables.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/regression/ridge_elm.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::export_c_test {
namespace {

using vernier_test::difference;
using vernier_test::RealMatrix;
using vernier_test::run_command;

constexpr const char* strict = "-pedantic -Wall -Wextra -Wconversion -Wshadow -Werror -O2";

FrameParameters frame(double x, double y, double z, double rx, double ry, double rz) {
  return FrameParameters(Vector6{x, y, z, rx, ry, rz});
}
const FrameParameters tracker = frame(2.2, -1.4, 0.35, 0.1, -0.7, 2.0), probe = frame(0.02, 0.01, 0.109, 0, 0.02, 0.3);

/// An arm with frames and geometric errors alone.
template <int N, class Convention>
CalibratedRobot<N, Convention> geometric(const DhChain<N, Convention>& chain, const JointLimits<N>& limits) {
  using Model = typename CalibratedRobot<N, Convention>::Model;
  return {"an arm",
          Model(chain, typename Model::Arm(with_geometric_errors(chain, {}, 3), tracker, probe)),
          limits,
          {"poses.csv", 120, "2024-05-01", "commanded", "poses", 3e-5}};
}

/// Terms of every kind, each large enough to be seen; few: those that a model has outside the measured ranges.
template <int N, class Convention>
JointErrors joint_errors(const DhChain<N, Convention>& chain, bool few, const ControllerMap& controller) {
  JointTerms terms(N);
  terms.motors = MotorAngles(controller);
  terms.gravity.emplace(chain, Vector3(0, 0.6, -0.8));
  terms.hysteresis = {0.01, 0.3};
  if (!few) {
    terms.gear_ratio = terms.coupling = true;
    terms.linear_ranges = std::vector<JointRange>(N, {-0.8, 0.6});
    terms.tilt.emplace(chain, Vector3(0.6, 0, -0.8));
    terms.payload.emplace(detail::ChainTable(chain.view()), Vector3(0, 0.6, -0.8), Payload{1, Vector3(0.1, 0, 0.2)});
    terms.bend.emplace(detail::ChainTable(chain.view()), Vector3(0, 0.6, -0.8), Payload{1, Vector3(0.1, 0, 0.2)});
    std::vector<JointRange> ranges(N, {-0.6, 0.8});  // shorter than those of the joints
    terms.straightness.emplace(detail::ChainTable(chain.view()), ranges, 4);
    if (terms.straightness->size() == 0) terms.straightness.reset();
    for (int i = 0; i < N; ++i) {
      Fourier& fourier = terms.transmission[static_cast<std::size_t>(i)];
      if (i == 1) continue;  // a joint without
      fourier = Fourier::up_to(5 + i);
      fourier.orders.insert(fourier.orders.end(), {100, 101, 250 + i, 2408});
    }
  }
  Rng rng(few ? 5 : 4);
  VectorX coefficients(terms.size());
  for (double& value : coefficients) value = 3e-4 * rng.normal();
  for (int i = 0; i < N; ++i)
    for (Index k = 0; k < terms.transmission[static_cast<std::size_t>(i)].size(); ++k)
      coefficients(terms.transmission_begin(i) + k) /= terms.transmission[static_cast<std::size_t>(i)].order(k);
  for (const JointTermBlock& block : terms.blocks())
    for (Index k = 0;
         (block.kind == JointTermBlock::Kind::payload || block.kind == JointTermBlock::Kind::bend) && k < block.count;
         ++k)
      coefficients(block.begin + k) *= 0.05;  // of tens of newton metres
  return JointErrors(terms, coefficients).carrying({4, Vector3(-0.1, 0.05, 0.1)});
}

/// An arm with everything; the measured ranges of every joint end in the middle of its limits, some are periodic.
/// @param controller whose motors err, if it says so; ranges are then theirs
template <int N, class Convention>
CalibratedRobot<N, Convention> with_everything(const DhChain<N, Convention>& chain, const JointLimits<N>& limits,
                                               const ControllerMap& controller = {}) {
  using Model = typename CalibratedRobot<N, Convention>::Model;
  JointCoverage<N> coverage;
  coverage.motors = MotorAngles(controller);
  for (int i = 0; i < N; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double lower = limits.lower(i), length = limits.upper(i) - lower;
    coverage.ranges[k] = {{lower + 0.1 * length, lower + 0.4 * length}, {lower + 0.6 * length, lower + 0.9 * length}};
    coverage.margin(i) = 0.08 * length;
    coverage.periodic[k] = i % 2 == 1 && chain.row(i).joint == JointType::revolute;
  }
  coverage.ranges[0].clear();  // a joint that has no effect
  const auto robot = geometric(chain, limits);
  const auto& arm = robot.identified();
  const typename Model::Arm inside({arm.chain(), joint_errors(chain, false, controller)}, tracker, probe);
  const typename Model::Arm outside({chain, joint_errors(chain, true, controller)},
                                    frame(2.21, -1.4, 0.35, 0.1, -0.7, 2.01), probe);
  return robot.with_model(Model(chain, inside, outside, coverage), robot.provenance());
}

/// With a ridge ELM that learned a function of the joints.
template <int N, class Convention>
CalibratedRobot<N, Convention> with_learned(const CalibratedRobot<N, Convention>& robot, const RidgeElm& learner) {
  const JointRows<N> joints = sample_joints(robot.limits(), 200, 8);
  PointRows errors(joints.rows(), 3);
  for (Index i = 0; i < errors.rows(); ++i)
    for (int j = 0; j < 3; ++j) errors(i, j) = 1e-3 * std::sin(joints(i, j));
  JointCoverage<N> coverage = JointCoverage<N>::covering(0.7 * joints);
  return robot.with_learned(learner.fit(joints, errors, {.seed = 3}), coverage);
}

/// Joint values all over the limits and beyond, and many around the middle.
template <int N>
JointRows<N> test_joints(const JointLimits<N>& limits, Index n) {
  Rng rng(11);
  JointRows<N> out(n, N);
  for (Index i = 0; i < n; ++i)
    for (int j = 0; j < N; ++j) {
      const double middle = 0.5 * (limits.lower(j) + limits.upper(j)), half = limits.upper(j) - middle;
      double at = rng.uniform(i % 5 == 0 ? -1.1 : 0.15, i % 5 == 0 ? 1.1 : 0.87);  // measured: 0.2 .. 0.8 of half
      if (i % 2 == 0) at = -at;
      out(i, j) = middle + half * at;
    }
  return out;
}

/// Makes a function of the header visible in a shared library.
constexpr const char* with_rotation_vector = R"(
void arm_rotation_vector(const double *rotation, double *out);
void arm_rotation_vector(const double *rotation, double *out) { arm_log_(rotation, out); }
)";

/// The functions of an exported arm, compiled.
template <int N>
class Compiled {
 public:
  Compiled(const vernier_test::TemporaryFolder& folder, const std::string& source, int joints = N) : joints_(joints) {
    write_file(folder / "arm.h", source);
    const std::string library = folder / "arm.so";
    const auto done = run_command("gcc -std=c99 " + std::string(strict) + " -shared -fPIC -DARM_API= -x c '" +
                                      (folder / "arm.h").string() + "' -o '" + library + "' -lm",
                                  folder.path());
    if (done.exit_code != 0) throw std::runtime_error(done.errors);
    handle_ = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (handle_ == nullptr) throw std::runtime_error(dlerror());
  }
  Compiled(const Compiled&) = delete;
  Compiled& operator=(const Compiled&) = delete;
  ~Compiled() {
    if (handle_ != nullptr) dlclose(handle_);
  }

  Isometry3 pose(const JointVector<N>& q, const double* previous) const {
    double rows[3][4];
    function<void(const double*, const double*, double*)>("arm_pose")(q.data(), previous, rows[0]);
    return from_rows(rows);
  }
  Isometry3 nominal_pose(const JointVector<N>& q) const {
    double rows[3][4];
    function<void(const double*, double*)>("arm_nominal_pose")(q.data(), rows[0]);
    return from_rows(rows);
  }
  Jacobian<N> jacobian(const JointVector<N>& q, const double* previous) const {
    double rows[6 * N];
    function<void(const double*, const double*, double*)>("arm_jacobian")(q.data(), previous, rows);
    Jacobian<N> out = Jacobian<N>::Zero();
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < joints_; ++j) out(i, j) = rows[i * joints_ + j];
    return out;
  }
  double gate(const JointVector<N>& q) const { return function<double(const double*)>("arm_gate")(q.data()); }
  Correction<N> correct(const Isometry3& target, const JointVector<N>& seed, const double* previous) const {
    double rows[3][4];
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 4; ++j) rows[i][j] = target(i, j);
    Correction<N> out{};
    out.command.setZero();  // C writes the joints that move
    const int status = function<int(const double*, const double*, const double*, double*, double*)>("arm_correct")(
        rows[0], seed.data(), previous, out.command.data(), &out.predicted_error);
    out.status = status == 0 ? IkStatus::converged : status == 1 ? IkStatus::stalled : IkStatus::unreachable;
    return out;
  }
  /// Of a source with `with_rotation_vector` behind it.
  Vector3 rotation_vector(const Matrix3& rotation) const {
    Vector3 out;
    function<void(const double*, double*)>("arm_rotation_vector")(rotation.data(), out.data());
    return out;
  }

 private:
  static Isometry3 from_rows(const double (&rows)[3][4]) {
    Isometry3 out = Isometry3::Identity();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 4; ++j) out(i, j) = rows[i][j];
    return out;
  }
  template <class Function>
  Function* function(const char* name) const {
    return reinterpret_cast<Function*>(dlsym(handle_, name));
  }

  void* handle_ = nullptr;
  int joints_;  ///< of the controller
};

struct Differences {
  double pose = 0, jacobian = 0, command = 0, error = 0;
  Index inside = 0, between = 0, outside = 0;  ///< by the gate
  Index met = 0, statuses = 0, compared = 0;   ///< corrections: met by the library, with another status in C, compared
};

/// Compares an exported arm with the library, in joints of the controller.
template <int N, class Convention>
Differences compare(const CalibratedRobot<N, Convention>& chain, const Compiled<N>& c, Index n, Index corrections) {
  Differences out;
  const auto robot = chain.in_controller_joints();
  const auto& limits = chain.limits();
  const int moving = robot.change().moving();
  const JointRows<N> joints = test_joints(limits, n);
  const auto grow = [](double& largest, double value) { largest = vernier_test::larger(largest, value); };
  for (Index i = 0; i < n; ++i) {
    const JointVector<N> q = configuration(joints, i);
    JointVector<N> previous = configuration(joints, (i + 1) % n);
    if (i % 4 == 1)
      for (int j = 0; j < moving; ++j) previous(j) = q(j) + 0.01;
    if (i % 4 == 2) previous(N / 2) = std::nan("");  // unknown at one joint
    const bool known = i % 4 != 3;
    const auto arm = robot.approached_from(known ? previous : JointVector<N>::Constant(std::nan("")));
    const double* from = known ? previous.data() : nullptr;
    grow(out.pose, difference(c.pose(q, from), arm.pose(q)));
    grow(out.pose, difference(c.nominal_pose(q), robot.nominal().pose(q)));
    Jacobian<N> of_arm = arm.jacobian(q);
    of_arm.rightCols(N - moving).setZero();  // of passive joints
    const RealMatrix jacobian = RealMatrix::of(of_arm);
    grow(out.jacobian, difference(RealMatrix::of(c.jacobian(q, from)), jacobian));
    const double gate = robot.gate(q);
    EXPECT_NEAR(c.gate(q), gate, 1e-14);
    ++(gate == 1 ? out.inside : gate == 0 ? out.outside : out.between);
    if (i >= corrections) continue;

    const Isometry3 target = robot.nominal().pose(q);
    const JointVector<N> nan = JointVector<N>::Constant(std::nan(""));
    const auto& change = robot.change();
    Correction<N> expected = chain.correct(target, change.to_chain(q), known ? change.to_chain(previous) : nan);
    expected.command = change.to_controller(expected.command);
    const Correction<N> found = c.correct(target, q, from);
    out.met += expected.status == IkStatus::converged;
    if (found.status != expected.status) ++out.statuses;
    const double least = jacobian.singular_values()(std::min(6, moving) - 1);
    if (expected.status != IkStatus::converged || least < 0.005) continue;
    const RealMatrix command = RealMatrix::of(expected.command);
    // on its way through half a radian a redundant arm magnifies what roundings move it along its null space
    if (N > 6 && (command - RealMatrix::of(q)).norm() > 0.5) continue;
    ++out.compared;
    grow(out.command, difference(RealMatrix::of(found.command), command));
    grow(out.error, std::abs(found.predicted_error - expected.predicted_error));
  }
  return out;
}

bool have(const char* compiler, const vernier_test::TemporaryFolder& folder) {
  return run_command(std::string("command -v ") + compiler, folder.path()).exit_code == 0;
}

class ExportC : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!have("gcc", folder_)) GTEST_SKIP() << "gcc is not here to compile what is exported";
  }

  template <int N, class Convention>
  void expect_equal(const CalibratedRobot<N, Convention>& robot, Index n = 10000, Index corrections = 10000) {
    const Compiled<N> c(folder_, c_source(robot), robot.controller().joints(N));
    const Differences found = compare(robot, c, n, corrections);
    EXPECT_LT(found.pose, 1e-13);
    EXPECT_LT(found.jacobian, 1e-11);  // slopes of harmonics are multiplied by their orders
    EXPECT_LT(found.command, 1e-9);
    EXPECT_LT(found.error, 1e-9);
    EXPECT_GT(found.met, corrections / 2);
    EXPECT_GT(found.compared, 0.95 * static_cast<double>(found.met));
    EXPECT_EQ(found.statuses, 0);
    if (robot.model().fallback() != nullptr) {
      EXPECT_GT(std::min({found.inside, found.between, found.outside}), n / 20);
    }
  }

  vernier_test::TemporaryFolder folder_{"export_c"};
};

TEST_F(ExportC, OfAGeometryEqualsTheLibrary) {
  const auto robot = robots::abb_irb120();
  expect_equal(geometric(robot.chain, robot.limits));
}

TEST_F(ExportC, OfAllTermsWithGatesAndApproachEqualsTheLibrary) {
  const auto robot = robots::abb_irb120();
  expect_equal(with_everything(robot.chain, robot.limits));
}

// Half a turn at most, whichever diagonal element of the matrix is largest.
TEST_F(ExportC, RotationVectorsAreTheShortest) {
  const auto robot = robots::abb_irb120();
  const Compiled<6> c(folder_, c_source(geometric(robot.chain, robot.limits)) + with_rotation_vector);
  Rng rng(4);
  double worst = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vector3 axis = Vector3(rng.normal(), rng.normal(), rng.normal()).normalized();
    const double angle = rng.uniform(0, std::numbers::pi - 1e-3);
    const Vector3 found = c.rotation_vector(Eigen::AngleAxisd(angle, axis).toRotationMatrix());
    worst = vernier_test::larger(worst, (found - angle * axis).norm());
  }
  EXPECT_LT(worst, 1e-12);
}

TEST_F(ExportC, OfSevenAxesEqualsTheLibrary) {
  const auto robot = robots::barrett_wam();
  expect_equal(with_everything(robot.chain, robot.limits));
}

TEST_F(ExportC, OfAModifiedChainEqualsTheLibrary) {
  const auto robot = robots::puma560_modified();
  expect_equal(with_everything(robot.chain, robot.limits), 10000, 10000);
}

TEST_F(ExportC, OfSlidingJointsEqualsTheLibrary) {
  Rng rng(6);
  const JointLimits<4> limits{JointVector<4>::Constant(-1), JointVector<4>::Constant(1)};
  for (int k = 0; k < 2; ++k)
    expect_equal(with_everything(vernier_test::random_chain<4>(rng, {.prismatic = 0.5}), limits), 10000, 10000);
  expect_equal(with_everything(vernier_test::random_chain<4, ModifiedDh>(rng, {.prismatic = 0.5}), limits), 10000,
               10000);
}

/// An arm whose controller counts its joints differently.
template <int N, class Convention>
CalibratedRobot<N, Convention> counted(const CalibratedRobot<N, Convention>& robot, const ControllerMap& controller,
                                       const JointLimits<N>& limits) {
  return CalibratedRobot<N, Convention>(robot.name(), robot.model(), limits, robot.provenance())
      .with_controller(controller);
}

TEST_F(ExportC, OfControllerJointsEqualsTheLibrary) {
  const auto fanuc = robots::fanuc_r2000ib_165f();
  const MatrixX box = fanuc.controller.chain_limits(fanuc.limits.lower, fanuc.limits.upper);
  const auto robot = with_everything(fanuc.chain, JointLimits<6>{box.col(0), box.col(1)});
  const Compiled<6> c(folder_, c_source(counted(robot, fanuc.controller, fanuc.limits)));
  const Differences found = compare(counted(robot, fanuc.controller, fanuc.limits), c, 4000, 4000);
  EXPECT_LT(found.pose, 1e-12);
  EXPECT_LT(found.jacobian, 1e-10);
  EXPECT_LT(found.command, 1e-9);
  EXPECT_GT(found.compared, 1000);
  EXPECT_EQ(found.statuses, 0);
}

TEST_F(ExportC, OfAPassiveJointEqualsTheLibrary) {
  const DhChain<5> palletiser{
      {{{.a = 0.3, .alpha = -1.5, .d = 0.8}, {.a = 1.2}, {.a = 1.3}, {.a = 0.25, .alpha = 1.5}, {.d = 0.2}}}};
  JointLimits<5> limits;
  limits.lower << -1, 0.3, -1, -1, 0;
  limits.upper << 1, 1, 0.2, 1, 0;
  const std::array<std::string, 5> law{"J1", "J2 + 20 deg", "J3 - J2", "-J3", "J4"};
  const auto robot = counted(geometric(palletiser, limits), ControllerMap(law), limits);
  const std::string source = c_source(robot);
  EXPECT_NE(source.find("#define ARM_JOINTS 4\n"), std::string::npos);
  expect_equal(robot, 4000, 4000);
}

TEST_F(ExportC, OfMotorsThatErrEqualsTheLibrary) {
  const DhChain<5> palletiser{
      {{{.a = 0.3, .alpha = -1.5, .d = 0.8}, {.a = 1.2}, {.a = 1.3}, {.a = 0.25, .alpha = 1.5}, {.d = 0.2}}}};
  JointLimits<5> limits, ranges;
  limits.lower << -1, 0.3, -1, -1, 0;
  limits.upper << 1, 1, 0.2, 1, 0;
  ranges = limits;  // of motors
  ranges.lower(4) = -0.2;
  ranges.upper(4) = 1;
  const std::array<std::string, 5> law{"J1", "J2 + 20 deg", "J3 - J2", "-J3", "J4"};
  const ControllerMap map = ControllerMap(law).with_motor_errors();
  expect_equal(counted(with_everything(palletiser, ranges, map), map, limits), 4000, 4000);
}

TEST_F(ExportC, OfWhatWasLearnedEqualsTheLibrary) {
  const auto robot = robots::abb_irb120();
  const auto errors = with_everything(robot.chain, robot.limits), geometry = geometric(robot.chain, robot.limits);
  expect_equal(with_learned(errors, {}), 10000, 10000);
  for (const RidgeElm& learner : {RidgeElm{.activation = Activation::tanh, .input_map = InputMap::sine_cosine_products},
                                  RidgeElm{.activation = Activation::radial_basis, .input_map = InputMap::raw},
                                  RidgeElm{.activation = Activation::sine, .input_map = InputMap::raw}})
    expect_equal(with_learned(geometry, learner), 10000, 10000);
}

/// Headers of the models that the compilers and sanitizers look at, and a program that calls everything.
class ExportedFiles : public ExportC {
 protected:
  void SetUp() override {
    ExportC::SetUp();
    const auto six = robots::abb_irb120();
    Rng rng(6);
    const JointLimits<4> limits{JointVector<4>::Constant(-1), JointVector<4>::Constant(1)};
    const auto sliding = vernier_test::random_chain<4>(rng, {.prismatic = 0.5});
    const auto simple = geometric(six.chain, {});
    plain_ = c_source(CalibratedRobot<6>("an */ \"arm\" ?\?/ $ \\", simple.model(), {}, simple.provenance()));
    full_ = c_source(with_learned(with_everything(six.chain, six.limits), {.hidden_nodes = 8}));
    sliding_ = c_source(with_everything(sliding, limits));
    write_file(folder_ / "main.c", R"C(
#include "arm.h"
#include <stdio.h>

static double uniform(unsigned *state) {
  *state = *state * 1664525u + 1013904223u;
  return (double)(*state >> 8) / 16777216.0 * 6.6 - 3.3;
}

int main(void) {
  unsigned state = 1;
  double sum = 0;
  int i, k, counts[3] = {0, 0, 0};
  for (i = 0; i < 300; ++i) {
    double q[ARM_JOINTS], previous[ARM_JOINTS], command[ARM_JOINTS], T[12], J[6 * ARM_JOINTS], error;
    const double *from = i % 3 ? previous : 0;
    for (k = 0; k < ARM_JOINTS; ++k) {
      q[k] = uniform(&state);
      previous[k] = uniform(&state);
    }
    arm_pose(q, from, T);
    arm_jacobian(q, from, J);
    arm_nominal_pose(q, T);
    ++counts[arm_correct(T, q, from, command, i % 2 ? &error : 0)];
    sum += arm_gate(q) + T[3] + J[0] + command[0];
  }
  printf("%d met, %d not, %s %s %g\n", counts[ARM_MET], counts[ARM_STALLED] + counts[ARM_LIMITS], ARM_MODEL_HASH,
         ARM_MODEL_DATE, sum);
  return 0;
}
)C");
    write_file(folder_ / "library.c", "#include \"arm.h\"\n");
  }

  vernier_test::CommandResult run(const std::string& command) {
    return run_command("cd '" + folder_.path().string() + "'; " + command, folder_.path());
  }

  std::string plain_, full_, sliding_;
};

TEST_F(ExportedFiles, CompileWithoutAWarningAndNeedTheMathematicalLibraryAlone) {
  std::vector<std::string> left_out;
  for (const char* compiler :
       {"gcc -std=c99", "g++ -std=c++11 -x c++", "clang -std=c99", "clang++ -std=c++11 -x c++"}) {
    const std::string program = std::string(compiler).substr(0, std::string(compiler).find(' '));
    if (!have(program.c_str(), folder_)) {
      left_out.push_back(program);
      continue;
    }
    for (const std::string& source : {plain_, full_}) {
      write_file(folder_ / "arm.h", source);
      const auto included = run(message(compiler, ' ', strict, " -fsyntax-only main.c"));
      EXPECT_EQ(included.exit_code, 0) << compiler << '\n' << included.errors;
      const auto library =
          run(message(compiler, ' ', strict, " -fno-stack-protector -DARM_API= -c library.c -o arm.o"));
      ASSERT_EQ(library.exit_code, 0) << compiler << '\n' << library.errors;
      std::istringstream symbols(run("nm -u arm.o").output);
      const std::set<std::string> known{"atan2", "cos", "exp", "floor", "sin", "sincos", "sqrt", "tanh"};
      for (std::string u, name; symbols >> u >> name;) EXPECT_TRUE(known.contains(name)) << compiler << ": " << name;
      const auto defined = run("nm --defined-only --extern-only arm.o");
      EXPECT_EQ(std::count(defined.output.begin(), defined.output.end(), '\n'), 5) << defined.output;
    }
  }
  if (!left_out.empty()) GTEST_SKIP() << left_out.front() << " is not here; the other compilers were content";
}

TEST_F(ExportedFiles, AreCleanUnderSanitizers) {
  if (run("echo 'int main(void) { return 0; }' >empty.c; gcc -fsanitize=address,undefined empty.c -o empty && ./empty")
          .exit_code != 0)
    GTEST_SKIP() << "gcc has no sanitizers here";
  for (const std::string& source : {full_, sliding_}) {
    write_file(folder_ / "arm.h", source);
    const auto done = run(
        message("gcc -std=c99 -fsanitize=address,undefined -fno-sanitize-recover=all main.c -o main -lm && ./main"));
    EXPECT_EQ(done.exit_code, 0) << done.errors;
    EXPECT_EQ(done.errors, "");
    EXPECT_NE(done.output.find(" met, "), std::string::npos) << done.output;
  }
}

TEST_F(ExportC, StatesWhereItComesFrom) {
  const auto chain = robots::abb_irb120();
  const auto robot = geometric(chain.chain, chain.limits);
  const auto path = folder_ / "m.json";
  save(path, robot);
  const std::string source = c_source(robot, {.held_out_error = 1.25e-4});
  const auto has = [](const std::string& text, const std::string& line) {
    EXPECT_NE(text.find(line), std::string::npos) << line;
  };
  has(source, "#define ARM_MODEL_HASH \"" + sha256(read_file(path)) + "\"\n");
  has(source, "#define ARM_MODEL_DATE \"2024-05-01\"\n");
  has(source, "#define ARM_HELD_OUT_ERROR 0.000125 /* mean [m] */\n");
  has(source, "#define ARM_JOINTS 6\n");
  has(source, " * from:            120 poses of poses.csv\n");
  EXPECT_EQ(c_source(path, {.held_out_error = 1.25e-4}), source);  // the file is the same arm
  has(c_source(robot, {.name = "cell3_Left"}), "\nCELL3_LEFT_API int cell3_Left_correct(");
  EXPECT_EQ(c_source(robot).find("HELD_OUT_ERROR"), std::string::npos);
  has(c_source(robot), " * held-out error:  not stated\n");
  Provenance from = robot.provenance();
  from.held_out_error = 8.5e-5;  // as calibrate knows it
  const CalibratedRobot<6> assessed(robot.name(), robot.model(), robot.limits(), from);
  save(path, assessed);
  for (const std::string& text : {c_source(assessed), c_source(path)}) {
    has(text, "#define ARM_HELD_OUT_ERROR 8.5000000000000006e-05 /* mean [m] */\n");
    has(text, " * held-out error:  0.085 mm in the mean\n");
  }
  has(c_source(assessed, {.held_out_error = 1.25e-4}), "#define ARM_HELD_OUT_ERROR 0.000125 /* mean [m] */\n");

  const CalibratedRobot<6> warm("warm", robot.model().with_thermal({22, 20, 25, VectorX::Constant(42, 1e-5)}),
                                robot.limits(), robot.provenance());
  has(c_source(warm.at_temperature(24.5)), "#define ARM_TEMPERATURE 24.5 /* [deg C] */\n");
  has(c_source(warm), "22 deg C; how the arm changes with it is left out");
}

TEST_F(ExportC, RefusesWhatHasNoSource) {
  const auto chain = robots::abb_irb120();
  const auto robot = geometric(chain.chain, chain.limits);
  const JointRows<6> joints = sample_joints(robot.limits(), 30, 6);
  const KernelPredictor<6, 3> kernels(Kernel::matern_5_2, InputMap::raw,
                                      {VectorX::Constant(6, 0.01), VectorX::Constant(6, 0.9)}, joints,
                                      1e-4 * joints.leftCols<3>(), Vector3(1e-5, 0, -2e-5));
  const auto learned = robot.with_learned(kernels, JointCoverage<6>::covering(joints));
  EXPECT_EQ(
      vernier_test::complaint([&] { c_source(learned); }),
      "c_source: the position error that was learned is a sum of 30 kernels (kernel ELM, Gaussian process), which "
      "is not written as C source; networks are");
  for (const char* name : {"", "3arm", "my arm", "_arm", "arm;", "\xc3\xa4rm"})
    EXPECT_NE(vernier_test::complaint([&] { c_source(robot, {.name = name}); }).find("is no C identifier"),
              std::string::npos)
        << name;
  for (const char* name : {"a", "z", "A", "Z", "a0", "z9", "Arm_09_"})  // the first and last of each kind
    EXPECT_EQ(vernier_test::complaint([&] { c_source(robot, {.name = name}); }), "") << name;
  const CalibratedRobot<6> broken("an arm", robot.model(),
                                  {JointVector<6>::Constant(std::nan("")), robot.limits().upper}, {});
  EXPECT_EQ(vernier_test::complaint([&] { c_source(broken); }), "c_source: a value of the model is nan");
  EXPECT_THROW(c_source(folder_ / "none.json"), std::exception);
}

TEST(CNumbers, AreTheSameDoublesAgain) {
  Rng rng(3);
  for (int i = 0; i < 1000; ++i) {
    const double value = rng.normal() * std::pow(10, rng.uniform(-300, 300));
    EXPECT_EQ(std::stod(detail::c_number(value)), value);
  }
  EXPECT_EQ(detail::c_number(0.1), "0.10000000000000001");
  EXPECT_EQ(detail::c_number(-2), "-2");
}

// C has no arrays of no elements: where no joint has a measured range, the table of ranges is not empty.
TEST(CTables, AreNeverEmpty) {
  using Model = CalibratedRobot<6>::Model;
  const auto robot = robots::abb_irb120();
  const Model::Arm arm(with_geometric_errors(robot.chain, {}, 3));
  JointCoverage<6> coverage;  // of joints that have no effect
  coverage.margin.setConstant(0.1);
  const CalibratedRobot<6> blended("an arm", Model(robot.chain, arm, Model::Arm(robot.chain), coverage), robot.limits,
                                   {});
  const std::string source = c_source(blended);
  EXPECT_NE(source.find("count_[6] = {"), std::string::npos);
  EXPECT_EQ(source.find("[0] = {"), std::string::npos);
}

}  // namespace
}  // namespace vernier::export_c_test
