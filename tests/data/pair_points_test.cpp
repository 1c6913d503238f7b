// SPDX-License-Identifier: BSD-3-Clause
// Points paired with poses: planted faults in simulated and measured sets, and independent accounts of both parts.

#include "vernier/data/pair_points.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <ostream>
#include <string>

#include "complaint.hpp"
#include "real_matrix.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/data/detail/pair_search.hpp"
#include "vernier/data/detail/point_alignment.hpp"
#include "vernier/identification/frames.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::pair_points_test {
namespace {

using Kind = PairingFault::Kind;

/// Poses of a nominal arm, and the points of an actual one; `source` says which pose each point belongs to.
struct Session {
  std::vector<Isometry3> flanges;
  PointRows points;
  std::vector<Index> source;

  static Session simulate(Index n, std::uint64_t seed) {
    const auto robot = robots::ur10();
    const auto actual = with_geometric_errors(robot.chain, {}, child_seed(seed, 0));
    const JointRows<6> joints = sample_joints(robot.limits, n, child_seed(seed, 1));
    Rng rng(child_seed(seed, 2));
    const auto vector = [&](double size) {
      return Vector3(rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-size, size));
    };
    const Vector3 turn = vector(2), shift = vector(3), offset = vector(0.2);
    const Isometry3 base = rigid_motion(exp_so3(turn), shift);
    Session out{{}, PointRows(n, 3), {}};
    for (Index i = 0; i < n; ++i) {
      const JointVector<6> q = configuration(joints, i);
      out.flanges.push_back(robot.chain.pose(q));
      const Vector3 noise(rng.normal(), rng.normal(), rng.normal());
      set_point(out.points, i, transformed(base, transformed(actual.pose(q), offset)) + 3e-5 * noise);
      out.source.push_back(i);
    }
    return out;
  }

  void reorder(const std::vector<Index>& order) {
    PointRows points_before = points;
    std::vector<Index> source_before = source;
    points.resize(static_cast<Index>(order.size()), 3);
    source.clear();
    for (std::size_t k = 0; k < order.size(); ++k) {
      set_point(points, static_cast<Index>(k), point(points_before, order[k]));
      source.push_back(source_before[static_cast<std::size_t>(order[k])]);
    }
  }
};

/// One planted fault, at a pose.
struct Planted {
  Kind kind;
  Index row;
};

/// Faults of one kind, or of all kinds, at poses that are at least three apart.
std::vector<Planted> plant(Session& session, int count, int kind, Rng& rng) {
  const auto n = static_cast<Index>(session.flanges.size());
  std::vector<Planted> planted;
  while (static_cast<int>(planted.size()) < count) {
    const auto row = static_cast<Index>(rng.below(static_cast<std::uint64_t>(n - 1)));
    bool apart = true;
    for (const Planted& one : planted) apart = apart && std::abs(one.row - row) >= 3;
    constexpr std::array kinds{Kind::missing, Kind::additional, Kind::swapped, Kind::misfit};
    if (apart) planted.push_back({kinds[kind < 0 ? rng.below(4) : static_cast<std::uint64_t>(kind)], row});
  }
  std::vector<Index> order;
  for (Index i = 0; i < n; ++i) {
    const Planted* here = nullptr;
    for (const Planted& one : planted)
      if (one.row == i) here = &one;
    if (here == nullptr) {
      order.push_back(i);
    } else if (here->kind == Kind::additional) {  // measured twice
      order.insert(order.end(), {i, i});
    } else if (here->kind == Kind::swapped) {
      order.insert(order.end(), {i + 1, i});
      ++i;
    } else if (here->kind == Kind::misfit) {
      order.push_back(i);
      set_point(session.points, i, point(session.points, i) + Vector3(0.04, 0.04, -0.02));
      session.source[static_cast<std::size_t>(i)] = -1;
    }
  }
  session.reorder(order);
  return planted;
}

/// Whether a finding names a planted fault, in row and point.
bool names(const PairingFault& fault, const Planted& planted, const Session& session) {
  if (fault.kind != planted.kind) return false;
  const auto source = [&](Index point) { return session.source[static_cast<std::size_t>(point)]; };
  switch (fault.kind) {
    case Kind::missing: return fault.count == 1 && fault.rows.size() == 1 && fault.rows.first == planted.row;
    case Kind::additional:  // either of both measurements
      return fault.count == 1 && fault.points.size() == 2 && source(fault.points.first) == planted.row &&
             source(fault.points.last) == planted.row;
    case Kind::swapped:
      return fault.rows.first == planted.row && fault.rows.last == planted.row + 1 &&
             source(fault.points.first) == planted.row && source(fault.points.last) == planted.row + 1;
    default:
      return fault.rows.first == planted.row && source(fault.points.first) == -1 &&
             std::abs(fault.distance - 0.06) < 0.02;
  }
}

