// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/data/contacts.hpp"

namespace vernier {

VERNIER_IMPL const char* name_of(ContactKind kind) {
  return kind == ContactKind::plane ? "plane" : kind == ContactKind::ball ? "ball" : "socket";
}

VERNIER_IMPL Contact::Contact(std::string name, ContactKind kind, MatrixX joints, VectorX known)
    : name_(std::move(name)), kind_(kind), joints_(std::move(joints)), known_(std::move(known)) {
  if (known_.size() == 0 && kind_ != ContactKind::ball) known_.setZero(joints_.rows());
  demand(kind_ != ContactKind::ball || known_.size() > 0, "contact ", name_, ": a ball without its radius");
  demand(known_.size() == joints_.rows(), "contact ", name_, ": ", joints_.rows(), " touches, but ", known_.size(),
         " known lengths");
  for (Index i = 0; i < size(); ++i) {
    demand(detail::all_finite(VERNIER_LATER(joints_).middleRows(i, 1)) && std::isfinite(known_(i)), "contact ", name_,
           ": touch ", i, " has a value that is not finite");
    demand(kind_ != ContactKind::ball || known_(i) > 0, "contact ", name_, ": touch ", i, " has a radius of ",
           known_(i), " m, must be positive");
  }
  const Index fewest = kind_ != ContactKind::socket ? 4 : has_length() ? 3 : 2;
  demand(size() >= fewest, "contact ", name_, ": ", counted(size(), "touch", "touches"), " of a ", name_of(kind_),
         ", at least ", fewest, " are needed: fewer say where it is, and nothing about the arm");
}

VERNIER_IMPL bool Contact::has_length() const {
  return size() > 0 &&
         (kind_ == ContactKind::ball || VERNIER_LATER(known_).minCoeff() < VERNIER_LATER(known_).maxCoeff());
}

}  // namespace vernier
