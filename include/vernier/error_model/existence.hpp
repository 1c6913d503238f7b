// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Three answers on an effect of an arm: it is there, it is too small to matter, or the poses are too few to tell.

#include <array>
#include <string_view>
#include <vector>

#include "vernier/least_squares/score_test.hpp"

namespace vernier {

/// Answer on an effect.
enum class Answer {
  found,      ///< it exists
  ruled_out,  ///< if it exists, it is smaller than matters
  undecided,  ///< it may exist and matter; more poses would tell
  untested,   ///< the data cannot tell it from something else, however many there are
};

/// What an answer is called in files.
constexpr std::string_view name_of(Answer answer) {
  switch (answer) {
    case Answer::found: return "found";
    case Answer::ruled_out: return "ruled out";
    case Answer::undecided: return "undecided";
    case Answer::untested: break;
  }
  return "untested";
}

/// What the data say of an effect. Its size is the root mean square of the displacements of the tool point over the
/// measured poses, less what frames and the other unknowns take over.
struct Existence {
  Answer answer = Answer::untested;  ///< whether it exists
  double p = 1;                      ///< probability of such data without the effect
  double size = 0;                   ///< as likely to be exceeded as not [m]
  std::array<double, 2>
      interval{};           ///< holds it with 95 %; its end is the upper limit of an effect that was not found [m]
  double relevance = 0;     ///< from which size on it matters [m]
  Index poses = 0;          ///< with that many, an effect of that size is found with 80 %; 0 if never, or not known
  bool look_alike = false;  ///< whether it is undecided because another error of the joints may be there in its place
};

/// The answer on an effect.
/// @param score     of its unknowns
/// @param level     of the test: up to that p it exists
/// @param relevance from which size on it matters [m]
/// @param poses     number of poses
/// @param shapes    relative sizes that the unknowns may have, of those that are tested; empty: equal ones alone. The
///                  data weigh the shapes. Noise in many unknowns then adds less to the size.
VERNIER_API Existence existence(const ScoreTest& score, double level, double relevance, Index poses,
                                const std::vector<VectorX>& shapes = {});

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/existence.ipp"
#endif
