#pragma once

/// @file
/// What predictors that sum over nodes or kernels have in common: one mapped sample in, sums of vectors out.

#include "vernier/core/simd.hpp"
#include "vernier/regression/hidden_layer.hpp"

namespace vernier::detail {

/// What a hidden layer or a kernel sees of one sample.
template <int Inputs>
struct MappedSample {
  double value[2 * Inputs];  ///< mapped and scaled; the second half is zero where inputs stay raw
  double sine[Inputs];       ///< of the inputs, where they are mapped so
  double cosine[Inputs];     ///< likewise

  /// Maps and scales.
  template <class Derived>
  MappedSample(InputMap map, const ColumnScaling& scaling, const Eigen::MatrixBase<Derived>& sample) noexcept {
    const Eigen::Matrix<double, Inputs, 1> x = sample;
    const bool raw = map == InputMap::raw;
    if (!raw) sines_and_cosines<Inputs>(x.data(), sine, cosine);
    const auto scaled = [&](Index j, double v) { return (v - scaling.offset(j)) * scaling.factor(j); };
    for (int j = 0; j < Inputs; ++j) {
      value[j] = scaled(j, raw ? x(j) : sine[j]);
      value[Inputs + j] = raw ? 0 : scaled(Inputs + j, cosine[j]);
    }
  }
};

/// Sums over nodes or kernels: values, and their derivatives with respect to each feature. They are kept in as many
/// parts as the widest vector has lanes, so that a term is added without going across a vector.
template <int Inputs, int Outputs>
struct LaneSums {
  static constexpr int lanes = 8;
  double output[Outputs][lanes], by_feature[2 * Inputs][Outputs][lanes];

  /// Adds a vector to parts of a sum.
  template <int W>
  VERNIER_INLINE static void add(double* to, const typename Simd<W>::Double& more) {
    typename Simd<W>::Double sum;
    load<W>(sum, to);
    sum += more;
    store<W>(to, sum);
  }

  /// Values, added to an offset.
  Eigen::Matrix<double, Outputs, 1> total(Eigen::Matrix<double, Outputs, 1> offset) const noexcept {
    for (int o = 0; o < Outputs; ++o) offset(o) += added(output[o]);
    return offset;
  }

  /// Derivatives with respect to the inputs, through scaling and map, outputs x inputs.
  Eigen::Matrix<double, Outputs, Inputs> slope(InputMap map, const ColumnScaling& scaling,
                                               const MappedSample<Inputs>& at) const noexcept {
    Eigen::Matrix<double, Outputs, Inputs> out;
    for (int j = 0; j < Inputs; ++j)
      for (int o = 0; o < Outputs; ++o) {
        out(o, j) = added(by_feature[j][o]) * scaling.factor(j);
        if (map == InputMap::sines_and_cosines)
          out(o, j) =
              out(o, j) * at.cosine[j] - added(by_feature[Inputs + j][o]) * scaling.factor(Inputs + j) * at.sine[j];
      }
    return out;
  }

 private:
  static double added(const double (&parts)[lanes]) noexcept {
    return ((parts[0] + parts[4]) + (parts[2] + parts[6])) + ((parts[1] + parts[5]) + (parts[3] + parts[7]));
  }
};

}  // namespace vernier::detail
