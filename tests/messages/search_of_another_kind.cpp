// SPDX-License-Identifier: BSD-3-Clause
// No search at all, tuning a regressor.
// expect: the search needs a type `State`, what one generation hands to the next
#include <vernier/regression/elm.hpp>
#include <vernier/search/random_search.hpp>
#include <vernier/search/tuned.hpp>

#ifdef MISTAKE
struct Search {};
#else
using Search = vernier::RandomSearch;
#endif

const vernier::Tuned tuned{vernier::Elm{}, Search{}};
