// SPDX-License-Identifier: BSD-3-Clause
// Learn an error from samples: an extreme learning machine (ELM) draws its hidden weights and solves for the others.

#include <cstdio>
#include <vernier/kinematics/robots.hpp>
#include <vernier/regression/elm.hpp>
#include <vernier/regression/ridge_elm.hpp>
#include <vernier/simulation/sampling.hpp>
#include <vernier/simulation/virtual_robot.hpp>

namespace vn = vernier;

int main() {
  // A robot as built differs from its drawing by tenths of a millimetre and milliradians. Here it is simulated.
  const auto nominal = vn::robots::abb_irb120().chain;
  const auto actual = vn::with_geometric_errors(nominal, {}, /*seed=*/1);

  // What we measure: tool positions at 1000 joint combinations. What we learn: how far the nominal model is off there.
  const auto region = vn::abb_irb120_operating_region();
  const auto train = vn::measure(actual, region.sample(nominal, 1000, 1), {.position = 0.03e-3});
  const auto test = vn::measure(actual, region.sample(nominal, 500, 2));
  const vn::PointRows error = vn::positions(nominal, train.joints()) - train.positions();
  const vn::PointRows fresh = vn::positions(nominal, test.joints()) - test.positions();

  const auto left = [&](const auto& recipe) {
    // A recipe is a plain value; fit() gives a predictor, and there is no half-trained state in between.
    const auto predictor = recipe.fit(train.joints(), error, {.seed = 1});
    return (predictor.predict(test.joints()) - fresh).rowwise().norm().mean() * 1e3;
  };
  std::printf("Mean error on 500 fresh poses, learned from 1000 with 0.03 mm noise:\n");
  std::printf("  nothing learned                        %.3f mm\n", fresh.rowwise().norm().mean() * 1e3);
  for (const int nodes : {20, 65, 200})
    std::printf("  ELM, %3d nodes, raw angles             %.3f mm\n", nodes, left(vn::Elm{.hidden_nodes = nodes}));

  // Joint angles come around: their sines and cosines are better inputs. And with many nodes a ridge on the output
  // weights, chosen by leave-one-out, keeps noise from being learned.
  const auto circular = vn::InputMap::sines_and_cosines;
  std::printf("  ELM, 200 nodes, sines and cosines      %.3f mm\n",
              left(vn::Elm{.hidden_nodes = 200, .input_map = circular}));
  std::printf("  ridge ELM, 300 nodes                   %.3f mm\n", left(vn::RidgeElm{.hidden_nodes = 300}));
}
