#pragma once

/// @file
/// A map of the inputs in front of any regressor.

#include <array>
#include <concepts>
#include <utility>

#include "vernier/core/box.hpp"
#include "vernier/core/simd.hpp"
#include "vernier/regression/concepts.hpp"

namespace vernier {

/// What a regressor is shown in place of its inputs.
///
/// - `features(inputs)`: their number, constexpr
/// - `map(x)`: the features of one sample; does not allocate or throw
/// - `derivative(x)`: features x inputs, the exact derivative at x; does not allocate or throw
template <class M>
concept FeatureMap = std::copyable<M> && requires(const M& map, const Eigen::Matrix<double, 3, 1>& x) {
  requires(M::features(3) >= 1);
  { map.map(x) }
  noexcept->std::same_as<Eigen::Matrix<double, M::features(3), 1>>;
  { map.derivative(x) }
  noexcept->std::same_as<Eigen::Matrix<double, M::features(3), 3>>;
};

/// The inputs themselves.
struct RawAngles {
  /// As many as inputs.
  static constexpr int features(int inputs) { return inputs; }
  /// x.
  template <int N>
  Eigen::Matrix<double, N, 1> map(const Eigen::Matrix<double, N, 1>& x) const noexcept {
    return x;
  }
  /// The identity.
  template <int N>
  Eigen::Matrix<double, N, N> derivative(const Eigen::Matrix<double, N, 1>&) const noexcept {
    return Eigen::Matrix<double, N, N>::Identity();
  }
};

/// Sines of all inputs, then cosines of all: right for joint angles [rad], needs no range.
struct SinesAndCosines {
  /// Two an input.
  static constexpr int features(int inputs) { return 2 * inputs; }
  /// sin x_1, sin x_2, ..., cos x_1, cos x_2, ...
  template <int N>
  Eigen::Matrix<double, 2 * N, 1> map(const Eigen::Matrix<double, N, 1>& x) const noexcept {
    Eigen::Matrix<double, 2 * N, 1> out;
    detail::sines_and_cosines<N>(x.data(), out.data(), out.data() + N);
    return out;
  }
  /// Of those, 2 N x N.
  template <int N>
  Eigen::Matrix<double, 2 * N, N> derivative(const Eigen::Matrix<double, N, 1>& x) const noexcept {
    const Eigen::Matrix<double, 2 * N, 1> at = map(x);
    Eigen::Matrix<double, 2 * N, N> out = Eigen::Matrix<double, 2 * N, N>::Zero();
    for (int j = 0; j < N; ++j) {
      out(j, j) = at(N + j);
      out(N + j, j) = -at(j);
    }
    return out;
  }
};

/// All products of sines and cosines of at most `Degree` different inputs [rad], the empty one left out: of six inputs
/// 12, 72, 232 up to degree 1, 2, 3. Features are ordered as the numbers whose digits to base 3, the first input's
/// being the most significant, are 0, 1 and 2 for no factor, the sine and the cosine.
template <int Degree>
class SineCosineProducts {
  static_assert(Degree >= 1);

 public:
  /// The sum over d from 1 to `Degree` of 2^d times (inputs choose d).
  static constexpr int features(int inputs) {
    int sum = 0, term = 1;
    for (int d = 1; d <= Degree && d <= inputs; ++d) sum += term = term * 2 * (inputs - d + 1) / d;
    return sum;
  }

  /// The features.
  template <int N>
  Eigen::Matrix<double, features(N), 1> map(const Eigen::Matrix<double, N, 1>& x) const noexcept {
    double factor[2][N];
    detail::sines_and_cosines<N>(x.data(), factor[0], factor[1]);
    Eigen::Matrix<double, features(N), 1> out;
    for (int f = 0; f < features(N); ++f) {
      const Product& p = products<N>[static_cast<std::size_t>(f)];
      out(f) = (p.rest < 0 ? 1 : out(p.rest)) * factor[p.cosine][p.input];
    }
    return out;
  }

