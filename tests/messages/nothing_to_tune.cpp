// SPDX-License-Identifier: BSD-3-Clause
// A regressor without inner parameters, tuned.
// expect: `dimension(inputs)` must be const and return the number of inner parameters
#include <vernier/regression/elm.hpp>
#include <vernier/search/random_search.hpp>
#include <vernier/search/tuned.hpp>

#ifdef MISTAKE
struct Recipe {};
#else
using Recipe = vernier::Elm;
#endif

const vernier::Tuned tuned{Recipe{}, vernier::RandomSearch{}};
