// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <string_view>

#include "vernier/core/check.hpp"
#include "vernier/core/controller_map.hpp"
#include "vernier/core/detail/number_text.hpp"
#include "vernier/core/detail/quotable.hpp"

namespace vernier {

namespace detail {

/// Reads a formula, a sum of controller joints and constants.
class FormulaReader {
 public:
  FormulaReader(std::string_view text, bool revolute) : text_(text), revolute_(revolute) {}

  /// Adds the formula's terms to a row.
  VERNIER_LOCAL void read(std::vector<double>& row, double& zero) {
    sum(1, row, zero);
    if (at_ != text_.size()) fail("'+' or '-' expected");
  }

 private:
  [[noreturn]] void fail(std::string_view what) const {
    const std::string said = quotable(text_);
    throw_invalid_argument({MessagePart(std::string_view("formula '")), MessagePart(std::string_view(said)),
                            MessagePart(std::string_view("': ")), MessagePart(what)});
  }
  void skip() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
  }
  bool take(char c) {
    skip();
    if (at_ == text_.size() || text_[at_] != c) return false;
    ++at_;
    skip();
    return true;
  }
  std::optional<double> number() {
    double out = 0;
    const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), out);
    if (error != std::errc()) return std::nullopt;
    at_ = static_cast<std::size_t>(end - text_.data());
    skip();
    return out;
  }
  bool take_word(std::string_view word) {
    if (text_.substr(at_).substr(0, word.size()) != word) return false;
    at_ += word.size();
    skip();
    return true;
  }

  VERNIER_LOCAL void sum(double sign, std::vector<double>& row, double& zero) {
    double term_sign = sign;
    if (take('-'))
      term_sign = -sign;
    else
      take('+');
    for (;;) {
      term(term_sign, row, zero);
      if (take('+'))
        term_sign = sign;
      else if (take('-'))
        term_sign = -sign;
      else
        return;
    }
  }

  VERNIER_LOCAL void term(double factor, std::vector<double>& row, double& zero) {
    if (take('(')) {
      sum(factor, row, zero);
      if (!take(')')) fail("a parenthesis is not closed");
      return;
    }
    const std::optional<double> given = number();
    if (given) factor *= *given;
    if (given) take('*');
    if (take('J') || take('j')) {
      const std::optional<double> joint = number();
      if (!joint || !(*joint >= 1 && *joint <= most_controller_joints) || !same_value(*joint, std::floor(*joint)))
        fail("J needs the number of a controller joint, counted from 1");
      const auto column = static_cast<std::size_t>(*joint) - 1;
      if (row.size() <= column) row.resize(column + 1, 0.0);
      row[column] += factor;
      return;
    }
    if (!given) fail("a joint J1 .. or a number with its unit expected");
    const bool degrees = take_word("deg"), angle = degrees || take_word("rad");
    const bool millimetres = !angle && take_word("mm"), length = millimetres || (!angle && take_word("m"));
    if (!angle && !length) fail("a number needs its unit: deg, rad, mm or m");
    if (angle != revolute_)
      fail(revolute_ ? "the joint is revolute, its zero is an angle" : "the joint is prismatic, its zero is a length");
    zero += degrees ? factor * std::numbers::pi / 180 : millimetres ? factor * 1e-3 : factor;
  }

  std::string_view text_;
  bool revolute_;
  std::size_t at_ = 0;
};

/// Inverse of a matrix of whole numbers; empty where it has none of whole numbers. Gauss-Jordan, exact while its
/// numbers are small.
VERNIER_LOCAL MatrixX whole_inverse(MatrixX a) {
  const Index n = a.rows();
  MatrixX out = MatrixX::Identity(n, n);
  for (Index k = 0; k < n; ++k) {
    Index pivot = k;
    for (Index i = k + 1; i < n; ++i)
      if (std::abs(a(i, k)) > std::abs(a(pivot, k))) pivot = i;
    if (same_value(a(pivot, k), 0)) return {};
    const double divisor = a(pivot, k);
    for (Index c = 0; c < n; ++c) {
      std::swap(a(k, c), a(pivot, c));
      std::swap(out(k, c), out(pivot, c));
      a(k, c) /= divisor;
      out(k, c) /= divisor;
    }
    for (Index i = 0; i < n; ++i) {
      const double factor = a(i, k);
      for (Index c = 0; c < n && i != k; ++c) {
        a(i, c) -= factor * a(k, c);
        out(i, c) -= factor * out(k, c);
      }
    }
  }
  for (Index i = 0; i < n; ++i)
    for (Index c = 0; c < n; ++c) {
      const double whole = std::round(out(i, c));
      if (!(std::abs(out(i, c) - whole) < 1e-9)) return {};
      out(i, c) = same_value(whole, 0) ? 0 : whole;
    }
  return out;
}

