// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The outcome of an identification from contacts: what was touched, and what touches cannot observe.

#include <string>
#include <vector>

#include "vernier/data/contacts.hpp"
#include "vernier/identification/calibrated.hpp"
#include "vernier/identification/identification_report.hpp"

namespace vernier {

/// An object that was touched, as estimated, in the base frame of the nominal arm.
struct TouchedObject {
  std::string name;   ///< its name
  ContactKind kind;   ///< what it is
  Index touches = 0;  ///< number of touches
  Vector3 point;      ///< of a plane the point nearest to the middle of its touches; centre of a ball; first socket [m]
  Vector3 direction;  ///< normal of a plane, direction of a bar of sockets, unit vectors; zero for one without
  double rms = 0;     ///< of the residuals of its touches, per measured value [m]
};

/// A touch that is many times as far off as others of its kind, predicted without it: it slipped, or is of another
/// object.
struct SuspectTouch {
  std::string contact;  ///< name of the object
  Index touch = 0;      ///< which one of its touches, from 0
  std::string where;    ///< file and line, or row
  double error = 0;     ///< distance from the object [m]
  double factor = 0;    ///< the same in robust standard deviations of touches of as many measured values
};

/// Everything of an identification from contacts but the model. `rms_before` and `rms_after` are those of touches, per
/// measured value: across a face or a ball, or a component of the distance from a socket.
///
/// Contacts observe the arm relative to what it touches. A direction in the space of all unknowns (base, objects, tool,
/// chain) is unobservable where its singular value is zero: it changes no touch.
struct ContactReport : IdentificationReport {
  std::vector<TouchedObject> objects{};  ///< what was touched
  std::vector<SuspectTouch>
      suspects{};                ///< touches that deserve a look, the worst first; robust losses weigh them down
  bool scale_observable = true;  ///< whether a known length, or a joint that slides, determines the arm's scale
  VectorX singular_values{};     ///< of touches that lie on their objects, with respect to all unknowns in steps of
                                 ///< expected sizes, largest first
  Index unobservable = 0;        ///< number of unobservable directions: zero singular values
  /// Errors that touches share, in the covariance: places of sockets and faces, radii of balls [m]; 0 where unknown.
  double object_sigma = 0;
  double joint_sigma = 0;  ///< likewise: of a joint, once a turn [rad]
  /// What the covariance of the estimates would be if touches shared no errors, in the order of `covariance`.
  MatrixX independent_covariance{};
  std::string prior{};      ///< name of an earlier calibration that was the prior; empty for none
  double prior_change = 0;  ///< how much of the expected sizes of errors has changed since, see `KnownGeometry`
  Index missing = 0;  ///< how many directions of the arm measured positions at the same joints would determine, but
                      ///< these contacts do not, apart from base and scale; above 0: touch more, or other, objects

  /// What contacts do not observe, a sentence each.
  VERNIER_API std::vector<std::string> unobserved() const;
  /// The outcome in plain words, a few lines.
  VERNIER_API std::string summary() const;
};

/// An arm identified from contacts, in the base frame of the nominal one.
template <KinematicModel Model>
struct IdentifiedByContacts : ContactReport {
  Calibrated<Model> model;  ///< usable as any kinematic model

  /// Joins the two.
  IdentifiedByContacts(ContactReport report, const Calibrated<Model>& arm)
      : ContactReport(std::move(report)), model(arm) {}
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/identification/contact_report.ipp"
#endif