void expect_right_pairs(const Pairing& found, const Session& session) {
  for (const PointPair& pair : found.pairs) ASSERT_EQ(session.source[static_cast<std::size_t>(pair.point)], pair.row);
}

struct Trial {
  Index poses;
  int faults, kind, sets;

  friend void PrintTo(const Trial& trial, std::ostream* out) {
    *out << trial.sets << " sets of " << trial.poses << " poses, " << trial.faults << " faults of kind " << trial.kind;
  }
};

class PlantedFaults : public ::testing::TestWithParam<Trial> {};

// Every planted fault of every set is found and named, nothing else is, and every pair is right. The arm's errors are
// 4 mm (median), a misplaced point is 60 mm off.
TEST_P(PlantedFaults, AreFoundAndNamed) {
  const Trial trial = GetParam();
  int named = 0;
  for (int set = 0; set < trial.sets; ++set) {
    const std::uint64_t seed = child_seed(17, static_cast<std::uint64_t>(set));
    Session session = Session::simulate(trial.poses, seed);
    Rng rng(child_seed(seed, 3));
    const std::vector<Planted> planted = plant(session, trial.faults, trial.kind, rng);
    const Pairing found = pair_by_order(session.flanges, session.points);
    ASSERT_EQ(found.proof->status, PairingStatus::proven) << "set " << set;
    EXPECT_EQ(found.faults.size(), planted.size()) << "set " << set;
    for (const Planted& one : planted)
      for (const PairingFault& fault : found.faults) named += names(fault, one, session);
    expect_right_pairs(found, session);
    EXPECT_LT(found.proof->limit, 0.03);
  }
  EXPECT_EQ(named, trial.faults * trial.sets);
  RecordProperty("named", named);
}

INSTANTIATE_TEST_SUITE_P(OneKind, PlantedFaults,
                         testing::Values(Trial{60, 3, 0, 10}, Trial{60, 3, 1, 10}, Trial{60, 3, 2, 10},
                                         Trial{60, 3, 3, 10}));
INSTANTIATE_TEST_SUITE_P(AllKinds, PlantedFaults,
                         testing::Values(Trial{20, 1, -1, 20}, Trial{60, 4, -1, 10}, Trial{200, 20, -1, 3},
                                         Trial{1000, 30, -1, 1}));

// The files begin and end elsewhere, rows follow each other that both lack, and a point is far from its place.
TEST(PairPoints, ShiftedFilesRunsAndAMovedPoint) {
  Session session = Session::simulate(60, 5);
  std::vector<Index> order;
  for (Index i = 4; i < 57; ++i)
    if (i < 20 || i > 22) order.push_back(i);
  order.insert(order.begin() + 40, 10);  // also in its own place
  order.erase(order.begin() + 6);        // and now no longer
  session.reorder(order);
  const Pairing found = pair_by_order(session.flanges, session.points);
  ASSERT_EQ(found.proof->status, PairingStatus::proven);
  expect_right_pairs(found, session);
  EXPECT_EQ(found.pairs.size(), 50u);
  ASSERT_EQ(found.faults.size(), 4u);
  EXPECT_EQ(found.faults[0].kind, Kind::missing);
  EXPECT_EQ(found.faults[0].count, 4);
  EXPECT_EQ(found.faults[0].rows.last, 3);
  EXPECT_EQ(found.faults[0].points.first, -1);
  EXPECT_EQ(found.faults[1].kind, Kind::out_of_order);
  EXPECT_EQ(found.faults[1].rows.first, 10);
  EXPECT_EQ(session.source[static_cast<std::size_t>(found.faults[1].points.first)], 10);
  EXPECT_EQ(found.faults[2].rows.first, 20);
  EXPECT_EQ(found.faults[2].count, 3);
  EXPECT_EQ(found.faults[3].rows.first, 57);
  EXPECT_EQ(found.faults[3].points.last, 50);
}

