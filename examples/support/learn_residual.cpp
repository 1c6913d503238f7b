#include "calibration_stages.hpp"
#include "vernier/compensation/cartesian.hpp"
#include "vernier/regression/ridge_elm.hpp"
#include "vernier/search/pso.hpp"
#include "vernier/search/tuned.hpp"

namespace support {

namespace {

// 420 evaluations: more bring nothing that held-out poses would show
const vernier::Tuned pso_elm{
    vernier::RidgeElm{.hidden_nodes = 30},
    vernier::Pso{.particles = 20, .iterations = swarm_generations, .positions = vernier::PositionRule::clamped}};

}  // namespace

template <int N>
LearnedError<N> learn_residual(const vernier::ErrorModel<vernier::DhChain<N>>& model, const vernier::Dataset<N>& data,
                               const vernier::FitOptions& options) {
  const auto hybrid = vernier::CartesianCompensation{pso_elm}.fit(model, data, options);
  return {hybrid.best().learned(), hybrid.best().coverage()};
}

#define VERNIER_INSTANTIATE(N)                                                                \
  template LearnedError<N> learn_residual<N>(const vernier::ErrorModel<vernier::DhChain<N>>&, \
                                             const vernier::Dataset<N>&, const vernier::FitOptions&);
VERNIER_INSTANTIATE(3)
VERNIER_INSTANTIATE(4)
VERNIER_INSTANTIATE(5)
VERNIER_INSTANTIATE(6)
VERNIER_INSTANTIATE(7)
VERNIER_INSTANTIATE(8)
VERNIER_INSTANTIATE(9)
#undef VERNIER_INSTANTIATE

}  // namespace support
