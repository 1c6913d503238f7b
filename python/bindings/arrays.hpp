// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Arrays of NumPy, read in place where they are contiguous, and arrays that own their memory.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <string>
#include <vector>

#include "rows_view.hpp"
#include "vernier/core/executor.hpp"
#include "vernier/core/types.hpp"

namespace python {

namespace py = pybind11;

using Array = py::array_t<double, py::array::c_style>;

/// Arrays that were read in place, and those that were converted, since the module was imported.
struct ReadCounts {
  std::size_t in_place = 0;   ///< C-contiguous float64
  std::size_t converted = 0;  ///< others
};
ReadCounts& read_counts();

/// Which values an array may have.
enum class Values { finite, any };

/// An array of numbers as rows: of shape (columns) one row, of shape (n, columns) n. Keeps the array alive.
class Rows {
 public:
  /// No rows.
  Rows() = default;
  /// @param object  what the caller gave: an array or nested lists
  /// @param name    in messages
  /// @param columns numbers in a row
  /// @param values  whether NaN is refused, naming the row
  /// @throws std::invalid_argument on another shape or type
  Rows(const py::object& object, const char* name, vernier::Index columns, Values values = Values::finite);

  /// Rows of an array that `numbers` returned and that was reshaped to (n, columns).
  static Rows of(const Array& array, const char* name, bool single);

  /// The rows, for code that does not know Python.
  support::RowsView view() const { return view_; }
  /// Number of rows.
  vernier::Index size() const { return view_.rows; }
  /// Whether a single row was given.
  bool single() const { return single_; }

 private:
  void check(const char* name) const;

  py::object kept_{};
  support::RowsView view_{};
  bool single_ = false;
};

/// An array of numbers of any shape, C-contiguous.
/// @throws std::invalid_argument for what is no array of numbers
Array numbers(const py::object& object, const char* name);

/// Poses of shape (4, 4) or (n, 4, 4) as rows of 16 numbers.
/// @throws std::invalid_argument on another shape, or rows that are no rigid motion
Rows poses(const py::object& object, const char* name);

/// True and false: one, or one a row.
/// @throws std::invalid_argument for anything else, and for another number of rows
std::vector<bool> flags_of(const py::object& object, const char* name, vernier::Index rows);

/// Numbers of rows, from an array of whole numbers, or of a flag a row.
/// @throws std::invalid_argument for anything else
std::vector<vernier::Index> row_numbers(const py::object& object, const char* name, vernier::Index rows);

/// A whole number.
/// @throws std::invalid_argument for anything else
vernier::Index whole_number(const py::object& object, const char* name);

/// Rows in a matrix.
vernier::MatrixX matrix_of(const Rows& rows);
/// A vector of n numbers.
/// @throws std::invalid_argument on another number, or NaN
vernier::VectorX vector_of(const py::object& object, const char* name, vernier::Index n);

/// A new array; its first axis is left out for a single row.
Array new_array(bool single, vernier::Index rows, std::vector<vernier::Index> shape);
/// Copies of matrices and vectors.
Array array_of(const vernier::MatrixX& values);
Array array_of(const vernier::VectorX& values);
Array array_of(const std::vector<double>& values);

/// Threads of a call over n independent rows, as many as are worth starting.
/// @param rows_of_a_thread which take some milliseconds
int threads_for(vernier::Index rows, vernier::Index rows_of_a_thread);

/// A path, of str or os.PathLike.
std::string path_of(const py::object& path);

}  // namespace python
