#pragma once

#include <algorithm>

#include "vernier/core/check.hpp"
#include "vernier/error_terms/joint_errors.hpp"

namespace vernier {

VERNIER_IMPL void JointTerms::dense_basis(const double* q, MatrixRef out) const noexcept {
  out.setZero();
  Index at = 0;
  if (gear_ratio)
    for (int i = 0; i < joints; ++i) out(i, at++) = q[i];
  if (coupling)
    for (int i = 1; i < joints; ++i) out(i, at++) = q[i - 1];
  if (gravity) gravity->basis(q, out.middleCols(at, gravity->size()));
}

VERNIER_IMPL std::vector<JointTermBlock> JointTerms::blocks() const {
  using Kind = JointTermBlock::Kind;
  std::vector<JointTermBlock> out;
  const auto add = [&](Kind kind, int joint, Index count) {
    const Index begin = out.empty() ? 0 : out.back().begin + out.back().count;
    if (count > 0) out.push_back({kind, joint, begin, count});
  };
  add(Kind::gear_ratio, -1, gear_ratio ? joints : 0);
  add(Kind::coupling, -1, coupling ? joints - 1 : 0);
  add(Kind::gravity, -1, gravity ? gravity->size() : 0);
  for (int i = 0; i < joints; ++i) add(Kind::transmission, i, transmission[static_cast<std::size_t>(i)].size());
  return out;
}

VERNIER_IMPL std::vector<std::string> JointTerms::names() const {
  std::vector<std::string> out;
  if (gear_ratio)
    for (int i = 1; i <= joints; ++i) out.push_back(message("gear", i));
  if (coupling)
    for (int i = 2; i <= joints; ++i) out.push_back(message("coupling", i));
  if (gravity)
    for (int i = 1; i <= joints; ++i)
      for (int j = i; j <= joints; ++j) out.push_back(message("sag", i, '_', j));
  for (int i = 1; i <= joints; ++i)
    for (Index k = 0; k < transmission[static_cast<std::size_t>(i - 1)].size(); ++k)
      out.push_back(message(k % 2 == 0 ? "cos" : "sin", i, '_', k / 2 + 1));
  return out;
}

VERNIER_IMPL JointErrors::JointErrors(JointTerms terms, VectorX coefficients)
    : terms_(std::move(terms)), coefficients_(std::move(coefficients)) {
  require(terms_.transmission.size() == static_cast<std::size_t>(terms_.joints), "JointErrors: transmissions of ",
          terms_.transmission.size(), " joints, expected ", terms_.joints);
  require(!terms_.gravity || terms_.gravity->joints() == terms_.joints, "JointErrors: gravity compliance of ",
          terms_.gravity ? terms_.gravity->joints() : 0, " joints, expected ", terms_.joints);
  for (int i = 0; i < terms_.joints; ++i) {
    const int harmonics = terms_.transmission[static_cast<std::size_t>(i)].harmonics;
    require(harmonics >= 0, "JointErrors: joint ", i + 1, " has ", harmonics, " harmonics");
  }
  require(coefficients_.size() == terms_.size(), "JointErrors: ", coefficients_.size(), " coefficients for ",
          terms_.size(), " terms");
  require(coefficients_.allFinite(), "JointErrors: a coefficient is not finite");
}

VERNIER_IMPL void JointErrors::evaluate(const double* q, int n, double* effective, double* derivative) const noexcept {
  std::copy_n(q, n, effective);
  std::fill_n(derivative, n * n, 0.0);
  for (int i = 0; i < n; ++i) derivative[i * n + i] = 1;
  if (empty()) return;
  const double* beta = coefficients_.data();
  if (terms_.gear_ratio) {
    for (int i = 0; i < n; ++i) {
      effective[i] += beta[i] * q[i];
      derivative[i * n + i] += beta[i];
    }
    beta += n;
  }
  if (terms_.coupling) {
    for (int i = 1; i < n; ++i) {
      effective[i] += beta[i - 1] * q[i - 1];
      derivative[(i - 1) * n + i] += beta[i - 1];
    }
    beta += n - 1;
  }
  if (terms_.gravity) {
    terms_.gravity->add(q, beta, effective, derivative);
    beta += terms_.gravity->size();
  }
  for (int i = 0; i < n; ++i) {
    const Fourier& fourier = terms_.transmission[static_cast<std::size_t>(i)];
    const Fourier::Sum f = fourier.sum(q[i], beta);
    effective[i] += f.value;
    derivative[i * n + i] += f.slope;
    beta += fourier.size();
  }
}

VERNIER_IMPL MatrixX JointErrors::effective_rows(const ConstMatrixRef& joints) const {
  const auto n = static_cast<int>(joints.cols());
  MatrixX out(joints.rows(), joints.cols());
  VectorX q(n), effective(n), derivative(n * n);
  for (Index i = 0; i < joints.rows(); ++i) {
    q = joints.row(i).transpose();
    evaluate(q.data(), n, effective.data(), derivative.data());
    out.row(i) = effective.transpose();
  }
  return out;
}

VERNIER_IMPL double JointErrors::transmission(int i, double q) const noexcept {
  if (empty()) return 0;
  return terms_.transmission[static_cast<std::size_t>(i)]
      .sum(q, coefficients_.data() + terms_.transmission_begin(i))
      .value;
}

}  // namespace vernier