TEST(PairPoints, DistantPointsSwapped) {
  Session session = Session::simulate(40, 6);
  std::vector<Index> order(40);
  for (Index i = 0; i < 40; ++i) order[static_cast<std::size_t>(i)] = i;
  std::swap(order[7], order[31]);
  session.reorder(order);
  const Pairing found = pair_by_order(session.flanges, session.points);
  EXPECT_EQ(found.pairs.size(), 40u);
  expect_right_pairs(found, session);
  ASSERT_EQ(found.faults.size(), 1u);
  EXPECT_EQ(found.faults[0].kind, Kind::swapped);
  EXPECT_EQ(found.faults[0].rows.first, 7);
  EXPECT_EQ(found.faults[0].rows.last, 31);
}

PointRows times(double factor, PointRows points) {
  for (Index i = 0; i < points.rows(); ++i)
    for (int k = 0; k < 3; ++k) points(i, k) *= factor;
  return points;
}

TEST(PairPoints, UnitsAndHandedness) {
  const Session session = Session::simulate(40, 7);
  for (const double factor : {1000.0, 25.4, 39.37007874, 0.001, 100.0, 0.1, 304.8, 1e6}) {
    const Pairing found = pair_by_order(session.flanges, times(factor, session.points));
    EXPECT_EQ(found.proof->status, PairingStatus::wrong_unit) << factor;
    EXPECT_NEAR(found.proof->scale / factor, 1, 0.01) << factor;
    EXPECT_GT(found.proof->spread_ratio, factor / 2);
    EXPECT_LT(found.proof->spread_ratio, factor * 2);
    EXPECT_TRUE(found.pairs.empty());
    EXPECT_NE(describe(*found.proof).find("wrong unit"), std::string::npos);
  }
  PointRows exchanged = session.points, reflected = session.points;
  for (Index i = 0; i < exchanged.rows(); ++i) {
    std::swap(exchanged(i, 0), exchanged(i, 1));
    reflected(i, 2) *= -1;
  }
  for (const PointRows& points : {exchanged, reflected}) {
    const Pairing found = pair_by_order(session.flanges, points);
    EXPECT_EQ(found.proof->status, PairingStatus::mirrored);
    EXPECT_TRUE(found.pairs.empty());
    EXPECT_NE(describe(*found.proof).find("left-handed"), std::string::npos);
  }
  const Pairing right = pair_by_order(session.flanges, session.points);
  EXPECT_EQ(right.proof->status, PairingStatus::proven);
  EXPECT_EQ(describe(*right.proof), "");
  EXPECT_NEAR(right.proof->scale, 1, 0.01);
}

TEST(PairPoints, WhatCannotBeProven) {
  const Session session = Session::simulate(40, 8), other = Session::simulate(40, 9);
  EXPECT_EQ(pair_by_order(session.flanges, other.points).proof->status, PairingStatus::unrelated);
  Rng rng(1);
  Session shuffled = session;
  shuffled.reorder(rng.permutation(40));
  EXPECT_EQ(pair_by_order(shuffled.flanges, shuffled.points).proof->status, PairingStatus::unrelated);
  EXPECT_EQ(pair_by_order(std::span(session.flanges).first(5), session.points).proof->status, PairingStatus::too_few);
  EXPECT_EQ(pair_by_order(session.flanges, PointRows::Zero(40, 3)).proof->status, PairingStatus::unrelated);
  // equal steps along a line with one orientation: shifted by a row, the base moves by a step
  std::vector<Isometry3> line(20, Isometry3::Identity());
  PointRows points(19, 3);
  for (Index i = 0; i < 20; ++i) line[static_cast<std::size_t>(i)](0, 3) = 0.05 * static_cast<double>(i);
  for (Isometry3& pose : line) pose(1, 3) = 1;
  for (Index i = 0; i < 19; ++i) set_point(points, i, Vector3(0.3, 0.05 * static_cast<double>(i), 2));
  EXPECT_EQ(pair_by_order(line, points).proof->status, PairingStatus::ambiguous);
  EXPECT_EQ(vernier_test::complaint([] { (void)pair_by_order(std::vector<Isometry3>(20000), PointRows(20000, 3)); }),
            "pair_by_order: 20000 rows and 20000 points are too many: pair them by name");
}