  /// Of those, features x N, by the product rule.
  template <int N>
  Eigen::Matrix<double, features(N), N> derivative(const Eigen::Matrix<double, N, 1>& x) const noexcept {
    double factor[2][N];
    detail::sines_and_cosines<N>(x.data(), factor[0], factor[1]);
    double value[features(N)];
    Eigen::Matrix<double, features(N), N> out = Eigen::Matrix<double, features(N), N>::Zero();
    for (int f = 0; f < features(N); ++f) {
      const Product& p = products<N>[static_cast<std::size_t>(f)];
      const double rest = p.rest < 0 ? 1 : value[p.rest];
      value[f] = rest * factor[p.cosine][p.input];
      for (int j = 0; p.rest >= 0 && j < p.input; ++j) out(f, j) = out(p.rest, j) * factor[p.cosine][p.input];
      out(f, p.input) = rest * (p.cosine == 0 ? factor[1][p.input] : -factor[0][p.input]);
    }
    return out;
  }

 private:
  /// A feature: one before it times a sine or a cosine of the last of its inputs.
  struct Product {
    int rest;  // -1: one
    int input, cosine;
  };

  template <int N>
  static constexpr std::array<Product, features(N)> make_products() {
    std::array<Product, features(N)> out{};
    std::array<int, power_of_three(N)> place{};  // among the features, of each number
    for (int number = 1, f = 0; number < power_of_three(N); ++number) {
      int degree = 0, last = 0, last_digit = 0, unit = 1;
      for (int j = N - 1, digits = number; j >= 0; --j, digits /= 3) {
        if (digits % 3 == 0) continue;
        if (++degree > 1) continue;
        last = j;
        last_digit = digits % 3;
        unit = power_of_three(N - 1 - j);
      }
      if (degree > Degree) continue;
      const int rest = degree == 1 ? -1 : place[static_cast<std::size_t>(number - last_digit * unit)];
      out[static_cast<std::size_t>(f)] = {rest, last, last_digit - 1};
      place[static_cast<std::size_t>(number)] = f++;
    }
    return out;
  }

  static constexpr int power_of_three(int n) { return n == 0 ? 1 : 3 * power_of_three(n - 1); }

  template <int N>
  static constexpr std::array<Product, features(N)> products = make_products<N>();
};

/// A predictor behind a map of its inputs.
template <FeatureMap Map, Predictor P, int Inputs>
class FeaturePredictor {
  static_assert(P::inputs == Map::features(Inputs));

 public:
  /// Number of inputs.
  static constexpr int inputs = Inputs;
  /// Number of outputs.
  static constexpr int outputs = P::outputs;
  /// One sample.
  using Input = Eigen::Matrix<double, inputs, 1>;
  /// One prediction.
  using Output = Eigen::Matrix<double, outputs, 1>;

  /// Joins the two.
  FeaturePredictor(const Map& map, P predictor) : map_(map), predictor_(std::move(predictor)) {}

  /// One sample.
  template <class Derived>
    requires detail::SampleOf<Derived, Inputs> Output predict(const Eigen::MatrixBase<Derived>& x)
  const noexcept { return predictor_.predict(map_.map(Input(x))); }

  /// Samples as rows, n x inputs to n x outputs.
  template <class Derived>
    requires detail::SampleRowsOf<Derived, Inputs> Eigen::Matrix<double, Eigen::Dynamic, outputs> predict(
        const Eigen::MatrixBase<Derived>& x)
  const {
    Eigen::Matrix<double, Eigen::Dynamic, outputs> y(x.rows(), outputs);
    for (Index i = 0; i < x.rows(); ++i) y.row(i) = predict(Input(x.row(i).transpose())).transpose();
    return y;
  }

  /// d predict / d x at one sample, by the chain rule.
  template <class Derived>
    requires detail::SampleOf<Derived, Inputs> Eigen::Matrix<double, outputs, inputs> derivative(
        const Eigen::MatrixBase<Derived>& x)
  const noexcept {
    return predictor_.derivative(map_.map(Input(x))).lazyProduct(map_.derivative(Input(x)));  // others may allocate
  }

  /// Of each predicted output.
  template <class Derived>
    requires detail::SampleOf<Derived, Inputs> && UncertainPredictor<P> Output
    standard_deviation(const Eigen::MatrixBase<Derived>& x)
  const noexcept { return predictor_.standard_deviation(map_.map(Input(x))); }

