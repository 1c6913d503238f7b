// SPDX-License-Identifier: BSD-3-Clause
#include "held_out_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "vernier/calibration/calibration_failure.hpp"

namespace support {

namespace vn = vernier;

vernier::detail::SplitRows held_out_rows(vernier::Index n, const CalibrationOptions& o, std::uint64_t seed,
                                         const std::string& file, const char* what, std::string& rule) {
  if (n < 2) throw vn::CalibrationFailure(fmt::format("{}: a single {}, none can be held out", file, what));
  if (o.split.empty()) {
    rule = fmt::format("every {} i with i % {} = 0, counted from 0", what, o.test_every);
    return vn::detail::every_kth_row(n, o.test_every);
  }
  if (o.split.starts_with("region"))
    throw UsageError(
        fmt::format("--split {} holds measured positions out; of {} {}s are held out by --test-every, "
                    "random, block or time",
                    o.split, file, what));
  if (o.split == "block") {
    const auto blocks = std::min<vn::Index>(n, std::max<vn::Index>(2, std::llround(1 / o.test_fraction)));
    const auto count = static_cast<std::uint64_t>(blocks);
    const auto block = static_cast<vn::Index>((seed + count - 1) % count);
    rule = fmt::format("block {} of {} contiguous blocks of the {}s", block + 1, blocks, what);
    return vn::detail::rows_of_block(n, block, blocks);
  }
  rule = fmt::format("{:.3g} % of the {}s, ", o.test_fraction * 100, what);
  if (o.split == "time") {
    rule += "the last ones";
    return vn::detail::last_rows(n, o.test_fraction);
  }
  rule += fmt::format("at random, seed {}", seed);
  return vn::detail::random_rows(n, {.test_fraction = o.test_fraction, .seed = seed});
}

vernier::detail::SplitRows whole_poses(const vernier::detail::SplitRows& rows, const vernier::ConstMatrixRef& joints,
                                       const vernier::SamePose& same, std::string& rule) {
  vn::detail::SplitRows out = vn::detail::with_whole_poses(rows, joints, same);
  if (out.test.size() > rows.test.size())
    rule += fmt::format(", and {} more at the same poses", out.test.size() - rows.test.size());
  return out;
}

std::vector<vernier::Index> training_rows(vernier::Index n, const CalibrationOptions& o, std::uint64_t seed,
                                          const std::string& file, const char* what) {
  if (o.train_rows > n)
    throw vn::CalibrationFailure(
        fmt::format("{}: --train asks for {} {}, there are {} to learn from", file, o.train_rows, what, n));
  if (o.train_rows > 0) return vn::detail::first_random_rows(n, o.train_rows, seed);
  std::vector<vn::Index> out(static_cast<std::size_t>(n));
  std::iota(out.begin(), out.end(), vn::Index{0});
  return out;
}

}  // namespace support