// Poses that are visited several times in a row cannot be told apart: the report says so.
TEST(PairPoints, RepeatedVisits) {
  Session session = Session::simulate(90, 10);
  for (Index i = 0; i < 90; ++i) {
    session.flanges[static_cast<std::size_t>(i)] = session.flanges[static_cast<std::size_t>(i - i % 3)];
    set_point(session.points, i, point(session.points, i - i % 3));
  }
  std::vector<Index> order;
  for (Index i = 0; i < 90; ++i)
    if (i != 31) order.push_back(i);
  session.reorder(order);
  const Pairing found = pair_by_order(session.flanges, session.points);
  ASSERT_EQ(found.proof->status, PairingStatus::proven);
  EXPECT_GE(found.proof->indistinct, 60);
  ASSERT_EQ(found.faults.size(), 1u);
  EXPECT_EQ(found.faults[0].kind, Kind::missing);
  EXPECT_EQ(found.faults[0].count, 1);
  EXPECT_EQ(found.faults[0].rows.first, 30);
  EXPECT_EQ(found.faults[0].rows.last, 32);
}

CsvText named_rows(const std::vector<std::string>& names) {
  CsvText out{"joints.csv", {"target", "q1_rad"}, {}, {}};
  for (const std::string& name : names) {
    out.rows.push_back({name, "0"});
    out.lines.push_back(static_cast<Index>(out.rows.size()) + 1);
  }
  return out;
}

PointTable named_points(const std::vector<std::string>& names) {
  PointTable out{"points.txt", names, {}, PointRows::Zero(static_cast<Index>(names.size()), 3)};
  for (std::size_t i = 0; i < names.size(); ++i) out.lines.push_back(static_cast<Index>(i) + 3);
  return out;
}

TEST(PairPoints, ByName) {
  const CsvText rows = named_rows({"b", "a", "d"});
  const PointTable points = named_points({"reference", "a", "b"});
  const Pairing found = pair_by_name(rows, "target", points);
  EXPECT_EQ(found.pairs, (std::vector<PointPair>{{0, 2}, {1, 1}}));
  ASSERT_EQ(found.faults.size(), 1u);
  EXPECT_EQ(describe(found.faults[0], rows, points), "joints.csv, line 4: no point in points.txt");
  EXPECT_FALSE(found.proof);
  const auto refused = [&](const CsvText& r, const std::string& key, const PointTable& p) {
    return vernier_test::complaint([&] { (void)pair_by_name(r, key, p); });
  };
  EXPECT_EQ(refused(rows, "name", points), "joints.csv: no column name in the header");
  EXPECT_EQ(refused(rows, "target", {"points.txt", {}, {}, {}}), "points.txt: no column name is declared");
  EXPECT_EQ(refused(named_rows({"a", "b", "a"}), "target", points),
            "joints.csv, line 4, column target: 'a' is in line 2 already");
  EXPECT_EQ(refused(rows, "target", named_points({"x", "y", "y"})),
            "points.txt, line 5, column name: 'y' is in line 4 already");
}

// Names are checked with the arm: two exchanged ones are put right, a wrong point is taken out, as are unit and frame.
TEST(PairPoints, NamesAreChecked) {
  Session session = Session::simulate(40, 11);
  session.points(5, 0) += 0.1;
  for (int k = 0; k < 3; ++k) std::swap(session.points(12, k), session.points(30, k));
  Pairing named;
  for (Index i = 0; i < 40; ++i)
    if (i != 20) named.pairs.push_back({i, i});
  named.faults.push_back({Kind::missing, {20, 20}, {}, 1});
  const Pairing found = check_pairs(named, session.flanges, session.points);
  ASSERT_EQ(found.proof->status, PairingStatus::proven);
  EXPECT_EQ(found.pairs.size(), 38u);
  ASSERT_EQ(found.faults.size(), 3u);
  EXPECT_EQ(found.faults[0].kind, Kind::misfit);
  EXPECT_EQ(found.faults[0].points.first, 5);
  EXPECT_EQ(found.faults[1].kind, Kind::swapped);
  EXPECT_EQ(found.faults[1].rows.first, 12);
  EXPECT_EQ(found.faults[1].points.first, 30);
  EXPECT_EQ(found.faults[2].kind, Kind::missing);
  for (const PointPair& pair : found.pairs) EXPECT_EQ(pair.point, pair.row == 12 ? 30 : pair.row == 30 ? 12 : pair.row);
  EXPECT_EQ(check_pairs(named, session.flanges, times(1 / 25.4, session.points)).proof->status,
            PairingStatus::wrong_unit);
  EXPECT_EQ(check_pairs(named, session.flanges, times(-1, session.points)).proof->status, PairingStatus::mirrored);
  EXPECT_EQ(vernier_test::complaint([&] {
              (void)check_pairs({{{40, 0}}, {}, {}}, session.flanges, session.points);
            }),
            "check_pairs: row 40 of 40, point 0 of 40");
}