  /// The map.
  const Map& map() const { return map_; }
  /// What stands behind it.
  const P& predictor() const { return predictor_; }

 private:
  Map map_;
  P predictor_;
};

namespace detail {

/// A recipe whose inner parameters can be searched for.
template <class R>
concept HasInnerParameters = requires(const R& regressor) {
  { regressor.dimension(1) } -> std::convertible_to<Index>;
  { regressor.box(1) } -> std::same_as<Box>;
};

}  // namespace detail

/// A regressor that is shown features of its inputs: `OnFeatures{SineCosineProducts<2>{}, RidgeElm{.input_map =
/// InputMap::raw}}`, lest the ELM take sines of products. It can be tuned where its regressor can.
template <FeatureMap Map, Regressor R>
struct OnFeatures {
  /// Features of samples, one a row.
  template <class X>
  using Features = Eigen::Matrix<double, Eigen::Dynamic, Map::features(X::ColsAtCompileTime)>;
  /// Targets, one sample a row.
  template <class Y>
  using Targets = Eigen::Matrix<double, Eigen::Dynamic, Y::ColsAtCompileTime>;

  /// What the regressor is shown.
  Map map;
  /// What learns.
  R regressor;

  /// The regressor's fit on the features of all samples.
  /// @param inputs  n x inputs
  /// @param targets n x outputs
  /// @param options the regressor's
  template <class X, class Y>
  FeaturePredictor<Map, PredictorOf<R, Map::features(X::ColsAtCompileTime), Y::ColsAtCompileTime>, X::ColsAtCompileTime>
  fit(const Eigen::MatrixBase<X>& inputs, const Eigen::MatrixBase<Y>& targets, const FitOptions& options = {}) const {
    return {map, regressor.fit(mapped(inputs), Targets<Y>(targets), options)};
  }

  /// Length of the vector that a search moves.
  Index dimension(int inputs) const requires detail::HasInnerParameters<R> {
    return regressor.dimension(Map::features(inputs));
  }
  /// Where a search looks.
  Box box(int inputs) const requires detail::HasInnerParameters<R> { return regressor.box(Map::features(inputs)); }

  /// The regressor's objective on the features of all samples, which it must not refer to. It takes options where the
  /// regressor's does.
  template <class X, class Y, detail::HasInnerParameters Inner = R, class... Options>
  auto objective(const Eigen::MatrixBase<X>& inputs, const Eigen::MatrixBase<Y>& targets,
                 const Options&... options) const
      -> decltype(std::declval<const Inner&>().objective(std::declval<const Features<X>&>(),
                                                         std::declval<const Targets<Y>&>(), options...)) {
    return regressor.objective(mapped(inputs), Targets<Y>(targets), options...);
  }

  /// The regressor's fit at one vector that a search found. It takes options where the regressor's does.
  template <class X, class Y, detail::HasInnerParameters Inner = R, class... Options>
  auto fit_at(const Eigen::MatrixBase<X>& inputs, const Eigen::MatrixBase<Y>& targets, const VectorX& theta,
              const Options&... options) const
      -> FeaturePredictor<Map,
                          decltype(std::declval<const Inner&>().fit_at(std::declval<const Features<X>&>(),
                                                                       std::declval<const Targets<Y>&>(), theta,
                                                                       options...)),
                          X::ColsAtCompileTime> {
    return {map, regressor.fit_at(mapped(inputs), Targets<Y>(targets), theta, options...)};
  }

 private:
  template <class X>
  Features<X> mapped(const Eigen::MatrixBase<X>& inputs) const {
    constexpr int n = X::ColsAtCompileTime;
    static_assert(n != Eigen::Dynamic, "the number of inputs is a compile-time constant");
    Features<X> out(inputs.rows(), Map::features(n));
    for (Index i = 0; i < inputs.rows(); ++i)
      out.row(i) = map.map(Eigen::Matrix<double, n, 1>(inputs.row(i).transpose())).transpose();
    return out;
  }
};

/// Deduction guide, for compilers that have none for aggregates.
template <class Map, class R>
OnFeatures(Map, R) -> OnFeatures<Map, R>;

}  // namespace vernier
