// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.hpp"

#include <cmath>
#include <cstring>
#include <thread>

#include "vernier/core/check.hpp"
#include "vernier/core/simd.hpp"

namespace python {

namespace {

namespace vn = vernier;

/// Whether all numbers are finite.
bool all_finite(const double* from, vn::Index n) {
  double sum = 0;  // of zeros, unless a number is not finite
  vn::detail::run_same_bits([&]<int W>() VERNIER_INLINED {
    constexpr int parts = 4;
    typename vn::detail::Simd<W>::Double sums[parts] = {}, values;
    vn::Index k = 0;
    for (; k + parts * W <= n; k += parts * W)
      for (int part = 0; part < parts; ++part) {
        vn::detail::load<W>(values, from + k + part * W);
        sums[part] += 0.0 * values;
      }
    for (; k < n; ++k) sum += 0 * from[k];
    for (int part = 0; part < parts; ++part)
      for (int lane = 0; lane < W; ++lane) sum += sums[part][lane];
  });
  return std::isfinite(sum);
}

std::string shape_of(const py::array& array) {
  std::string out = "(";
  for (py::ssize_t k = 0; k < array.ndim(); ++k) out += vn::message(k > 0 ? ", " : "", array.shape(k));
  return out + (array.ndim() == 1 ? ",)" : ")");
}

/// Refuses arrays of which some numbers are not meant.
void refuse_masked(const py::object& object, const char* name) {
  if (!py::isinstance<py::array>(object) || Py_TYPE(object.ptr()) == py::detail::npy_api::get().PyArray_Type_) return;
  vn::demand(!py::isinstance(object, py::module_::import("numpy.ma").attr("MaskedArray")), name,
             ": a masked array is not read; leave the rows out, or use its method filled");
}

}  // namespace

ReadCounts& read_counts() {
  static ReadCounts counts;
  return counts;
}

Array numbers(const py::object& object, const char* name) {
  const py::array array = py::array::ensure(object);
  if (!array) {
    PyErr_Clear();
    vn::demand(false, name, ": an array of numbers is expected, not ", std::string(py::str(py::type::of(object))));
  }
  refuse_masked(object, name);
  const char kind = array.dtype().kind();
  vn::demand(kind == 'f' || kind == 'i' || kind == 'u', name, ": an array of real numbers is expected, not of ",
             std::string(py::str(array.dtype())));
  constexpr int in_place = int{py::detail::npy_api::NPY_ARRAY_ALIGNED_} | int{py::array::c_style};
  const bool as_it_is = array.dtype().is(py::dtype::of<double>()) && (array.flags() & in_place) == in_place;
  ++(as_it_is && array.ptr() == object.ptr() ? read_counts().in_place : read_counts().converted);
  return as_it_is ? Array(array) : Array(py::array_t<double, py::array::c_style | py::array::forcecast>(array));
}

Rows::Rows(const py::object& object, const char* name, vn::Index columns, Values values) {
  const Array array = numbers(object, name);
  vn::demand((array.ndim() == 1 || array.ndim() == 2) && array.shape(array.ndim() - 1) == columns, name,
             ": an array of shape (n, ", columns, ") or (", columns, ",) is expected, not ", shape_of(array));
  single_ = array.ndim() == 1;
  view_ = {array.data(), single_ ? 1 : array.shape(0), columns};
  kept_ = array;
  if (values == Values::finite) check(name);
}

Rows Rows::of(const Array& array, const char* name, bool single) {
  Rows out;
  out.view_ = {array.data(), array.shape(0), array.shape(1)};
  out.single_ = single;
  out.kept_ = array;
  out.check(name);
  return out;
}

void Rows::check(const char* name) const {
  if (all_finite(view_.data, view_.rows * view_.columns)) return;
  for (vn::Index i = 0; i < view_.rows; ++i)
    for (vn::Index k = 0; k < view_.columns; ++k)
      vn::demand(std::isfinite(view_.row(i)[k]), name, ": row ", i, " has the value ", view_.row(i)[k]);
}

Rows poses(const py::object& object, const char* name) {
  Array array = numbers(object, name);
  const py::ssize_t n = array.ndim();
  vn::demand((n == 2 || n == 3) && array.shape(n - 1) == 4 && array.shape(n - 2) == 4, name,
             ": poses are arrays of shape (4, 4) or (n, 4, 4), not ", shape_of(array));
  const Rows out =
      Rows::of(Array(array.reshape({n == 2 ? py::ssize_t{1} : array.shape(0), py::ssize_t{16}})), name, n == 2);
  for (vn::Index i = 0; i < out.size(); ++i) {
    const double* p = out.view().row(i);
    double off = std::abs(p[12]) + std::abs(p[13]) + std::abs(p[14]) + std::abs(p[15] - 1);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c <= r; ++c)
        off += std::abs(p[4 * r] * p[4 * c] + p[4 * r + 1] * p[4 * c + 1] + p[4 * r + 2] * p[4 * c + 2] - (r == c));
    const double determinant =
        p[0] * (p[5] * p[10] - p[6] * p[9]) - p[1] * (p[4] * p[10] - p[6] * p[8]) + p[2] * (p[4] * p[9] - p[5] * p[8]);
    vn::demand(off < 1e-6 && determinant > 0, name, ": row ", i,
               " is no pose: a rotation and a position over (0, 0, 0, 1)");
  }
  return out;
}

