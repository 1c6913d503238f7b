// SPDX-License-Identifier: BSD-3-Clause
// What the audit of data finds: measured poses with one planted fault each, and false alarms on subsets of measured
// poses and on simulated files.
//
//   data_audit_study FOLDER [FILES [SUBSETS [SIZE]]]
//
// FOLDER has ur10_random_poses.csv, ur5_grid.csv and wam_grid.csv. FILES (1000) have a fault each, SUBSETS (1000) none.
// SIZE (1) multiplies the sizes of planted faults.

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include "planted_faults.hpp"
#include "vernier/calibration/data_audit.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/error_sources.hpp"
#include "vernier/simulation/sampling.hpp"

namespace vn = vernier;
using vn::FaultKind, vn::Index;

namespace {

constexpr FaultKind kinds[] = {FaultKind::length_unit,   FaultKind::joint_unit,     FaultKind::joint_sign,
                               FaultKind::joint_zero,    FaultKind::mirrored_frame, FaultKind::orientation_convention,
                               FaultKind::shifted_rows,  FaultKind::swapped_rows,   FaultKind::duplicate_rows,
                               FaultKind::outlier,       FaultKind::joints_read,    FaultKind::approach_never_varies,
                               FaultKind::session_drift, FaultKind::joint_coupling};

struct Count {
  int files = 0, named = 0, alone = 0;
};
struct Totals {
  Count planted;
  int subsets = 0, false_alarms = 0, simulated = 0, simulated_alarms = 0;
  std::map<FaultKind, int> alarms;
};

/// 40 rows or more in their order: at random, or a run of consecutive ones.
template <int N>
std::vector<Index> draw_rows(const vn::Dataset<N>& data, vn::Rng& rng) {
  const double most = static_cast<double>(std::min<Index>(data.size(), 1000));
  const auto n = static_cast<Index>(40 * std::pow(most / 40, rng.uniform()));
  std::vector<Index> rows;
  if (rng.sign() > 0) {
    rows = rng.permutation(data.size());
    rows.resize(static_cast<std::size_t>(n));
    std::sort(rows.begin(), rows.end());
  } else {
    rows.resize(static_cast<std::size_t>(n));
    std::iota(rows.begin(), rows.end(), static_cast<Index>(rng.below(static_cast<std::uint64_t>(data.size() - n + 1))));
  }
  return rows;
}

/// Whether the whole file has this finding.
bool recorded(const vn::DataFinding& finding, const std::vector<Index>& rows, const vn::DataAudit& whole) {
  for (const vn::DataFinding& known : whole.findings) {
    if (known.kind != finding.kind || known.joint != finding.joint) continue;
    bool all = true;
    for (const Index row : finding.rows)
      all = all && std::binary_search(known.rows.begin(), known.rows.end(), rows[static_cast<std::size_t>(row)]);
    if (all || known.rows.empty()) return true;
  }
  return false;
}

template <class Chain>
void study(const char* name, const std::string& file, const Chain& chain, const vn::PlantedSizes& sizes, int files,
           int subsets, Totals& totals) {
  constexpr int N = Chain::dof;
  const vn::Dataset<N> data = vn::read_dataset<N>(file);
  const vn::DataAudit whole = vn::audit_data(chain, data);
  std::printf("%s, %d rows\n%s", name, static_cast<int>(data.size()), whole.summary().c_str());
  std::map<FaultKind, Count> counts;
  vn::Rng rng(1);
  for (int k = 0, done = 0; done < files; ++k) {
    const FaultKind kind = kinds[static_cast<std::size_t>(k) % std::size(kinds)];
    const vn::Dataset<N> subset = data.rows(draw_rows(data, rng));
    const auto planted = vn::plant(chain, subset, kind, sizes, rng);
    if (!planted) {
      if (k > 20 * files) break;
      continue;
    }
    ++done;
    const vn::DataAudit audit = vn::audit_data(chain, planted->data);
    bool named = false, alone = true;
    for (const vn::DataFinding& finding : audit.findings) {
      const bool is = planted->is(finding);
      named = named || is;
      bool known = false;
      for (const vn::DataFinding& one : whole.findings) known = known || one.kind == finding.kind;
      // the row of a pose that was not read again is an outlier, too
      const bool follows = kind == FaultKind::duplicate_rows && finding.kind == FaultKind::outlier;
      alone = alone && (is || known || follows);
    }
    Count& count = counts[kind];
    ++count.files;
    count.named += named;
    count.alone += named && alone;
    if ((!named || !alone) && std::getenv("VERBOSE") != nullptr)
      std::printf("  %s joint %d size %g rows %d (first %d)%s\n%s", std::string(fault_name(kind)).c_str(),
                  planted->joint + 1, planted->size, static_cast<int>(planted->data.size()),
                  planted->rows.empty() ? -1 : static_cast<int>(planted->rows.front()), named ? " NAMED" : "",
                  audit.summary().c_str());
  }
  std::printf("  %-24s %6s %12s %16s\n", "planted", "files", "named, %", "nothing else, %");
  for (const auto& [kind, count] : counts) {
    std::printf("  %-24s %6d %12.1f %16.1f\n", std::string(fault_name(kind)).c_str(), count.files,
                100.0 * count.named / count.files, 100.0 * count.alone / count.files);
    totals.planted.files += count.files;
    totals.planted.named += count.named;
    totals.planted.alone += count.alone;
  }
  int alarms = 0;
  for (int k = 0; k < subsets; ++k) {
    const std::vector<Index> rows = draw_rows(data, rng);
    const vn::DataAudit audit = vn::audit_data(chain, data.rows(rows));
    bool alarm = false;
    for (const vn::DataFinding& finding : audit.findings)
      if (!recorded(finding, rows, whole)) {
        alarm = true;
        ++totals.alarms[finding.kind];
      }
    if (alarm && std::getenv("VERBOSE") != nullptr)
      std::printf("  %d rows from %d\n%s", static_cast<int>(rows.size()), static_cast<int>(rows.front()),
                  audit.summary().c_str());
    alarms += alarm;
  }
  std::printf("  false alarms: %d of %d subsets\n\n", alarms, subsets);
  totals.subsets += subsets;
  totals.false_alarms += alarms;
}

/// Simulated files without a fault.
template <class Chain>
void simulate(const Chain& chain, int files, Totals& totals) {
  vn::Rng rng(7);
  vn::JointLimits<Chain::dof> limits;
  limits.lower.setConstant(-2);
  limits.upper.setConstant(2);
  for (int k = 0; k < files; ++k) {
    const std::uint64_t seed = rng();
    const vn::Framed actual(
        vn::WithJointErrors<Chain>(vn::with_geometric_errors(chain, {.length_max = 1e-3, .angle_max = 2e-3}, seed),
                                   vn::draw_joint_errors(chain, {}, seed + 1)),
        vn::FrameParameters(vn::Vector6{2, -1, 0.5, 0.3, -0.2, 1.5}).isometry(),
        vn::FrameParameters(vn::Vector6{0.02, 0.03, 0.11, 0, 0.1, 0}).isometry());
    const auto n = static_cast<Index>(40 * std::pow(12, rng.uniform()));
    const auto data =
        vn::measure(actual, vn::sample_joints(limits, n, seed + 2), {0.03e-3, 0.1e-3, rng.sign() > 0}, seed + 3);
    const vn::DataAudit audit = vn::audit_data(chain, data);
    ++totals.simulated;
    totals.simulated_alarms += !audit.findings.empty();
    if (!audit.findings.empty() && std::getenv("VERBOSE") != nullptr)
      std::printf("simulated\n%s", audit.summary().c_str());
  }
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 2) {
    std::fprintf(stderr, "usage: data_audit_study FOLDER [FILES [SUBSETS [SIZE]]]\n");
    return 2;
  }
  const std::string folder = argv[1];
  const int files = argc > 2 ? std::atoi(argv[2]) : 1000, subsets = argc > 3 ? std::atoi(argv[3]) : 1000;
  Totals totals;
  const double size = argc > 4 ? std::atof(argv[4]) : 1;
  const auto sized = [&](vn::PlantedSizes sizes) {
    for (double* value :
         {&sizes.effect, &sizes.zero_min, &sizes.outlier_min, &sizes.outlier_max, &sizes.drift_min, &sizes.drift_max})
      *value *= size;
    return sizes;
  };
  const vn::PlantedSizes rigid = sized({});
  const vn::PlantedSizes cable = sized({.effect = 20e-3,
                                        .zero_min = 0.07,
                                        .outlier_min = 25e-3,
                                        .outlier_max = 0.2,
                                        .drift_min = 20e-3,
                                        .drift_max = 60e-3});
  study("UR10", folder + "/ur10_random_poses.csv", vn::robots::ur10().chain, rigid, files - 2 * (files / 3),
        subsets - 2 * (subsets / 3), totals);
  study("UR5", folder + "/ur5_grid.csv", vn::robots::ur5().chain, rigid, files / 3, subsets / 3, totals);
  study("WAM", folder + "/wam_grid.csv", vn::robots::barrett_wam().chain, cable, files / 3, subsets / 3, totals);
  simulate(vn::robots::ur10().chain, subsets / 2, totals);
  simulate(vn::robots::abb_irb120().chain, subsets - subsets / 2, totals);
  const auto percent = [](int part, int all) { return all > 0 ? 100.0 * part / all : 0; };
  std::printf("all: %d files with a fault, named rightly %.1f %%, and nothing else %.1f %%\n", totals.planted.files,
              percent(totals.planted.named, totals.planted.files), percent(totals.planted.alone, totals.planted.files));
  std::printf("false alarms: %.2f %% of %d measured subsets, %.2f %% of %d simulated files\n",
              percent(totals.false_alarms, totals.subsets), totals.subsets,
              percent(totals.simulated_alarms, totals.simulated), totals.simulated);
  for (const auto& [kind, count] : totals.alarms)
    std::printf("  %s: %d\n", std::string(fault_name(kind)).c_str(), count);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "data_audit_study: %s\n", error.what());
  return 1;
}