/// rows times the transpose of a matrix, sums without terms of factor 0.
VERNIER_LOCAL MatrixX mapped_rows(const ConstMatrixRef& rows, const MatrixX& matrix, Index outputs) {
  MatrixX out = MatrixX::Zero(rows.rows(), outputs);
  for (Index j = 0; j < outputs; ++j)
    for (Index k = 0; k < rows.cols(); ++k)
      if (!same_value(matrix(j, k), 0))
        for (Index i = 0; i < rows.rows(); ++i) out(i, j) += matrix(j, k) * rows(i, k);
  return out;
}

}  // namespace detail

VERNIER_IMPL void ControllerMap::complete(const MatrixX& coefficients) {
  const Index n = coefficients.rows(), m = coefficients.cols();
  demand(n >= 1 && m >= 1 && m <= n && n <= detail::most_controller_joints, "ControllerMap: ", m,
         " controller joints for a chain of ", n);
  for (Index k = 0; k < n * m; ++k)
    demand(same_value(coefficients.data()[k], std::round(coefficients.data()[k])) &&
               std::abs(coefficients.data()[k]) <= 100,
           "ControllerMap: the factor ", coefficients.data()[k], " is no whole number");
  for (Index i = 0; i < zeros_.size(); ++i)
    demand(std::isfinite(zeros_(i)), "ControllerMap: the zero of joint ", i + 1, " is not finite");
  joints_ = static_cast<int>(m);
  // Which joints of the chain are passive: those without which the others determine all joints of the controller.
  // The last such joints are taken.
  std::vector<bool> passive(static_cast<std::size_t>(n), false);
  std::fill(passive.begin() + m, passive.end(), true);
  do {
    square_ = MatrixX::Zero(n, n);
    square_.leftCols(m) = coefficients;
    Index column = m;
    for (Index i = 0; i < n; ++i)
      if (passive[static_cast<std::size_t>(i)]) square_(i, column++) = 1;
    inverse_ = detail::whole_inverse(square_);
  } while (inverse_.size() == 0 && std::next_permutation(passive.begin(), passive.end()));
  demand(inverse_.size() > 0, "ControllerMap: the joints of the chain do not determine those of the controller");
}

VERNIER_IMPL ControllerMap::ControllerMap(const ConstMatrixRef& coefficients, const ConstVectorRef& zeros)
    : zeros_(zeros) {
  demand(zeros.size() == coefficients.rows(), "ControllerMap: ", zeros.size(), " zeros for ", coefficients.rows(),
         " joints");
  complete(coefficients);
}

VERNIER_IMPL ControllerMap::ControllerMap(std::span<const std::string> formulas, std::span<const JointType> types) {
  demand(types.empty() || types.size() == formulas.size(), "ControllerMap: ", formulas.size(), " formulas for ",
         types.size(), " joints of the chain");
  const auto n = static_cast<Index>(formulas.size());
  zeros_ = VectorX::Zero(n);
  std::vector<std::vector<double>> rows(formulas.size());
  std::size_t joints = 0;
  for (std::size_t i = 0; i < formulas.size(); ++i) {
    detail::FormulaReader(formulas[i], types.empty() || types[i] == JointType::revolute)
        .read(rows[i], zeros_(static_cast<Index>(i)));
    joints = (std::max)(joints, rows[i].size());
  }
  MatrixX coefficients = MatrixX::Zero(n, static_cast<Index>(joints));
  for (Index i = 0; i < n; ++i) {
    const std::vector<double>& row = rows[static_cast<std::size_t>(i)];
    for (std::size_t c = 0; c < row.size(); ++c) coefficients(i, static_cast<Index>(c)) = row[c];
  }
  complete(coefficients);
  if (!types.empty()) static_cast<void>(this->types(types));
}

VERNIER_IMPL int ControllerMap::joints(int chain_joints) const {
  if (same()) return chain_joints;
  demand(chain_joints == this->chain_joints(), "ControllerMap: of a chain of ", this->chain_joints(),
         " joints, not of ", chain_joints);
  return joints_;
}

VERNIER_IMPL MatrixX ControllerMap::to_chain(const ConstMatrixRef& controller) const {
  if (same()) return controller;
  demand(controller.cols() == joints_, "ControllerMap: ", controller.cols(), " joint values, expected ", joints_);
  MatrixX out = detail::mapped_rows(controller, square_, square_.rows());
  for (Index j = 0; j < out.cols(); ++j)
    for (Index i = 0; i < out.rows(); ++i) out(i, j) += zeros_(j);
  return out;
}

