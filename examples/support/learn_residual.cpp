#include "calibration_stages.hpp"
#include "dispatch.hpp"
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
VERNIER_FOR_ALL_DOF(VERNIER_INSTANTIATE)
#undef VERNIER_INSTANTIATE

}  // namespace support