TEST(PairPoints, FaultsInSentences) {
  const CsvText rows = named_rows({"a", "b", "c", "d"});
  const PointTable points = named_points({"a", "b", "c", "d"});
  const auto text = [&](const PairingFault& fault) { return describe(fault, rows, points); };
  EXPECT_EQ(text({Kind::missing, {1, 1}, {0, 1}, 1}),
            "joints.csv, line 3: no point in points.txt, expected between lines 3 and 4");
  EXPECT_EQ(text({Kind::missing, {0, 1}, {-1, 0}, 2}),
            "joints.csv, lines 2 to 3: no point in points.txt, expected before line 3");
  EXPECT_EQ(text({Kind::missing, {2, 3}, {3, 4}, 1}),
            "joints.csv, 1 of lines 4 to 5: no point in points.txt, expected after line 6");
  EXPECT_EQ(text({Kind::additional, {1, 2}, {2, 2}, 1}),
            "points.txt, line 5: no pose in joints.csv, expected between lines 3 and 4");
  EXPECT_EQ(text({Kind::swapped, {1, 2}, {2, 1}, 2}),
            "points.txt, lines 4 and 5: swapped; line 5 belongs to line 3 of joints.csv, line 4 to line 4");
  EXPECT_EQ(text({Kind::out_of_order, {3, 3}, {0, 0}, 1}),
            "points.txt, line 3: in the wrong place; belongs to line 5 of joints.csv");
  EXPECT_EQ(text({Kind::misfit, {3, 3}, {0, 0}, 1, 0.0314}),
            "points.txt, line 3: 31.4 mm from where the arm was in line 5 of joints.csv");
}

// Where the frames are, by the alternating estimate that starts an identification.
TEST(PointAlignment, FramesAgreeWithStartingFrames) {
  const auto chain = robots::ur10().chain;
  const Session session = Session::simulate(30, 12);
  const JointRows<6> joints = sample_joints(robots::ur10().limits, 30, child_seed(12, 1));
  std::vector<PointPair> pairs;
  for (Index i = 0; i < 30; ++i) pairs.push_back({i, i});
  const detail::PointFrames found = detail::fit_point_frames(session.flanges, session.points, pairs);
  const auto expected = starting_frames(chain, Dataset<6>(joints, session.points), true, true);
  EXPECT_LT((vernier_test::RealMatrix(found.base) - expected.base()).norm(), 1e-4);
  EXPECT_LT((found.offset - translation(expected.tool())).norm(), 1e-4);
  const auto squares = [&](const detail::PointFrames& frames) {
    double sum = 0;
    for (Index i = 0; i < 30; ++i)
      sum += (point(session.points, i) - frames.point(session.flanges[static_cast<std::size_t>(i)])).squaredNorm();
    return sum;
  };
  const double sum = squares(found);
  EXPECT_NEAR(found.rms, std::sqrt(sum / 27), 1e-12);
  // the smallest sum of squares: no small change of the nine unknowns reduces it
  for (int k = 0; k < 9; ++k)
    for (const double step : {1e-4, -1e-4}) {
      Vector3 turn = Vector3::Zero(), shift = turn, offset = turn;
      (k < 3 ? turn : k < 6 ? shift : offset)(k % 3) = step;
      detail::PointFrames other = found;
      other.base = rigid_motion(exp_so3(turn) * rotation(found.base), translation(found.base) + shift);
      other.offset += offset;
      EXPECT_GT(squares(other), sum);
    }
}

TEST(PointAlignment, OneOrientationOrOnePlaneOfPoints) {
  Session session = Session::simulate(20, 13);
  std::vector<PointPair> pairs;
  Rng rng(2);
  const Isometry3 base = rigid_motion(exp_so3(Vector3(1, -2, 0.5)), Vector3(1, 2, 3));
  for (Index i = 0; i < 20; ++i) {
    pairs.push_back({i, i});
    Isometry3& flange = session.flanges[static_cast<std::size_t>(i)];
    flange = rigid_motion(rotation(session.flanges[0]), Vector3(rng.uniform(-1, 1), rng.uniform(-1, 1), 0.3));
    set_point(session.points, i, transformed(base, translation(flange)));
  }
  EXPECT_LT(detail::fit_point_frames(session.flanges, session.points, pairs).rms, 1e-9);
}

