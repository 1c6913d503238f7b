// SPDX-License-Identifier: BSD-3-Clause
// A measured arm: a Panda that touched six bars of two sockets. Every bar is a test of what the others say.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include "contact_consistency.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/identification/identify_by_contacts.hpp"
#include "vernier/urdf/urdf_chain.hpp"

namespace vernier::panda_contacts_test {
namespace {

using Panda = Framed<DhChain<7>>;

class PandaContacts : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("VERNIER_DATA_DIR");
    if (folder == nullptr) GTEST_SKIP() << "VERNIER_DATA_DIR is not set";
    const std::string at = folder;
    arm_.emplace(read_urdf(at + "/panda_ball.urdf", "", "ball_link").robot.arm<7>().arm);
    bars_ = read_contacts(at + "/panda_contacts.csv", 7, arm_->chain().joint_types());
    ASSERT_EQ(bars_.size(), 6u);
  }
  auto identified(const std::vector<Contact>& contacts) const {
    return identify_by_contacts(*arm_, contacts, {.frames = Frames::tool}, {.loss = Loss::huber});
  }

  std::optional<Panda> arm_{};
  std::vector<Contact> bars_{};
};

/// How touches of a bar scatter about its two sockets, and how far these are apart.
struct Scatter {
  double squares = 0;  ///< [m^2]
  Index touches = 0;
  double length_error = 0;  ///< of the known distance of the sockets [m]
};
template <class Arm>
Scatter scatter_of(const Arm& arm, const Contact& bar) {
  Scatter out;
  const double length = bar.known().maxCoeff();
  Vector3 centre[2] = {Vector3::Zero(), Vector3::Zero()};
  for (int socket = 0; socket < 2; ++socket) {
    std::vector<Vector3> points;
    for (Index i = 0; i < bar.size(); ++i)
      if ((bar.known()(i) > length / 2) == (socket == 1))
        points.push_back(arm.position(JointVector<7>(bar.joints().row(i).transpose())));
    for (const Vector3& point : points) centre[socket] += point / static_cast<double>(points.size());
    for (const Vector3& point : points) out.squares += (point - centre[socket]).squaredNorm();
    out.touches += static_cast<Index>(points.size());
  }
  out.length_error = std::abs((centre[1] - centre[0]).norm() - length);
  return out;
}

TEST_F(PandaContacts, OtherBarsSayWhereTheSocketsAre) {
  double squares = 0, nominal_squares = 0, touches = 0, length_error = 0;
  for (std::size_t k = 0; k < bars_.size(); ++k) {
    std::vector<Contact> others = bars_;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
    const Scatter left_out = scatter_of(identified(others).model, bars_[k]);
    squares += left_out.squares;
    nominal_squares += scatter_of(*arm_, bars_[k]).squares;
    touches += static_cast<double>(left_out.touches);
    length_error += left_out.length_error / 6;
  }
  EXPECT_GT(std::sqrt(nominal_squares / touches), 3e-3);
  EXPECT_LT(std::sqrt(squares / touches), 0.215e-3);
  EXPECT_LT(length_error, 0.045e-3);
}

TEST_F(PandaContacts, OneBarAloneSaysAlmostAsMuch) {
  double squares = 0, touches = 0;
  for (std::size_t k = 0; k < bars_.size(); ++k) {
    const auto found = identified({bars_[k]});
    for (std::size_t other = 0; other < bars_.size(); ++other) {
      if (other == k) continue;
      const Scatter at_other = scatter_of(found.model, bars_[other]);
      squares += at_other.squares;
      touches += static_cast<double>(at_other.touches);
    }
  }
  EXPECT_LT(std::sqrt(squares / touches), 0.25e-3);
}

// All 15 pairs: estimates from one bar against those from another.
TEST_F(PandaContacts, BarsDifferByWhatTheirStandardDeviationsSay) {
  std::vector<ContactReport> found;
  for (const Contact& bar : bars_) found.push_back(identified({bar}));
  vernier_test::NormalisedSquares differences;
  for (std::size_t a = 0; a < found.size(); ++a)
    for (std::size_t b = a + 1; b < found.size(); ++b) {
      ASSERT_EQ(found[a].free, found[b].free);
      const auto n = static_cast<Index>(found[a].free.size());
      VectorX difference(n), prior(n);
      for (Index i = 0; i < n; ++i) {
        const auto k = static_cast<std::size_t>(found[a].free[static_cast<std::size_t>(i)]);
        difference(i) = found[a].parameters[k].identified - found[b].parameters[k].identified;
        const double smaller =
            std::min(vernier_test::prior_of(found[a].parameters[k]), vernier_test::prior_of(found[b].parameters[k]));
        prior(i) = std::sqrt(2.0) * smaller;
      }
      add_differences(difference, found[a].covariance + found[b].covariance, prior, differences);
    }
  EXPECT_GT(differences.count, 150);
  EXPECT_GT(differences.rms(), 0.8);
  EXPECT_LT(differences.rms(), 1.2);
}

}  // namespace
}  // namespace vernier::panda_contacts_test
