// Arms as C source: compiled here, equal to the library, and clean for every compiler at hand.
#include "vernier/io/export_c.hpp"

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <array>
#include <nlohmann/json.hpp>

#include "complaint.hpp"
#include "random_chains.hpp"
#include "run_command.hpp"
#include "temporary_folder.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/sha256.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/regression/ridge_elm.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::export_c_test {
namespace {

using testing_support::run_command;

constexpr const char* strict = "-pedantic -Wall -Wextra -Werror -O2";

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
JointErrors joint_errors(const DhChain<N, Convention>& chain, bool few) {
  JointTerms terms(N);
  terms.gravity.emplace(chain, Vector3(0, 0.6, -0.8));
  terms.hysteresis = {0.01, 0.3};
  if (!few) {
    terms.gear_ratio = terms.coupling = true;
    terms.linear_ranges = std::vector<JointRange>(N, {-0.8, 0.6});
    terms.tilt.emplace(chain, Vector3(0.6, 0, -0.8));
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
  return {terms, coefficients};
}

/// An arm with everything; the measured ranges of every joint end in the middle of its limits, some are periodic.
template <int N, class Convention>
CalibratedRobot<N, Convention> with_everything(const DhChain<N, Convention>& chain, const JointLimits<N>& limits) {
  using Model = typename CalibratedRobot<N, Convention>::Model;
  JointCoverage<N> coverage;
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
  const typename Model::Arm inside({arm.chain(), joint_errors(chain, false)}, tracker, probe);
  const typename Model::Arm outside({chain, joint_errors(chain, true)}, frame(2.21, -1.4, 0.35, 0.1, -0.7, 2.01), probe);
  return robot.with_model(Model(chain, inside, outside, coverage), robot.provenance());
}

/// With a ridge ELM that learned a function of the joints.
template <int N, class Convention>
CalibratedRobot<N, Convention> with_learned(const CalibratedRobot<N, Convention>& robot, const RidgeElm& learner) {
  const JointRows<N> joints = sample_joints(robot.limits(), 200, 8);
  const PointRows errors = 1e-3 * joints.template leftCols<3>().array().sin();
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

/// The functions of an exported arm, compiled.
template <int N>
class Compiled {
 public:
  Compiled(const testing_support::TemporaryFolder& folder, const std::string& source) {
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
    double rows[12];
    function<void(const double*, const double*, double*)>("arm_pose")(q.data(), previous, rows);
    return from_rows(rows);
  }
  Isometry3 nominal_pose(const JointVector<N>& q) const {
    double rows[12];
    function<void(const double*, double*)>("arm_nominal_pose")(q.data(), rows);
    return from_rows(rows);
  }
  Jacobian<N> jacobian(const JointVector<N>& q, const double* previous) const {
    Eigen::Matrix<double, 6, N, Eigen::RowMajor> out;
    function<void(const double*, const double*, double*)>("arm_jacobian")(q.data(), previous, out.data());
    return out;
  }
  double gate(const JointVector<N>& q) const { return function<double(const double*)>("arm_gate")(q.data()); }
  Correction<N> correct(const Isometry3& target, const JointVector<N>& seed, const double* previous) const {
    Eigen::Matrix<double, 3, 4, Eigen::RowMajor> rows = target.matrix().template topRows<3>();
    Correction<N> out{};
    const int status = function<int(const double*, const double*, const double*, double*, double*)>("arm_correct")(
        rows.data(), seed.data(), previous, out.command.data(), &out.predicted_error);
    out.status = status == 0 ? IkStatus::converged : status == 1 ? IkStatus::stalled : IkStatus::unreachable;
    return out;
  }

 private:
  static Isometry3 from_rows(const double* rows) {
    Isometry3 out = Isometry3::Identity();
    out.matrix().topRows<3>() = Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(rows);
    return out;
  }
  template <class Function>
  Function* function(const char* name) const {
    return reinterpret_cast<Function*>(dlsym(handle_, name));
  }

  void* handle_ = nullptr;
};

struct Differences {
  double pose = 0, jacobian = 0, command = 0, error = 0;
  Index inside = 0, between = 0, outside = 0;  ///< by the gate
  Index met = 0, other = 0, statuses = 0;      ///< corrections: met by the library, not met, with another status in C
};

/// Compares an exported arm with the library.
template <int N, class Convention>
Differences compare(const CalibratedRobot<N, Convention>& robot, const Compiled<N>& c, Index n, Index corrections) {
  Differences out;
  const JointRows<N> joints = test_joints(robot.limits(), n);
  const auto grow = [](double& largest, double value) { largest = std::max(largest, value); };
  for (Index i = 0; i < n; ++i) {
    const JointVector<N> q = joints.row(i).transpose();
    JointVector<N> previous = joints.row((i + 1) % n).transpose();
    if (i % 4 == 1) previous = q.array() + 0.01;
    if (i % 4 == 2) previous(N / 2) = std::nan("");  // unknown at one joint
    const bool known = i % 4 != 3;
    const auto arm = robot.approached_from(known ? previous : JointVector<N>::Constant(std::nan("")));
    const double* from = known ? previous.data() : nullptr;
    grow(out.pose, (c.pose(q, from).matrix() - arm.pose(q).matrix()).cwiseAbs().maxCoeff());
    grow(out.pose, (c.nominal_pose(q).matrix() - robot.nominal().pose(q).matrix()).cwiseAbs().maxCoeff());
    const Jacobian<N> jacobian = arm.jacobian(q);
    grow(out.jacobian, (c.jacobian(q, from) - jacobian).cwiseAbs().maxCoeff());
    const double gate = robot.gate(q);
    EXPECT_NEAR(c.gate(q), gate, 1e-14);
    ++(gate == 1 ? out.inside : gate == 0 ? out.outside : out.between);
    if (i >= corrections) continue;

    const Isometry3 target = robot.nominal().pose(q);
    const JointVector<N> nan = JointVector<N>::Constant(std::nan(""));
    const Correction<N> expected = robot.correct(target, q, known ? previous : nan);
    const Correction<N> found = c.correct(target, q, from);
    ++(expected.status == IkStatus::converged ? out.met : out.other);
    if (found.status != expected.status) ++out.statuses;
    const double least = jacobian.jacobiSvd().singularValues().minCoeff();
    if (expected.status != IkStatus::converged || least < 0.02) continue;
    grow(out.command, (found.command - expected.command).cwiseAbs().maxCoeff());
    grow(out.error, std::abs(found.predicted_error - expected.predicted_error));
  }
  return out;
}

bool have(const char* compiler, const testing_support::TemporaryFolder& folder) {
  return run_command(std::string("command -v ") + compiler, folder.path()).exit_code == 0;
}

class ExportC : public testing::Test {
 protected:
  void SetUp() override {
    if (!have("gcc", folder_)) GTEST_SKIP() << "gcc is not here to compile what is exported";
  }

  template <int N, class Convention>
  Differences expect_equal(const CalibratedRobot<N, Convention>& robot, Index n = 10000, Index corrections = 2000) {
    const Compiled<N> c(folder_, c_source(robot));
    const Differences found = compare(robot, c, n, corrections);
    EXPECT_LT(found.pose, 1e-13);
    EXPECT_LT(found.jacobian, 1e-11);  // slopes of harmonics are multiplied by their orders
    EXPECT_LT(found.command, 1e-9);
    EXPECT_LT(found.error, 1e-9);
    EXPECT_GT(found.met, corrections / 2);
    EXPECT_EQ(found.statuses, 0);
    if (robot.model().fallback() != nullptr) {
      EXPECT_GT(std::min({found.inside, found.between, found.outside}), n / 20);
    }
    std::printf("pose %.1e jacobian %.1e command %.1e gates %d %d %d met %d other %d statuses %d\n", found.pose,
                found.jacobian, found.command, int(found.inside), int(found.between), int(found.outside),
                int(found.met), int(found.other), int(found.statuses));
    return found;
  }

  testing_support::TemporaryFolder folder_{"export_c"};
};

TEST_F(ExportC, OfAGeometryEqualsTheLibrary) {
  const auto robot = robots::abb_irb120();
  expect_equal(geometric(robot.chain, robot.limits));
}

TEST_F(ExportC, OfAllTermsWithGatesAndApproachEqualsTheLibrary) {
  const auto robot = robots::abb_irb120();
  expect_equal(with_everything(robot.chain, robot.limits));
}

TEST_F(ExportC, OfSevenAxesEqualsTheLibrary) {
  const auto robot = robots::barrett_wam();
  expect_equal(with_everything(robot.chain, robot.limits));
}

TEST_F(ExportC, OfAModifiedChainEqualsTheLibrary) {
  const auto robot = robots::puma560_modified();
  expect_equal(with_everything(robot.chain, robot.limits), 2000, 500);
}

TEST_F(ExportC, OfSlidingJointsEqualsTheLibrary) {
  Rng rng(6);
  const JointLimits<4> limits{JointVector<4>::Constant(-1), JointVector<4>::Constant(1)};
  for (int k = 0; k < 2; ++k)
    expect_equal(with_everything(vernier_test::random_chain<4>(rng, {.prismatic = 0.5}), limits), 2000, 500);
  expect_equal(with_everything(vernier_test::random_chain<4, ModifiedDh>(rng, {.prismatic = 0.5}), limits), 2000, 500);
}

TEST_F(ExportC, OfWhatWasLearnedEqualsTheLibrary) {
  const auto robot = robots::abb_irb120();
  const auto errors = with_everything(robot.chain, robot.limits), geometry = geometric(robot.chain, robot.limits);
  expect_equal(with_learned(errors, {}), 10000, 500);
  for (const RidgeElm& learner : {RidgeElm{.activation = Activation::tanh, .input_map = InputMap::sine_cosine_products},
                                  RidgeElm{.activation = Activation::radial_basis, .input_map = InputMap::raw},
                                  RidgeElm{.activation = Activation::sine, .input_map = InputMap::raw}})
    expect_equal(with_learned(geometry, learner), 2000, 200);
}

}  // namespace
}  // namespace vernier::export_c_test