double cost_of(const std::vector<PointPair>& pairs, const MatrixX& costs) {
  double out = 0.5 * static_cast<double>(costs.rows() + costs.cols()) - static_cast<double>(pairs.size());
  for (const PointPair& pair : pairs) out += costs(pair.row, pair.point);
  return out;
}

/// The smallest cost of all ways to pair ascending rows and points.
double smallest_cost(const MatrixX& costs, Index row, Index point) {
  if (row == costs.rows()) return 0.5 * static_cast<double>(costs.cols() - point);
  double best = 0.5 + smallest_cost(costs, row + 1, point);
  for (Index j = point; j < costs.cols(); ++j)
    best = std::min(best, costs(row, j) + 0.5 * static_cast<double>(j - point) + smallest_cost(costs, row + 1, j + 1));
  return best;
}

TEST(PointAlignment, GapsByBruteForce) {
  Rng rng(3);
  for (int trial = 0; trial < 300; ++trial) {
    const auto rows = static_cast<Index>(rng.below(7)), points = static_cast<Index>(rng.below(7));
    MatrixX costs(rows, points);
    for (Index k = 0; k < costs.size(); ++k) costs.data()[k] = rng.uniform(0, 1.5);
    const auto pairs = detail::align_with_gaps(rows, points, [&](Index i, Index j) { return costs(i, j); });
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      EXPECT_LT(costs(pairs[k].row, pairs[k].point), 1);
      if (k > 0) {
        EXPECT_GT(pairs[k].row, pairs[k - 1].row);
        EXPECT_GT(pairs[k].point, pairs[k - 1].point);
      }
    }
    EXPECT_NEAR(cost_of(pairs, costs), smallest_cost(costs, 0, 0), 1e-12);
  }
}

/// Planted faults in the points that a tracker measured.
template <int N>
void expect_found_in_measured(const std::string& file, const DhChain<N>& chain, Index rows, double limit) {
  const char* folder = std::getenv("VERNIER_DATA_DIR");
  if (folder == nullptr || *folder == '\0') GTEST_SKIP() << "VERNIER_DATA_DIR is not set";
  const Dataset<N> data = read_dataset<N>(std::string(folder) + "/" + file);
  Session session{{}, data.positions().topRows(rows), {}};
  for (Index i = 0; i < rows; ++i) {
    session.flanges.push_back(chain.pose(data.joints(i)));
    session.source.push_back(i);
  }
  const Pairing whole = pair_by_order(session.flanges, session.points);
  ASSERT_EQ(whole.proof->status, PairingStatus::proven);
  EXPECT_EQ(whole.pairs.size(), static_cast<std::size_t>(rows));
  EXPECT_TRUE(whole.faults.empty());
  EXPECT_LT(whole.proof->limit, limit);
  Rng rng(4);
  const std::vector<Planted> planted = plant(session, 6, -1, rng);
  const Pairing found = pair_by_order(session.flanges, session.points);
  ASSERT_EQ(found.proof->status, PairingStatus::proven);
  EXPECT_EQ(found.faults.size(), planted.size());
  expect_right_pairs(found, session);
}

TEST(PairPoints, MeasuredUr10) {
  expect_found_in_measured<6>("ur10_random_poses.csv", robots::ur10().chain, 200, 0.006);
}
TEST(PairPoints, MeasuredUr5) { expect_found_in_measured<6>("ur5_grid.csv", robots::ur5().chain, 1000, 0.006); }
TEST(PairPoints, MeasuredWam) { expect_found_in_measured<7>("wam_grid.csv", robots::barrett_wam().chain, 216, 0.03); }

// Pairs by name prove an arm where points are off by 1 % of their spread, but not by 3 %: so are those of any arm.
TEST(PairSearchWhiteBox, TooLargeErrorsProveNothing) {
  for (const double size : {0.01, 0.03}) {
    Session session = Session::simulate(60, 3);
    std::vector<PointPair> pairs;
    Rng rng(8);
    for (Index i = 0; i < 60; ++i) {
      pairs.push_back({i, i});
      const Vector3 error(rng.normal(), rng.normal(), rng.normal());
      set_point(session.points, i, point(session.points, i) + size * 0.8 / error.norm() * error);
    }
    const PairingProof proof = detail::prove({session.flanges, session.points, false, pairs}).first;
    EXPECT_EQ(proof.status, size < 0.02 ? PairingStatus::proven : PairingStatus::unrelated) << size;
  }
}

}  // namespace
}  // namespace vernier::pair_points_test
