// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A calibrated arm as C source: one file that predicts and corrects as the library does, for controllers, real-time
/// loops and other languages.

#include <optional>
#include <string>

#include "vernier/io/model_file.hpp"

namespace vernier {

/// How an arm is written as C source.
struct CExport {
  std::string name = "arm";                ///< a C identifier, with which all names begin; in capitals those of macros
  std::string hash{};                      ///< SHA-256 of the model file; empty: of the file that `save` writes
  std::optional<double> held_out_error{};  ///< mean position error at held-out poses [m]; none: that of the provenance
};

namespace detail {

/// Throws `std::invalid_argument` on what has no C source, and on a name that is no identifier.
VERNIER_API std::string c_source(const ModelData& model, const CExport& options);

}  // namespace detail

/// A calibrated arm as a C header: C99 and C++11, `<math.h>` alone, nothing allocated, no variables but constant
/// tables. Its functions `NAME_pose`, `NAME_nominal_pose`, `NAME_jacobian`, `NAME_gate` and `NAME_correct` do what
/// `approached_from(..).pose`, `nominal().pose`, `approached_from(..).jacobian`, `gate` and `correct` of the robot do,
/// by the same algorithms: poses agree to 1e-13 m, commands to 1e-9 rad where no singularity is near. They are `static
/// inline`; where `NAME_API` is defined, empty for instance, they are what it says, for a library of their own:
///
///     cc -O2 -shared -fPIC -DARM_API= -x c arm.h -o arm.so -lm
///
/// What was learned over the joints is written too, for any network of one hidden layer. An arm that changes with
/// temperature is as at its reference (`CalibratedRobot::at_temperature` for another). The covariance is left out.
/// @param robot   the arm
/// @param options name, origin
/// @throws std::invalid_argument for a learned position error of kernels, whose samples are no table of that size; for
/// a name that is no C identifier; on a value that is not finite
template <int N, class Convention>
std::string c_source(const CalibratedRobot<N, Convention>& robot, const CExport& options = {}) {
  return detail::c_source(detail::model_data(robot), options);
}

/// A saved arm of any number of joints, in either convention, as a C header like that of a `CalibratedRobot`; the hash
/// is that of its file.
/// @param model   from `read_model`
/// @param options name, held-out error
/// @throws std::invalid_argument where the arm, or the name, has no C source
VERNIER_API std::string c_source(const SavedModel& model, CExport options = {});

/// The arm of a model file as a C header: `c_source(read_model(model_file), options)`.
/// @throws DataError naming file and key
/// @throws std::invalid_argument where the arm, or the name, has no C source
VERNIER_API std::string c_source(const std::string& model_file, CExport options = {});

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/io/export_c.ipp"
#endif
