// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/error_model/known_geometry.hpp"

namespace vernier {

VERNIER_IMPL KnownGeometry known_geometry(const ArmPrior& prior, const ArmGeometry& nominal) {
  demand(prior.nominal.joints() == nominal.joints() && prior.nominal.modified() == nominal.chain().modified(),
         prior.name, ": is of an arm of ", prior.nominal.joints(), " joints in the ",
         prior.nominal.modified() ? "modified" : "standard", " convention");
  const ErrorModelEstimate& before = prior.estimate;
  KnownGeometry out{.name = prior.name};
  out.values = nominal.parameters() + before.arm.geometry(0).parameters() -
               ArmGeometry(prior.nominal, before.arm.geometry(0).base(), before.arm.geometry(0).tool()).parameters();
  std::vector<Index> source;
  const std::vector<GeometricUnknown>& unknowns = before.arm.geometric();
  for (std::size_t k = 0; k < unknowns.size(); ++k) {
    const Index p = unknowns[k].parameter;
    if (unknowns[k].thermal || p < ArmParameters::chain_begin || p >= ArmParameters::chain_end(nominal.joints()))
      continue;
    out.parameters.push_back(p);
    source.push_back(static_cast<Index>(k));
  }
  const auto n = static_cast<Index>(source.size());
  out.covariance.resize(n, n);
  const VectorX scales = before.arm.scales();
  for (std::size_t j = 0; j < source.size(); ++j)
    for (std::size_t i = 0; i < source.size(); ++i)
      out.covariance(static_cast<Index>(i), static_cast<Index>(j)) =
          before.covariance(source[i], source[j]) * scales(source[i]) * scales(source[j]);
  return out;
}

VERNIER_IMPL std::vector<Contact> at_effective_joints(std::span<const Contact> contacts, const JointErrors& errors) {
  demand(errors.empty() || !errors.tilts(),
         "the earlier calibration has tilts of joint frames, links that bend, or guides that are not straight, which "
         "contacts cannot hold: use it beside measured poses");
  std::vector<Contact> out;
  for (const Contact& contact : contacts)
    out.push_back(errors.empty() ? contact
                                 : Contact(contact.name(), contact.kind(), errors.effective_rows(contact.joints()),
                                           contact.known())
                                       .from(contact.origin()));
  return out;
}

VERNIER_IMPL ErrorModelEstimate with_joint_errors_of(const ErrorModelEstimate& geometry,
                                                     const ErrorModelEstimate& earlier) {
  const JointErrors& errors = earlier.arm.joint_errors();
  if (errors.empty()) return geometry;
  ErrorModelEstimate out = geometry;
  const Index terms = earlier.arm.terms().size(), links = static_cast<Index>(geometry.arm.geometric().size()),
              before = earlier.covariance.rows() - terms;
  out.arm = detail::parameterised({geometry.arm.geometry(0), errors}, geometry.arm.geometric(),
                                  VERNIER_LATER(earlier.arm.scales()).tail(terms),
                                  VERNIER_LATER(earlier.arm.precisions()).tail(terms), VectorX());
  out.covariance = MatrixX::Zero(links + terms, links + terms);
  VERNIER_LATER(out.covariance).topLeftCorner(links, links) = geometry.covariance;
  for (Index c = 0; c < terms; ++c)
    for (Index r = 0; r < terms; ++r) out.covariance(links + r, links + c) = earlier.covariance(before + r, before + c);
  out.fallback_error = earlier.fallback_error;
  out.drives = earlier.drives;
  return out;
}

}  // namespace vernier