VERNIER_IMPL MatrixX ControllerMap::to_controller(const ConstMatrixRef& chain) const {
  if (same()) return chain;
  demand(chain.cols() == square_.rows(), "ControllerMap: ", chain.cols(), " joint values, expected ", square_.rows());
  MatrixX from_zero = chain;
  for (Index j = 0; j < chain.cols(); ++j)
    for (Index i = 0; i < chain.rows(); ++i) from_zero(i, j) -= zeros_(j);
  return detail::mapped_rows(from_zero, inverse_, joints_);
}

VERNIER_IMPL MatrixX ControllerMap::chain_limits(const ConstVectorRef& lower, const ConstVectorRef& upper) const {
  demand(lower.size() == upper.size() && lower.size() >= joints_, "ControllerMap: limits of ", lower.size(),
         " joints, expected ", joints_);
  const Index n = same() ? lower.size() : square_.rows();
  MatrixX out(n, 2);
  for (Index i = 0; i < n; ++i) {
    out(i, 0) = same() ? lower(i) : zeros_(i);
    out(i, 1) = same() ? upper(i) : zeros_(i);
    for (Index j = 0; j < joints_; ++j) {
      const double factor = square_(i, j);
      if (same_value(factor, 0)) continue;
      out(i, 0) += factor * (factor > 0 ? lower(j) : upper(j));
      out(i, 1) += factor * (factor > 0 ? upper(j) : lower(j));
    }
  }
  return out;
}

VERNIER_IMPL std::vector<JointType> ControllerMap::types(std::span<const JointType> chain) const {
  if (same() || chain.empty()) return {chain.begin(), chain.end()};
  demand(static_cast<Index>(chain.size()) == square_.rows(), "ControllerMap: ", chain.size(),
         " types of joints, expected ", square_.rows());
  std::vector<JointType> out;
  for (int j = 0; j < joints_; ++j) {
    std::optional<JointType> type;
    for (std::size_t i = 0; i < chain.size(); ++i) {
      if (same_value(square_(static_cast<Index>(i), j), 0)) continue;
      demand(!type || *type == chain[i], "ControllerMap: controller joint ", j + 1,
             " moves revolute and prismatic joints");
      type = chain[i];
    }
    out.push_back(*type);
  }
  return out;
}

VERNIER_IMPL std::vector<std::string> ControllerMap::formulas(std::span<const JointType> chain) const {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const auto row = static_cast<Index>(i);
    std::string text = same() ? message('J', i + 1) : std::string();
    for (int j = 0; j < joints_; ++j) {
      const double factor = square_(row, j);
      if (same_value(factor, 0)) continue;
      text += text.empty() ? (factor < 0 ? "-" : "") : (factor < 0 ? " - " : " + ");
      if (!same_value(std::abs(factor), 1)) text += message(std::abs(factor), '*');
      text += message('J', j + 1);
    }
    if (const double zero = same() ? 0 : zeros_(row); !same_value(zero, 0)) {
      const bool revolute = chain[i] == JointType::revolute;
      const double size = std::abs(zero) * (revolute ? 180 / std::numbers::pi : 1e3);
      text += (text.empty() ? (zero < 0 ? "-" : "") : (zero < 0 ? " - " : " + ")) +
              detail::significant_digits(size, 12) + (revolute ? " deg" : " mm");
    }
    out.push_back(text.empty() ? "0 " + std::string(chain[i] == JointType::revolute ? "deg" : "mm") : text);
  }
  return out;
}

VERNIER_IMPL std::vector<std::string> ControllerMap::erring_joints(std::span<const JointType> chain) const {
  std::vector<std::string> of_chain = formulas(chain);
  if (same() || !motor_errors_) return of_chain;
  std::vector<std::string> out;
  for (int j = 0; j < joints_; ++j) out.push_back(message('J', j + 1));
  for (Index j = joints_; j < square_.cols(); ++j)
    for (Index i = 0; i < square_.rows(); ++i)
      if (!same_value(square_(i, j), 0)) out.push_back(of_chain[static_cast<std::size_t>(i)]);
  return out;
}

VERNIER_IMPL bool ControllerMap::operator==(const ControllerMap& other) const {
  if (joints_ != other.joints_ || square_.rows() != other.square_.rows() || motor_errors_ != other.motor_errors_)
    return false;
  for (Index k = 0; k < square_.size(); ++k)
    if (!same_value(square_.data()[k], other.square_.data()[k])) return false;
  for (Index k = 0; k < zeros_.size(); ++k)
    if (!same_value(zeros_(k), other.zeros_(k))) return false;
  return true;
}

}  // namespace vernier