std::vector<bool> flags_of(const py::object& object, const char* name, vn::Index rows) {
  const py::array array = py::array::ensure(object);
  if (!array) PyErr_Clear();
  vn::demand(array && array.dtype().kind() == 'b' && array.ndim() <= 1, name, ": True, False, or one of them a row is ",
             "expected, not ", std::string(py::repr(object)));
  vn::demand(array.ndim() == 0 || array.shape(0) == rows, name, ": ", array.size(), " values of ", rows, " rows");
  std::vector<bool> out(static_cast<std::size_t>(rows));
  const auto values = py::array_t<bool, py::array::c_style | py::array::forcecast>(array);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = values.data()[array.ndim() == 0 ? 0 : i];
  return out;
}

std::vector<vn::Index> row_numbers(const py::object& object, const char* name, vn::Index rows) {
  const py::array array = py::array::ensure(object);
  if (!array) PyErr_Clear();
  const char kind = array ? array.dtype().kind() : ' ';
  vn::demand(array && array.ndim() == 1 && (kind == 'i' || kind == 'u' || kind == 'b' || array.size() == 0), name,
             ": an array of whole numbers is expected, or of a flag a row");
  std::vector<vn::Index> out;
  if (kind == 'b') {
    const std::vector<bool> chosen = flags_of(object, name, rows);
    for (std::size_t i = 0; i < chosen.size(); ++i)
      if (chosen[i]) out.push_back(static_cast<vn::Index>(i));
    return out;
  }
  const auto values = py::array_t<vn::Index, py::array::c_style | py::array::forcecast>(array);
  out.assign(values.data(), values.data() + values.size());
  return out;
}

vn::Index whole_number(const py::object& object, const char* name) {
  const auto out = static_cast<vn::Index>(PyNumber_AsSsize_t(object.ptr(), PyExc_OverflowError));
  const bool failed = PyErr_Occurred() != nullptr;
  PyErr_Clear();
  vn::demand(!failed, name, ": a whole number is expected, not ", std::string(py::repr(object)));
  return out;
}

vn::MatrixX matrix_of(const Rows& rows) {
  const support::RowsView view = rows.view();
  vn::MatrixX out(view.rows, view.columns);
  for (vn::Index i = 0; i < view.rows; ++i)
    for (vn::Index k = 0; k < view.columns; ++k) out(i, k) = view.row(i)[k];
  return out;
}

vn::VectorX vector_of(const py::object& object, const char* name, vn::Index n) {
  const Array array = numbers(object, name);
  vn::demand(array.ndim() == 1 && array.shape(0) == n, name, ": an array of shape (", n, ",) is expected, not ",
             shape_of(array));
  vn::VectorX out(n);
  for (vn::Index i = 0; i < n; ++i) {
    out(i) = array.data()[i];
    vn::demand(std::isfinite(out(i)), name, ": row ", i, " has the value ", out(i));
  }
  return out;
}

Array new_array(bool single, vn::Index rows, std::vector<vn::Index> shape) {
  if (!single) shape.insert(shape.begin(), rows);
  return Array(shape);
}

Array array_of(const vn::MatrixX& values) {
  Array out({values.rows(), values.cols()});
  double* to = out.mutable_data();
  for (vn::Index i = 0; i < values.rows(); ++i)
    for (vn::Index k = 0; k < values.cols(); ++k) *to++ = values(i, k);
  return out;
}

Array array_of(const vn::VectorX& values) { return Array({values.size()}, values.data()); }
Array array_of(const std::vector<double>& values) {
  return Array({static_cast<py::ssize_t>(values.size())}, values.data());
}

int threads_for(vn::Index rows, vn::Index rows_of_a_thread) {
  const vn::Index most = static_cast<vn::Index>(std::thread::hardware_concurrency());
  return static_cast<int>(std::max<vn::Index>(1, std::min(most, rows / rows_of_a_thread)));
}

std::string path_of(const py::object& path) {
  return py::module_::import("os").attr("fspath")(path).cast<std::string>();
}

}  // namespace python
