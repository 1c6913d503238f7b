// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Contacts: joint values at which the tool point touches a plane, a ball or a socket whose place need not be known.

#include <string>

#include "vernier/core/types.hpp"
#include "vernier/data/row_origin.hpp"

namespace vernier {

/// What is touched.
enum class ContactKind {
  plane,   ///< a flat face, or parallel faces at known distances (a gauge block on a plate)
  ball,    ///< a sphere of known radius
  socket,  ///< a point that is visited repeatedly, or points along a line at known distances (a bar with sockets)
};

/// What a kind of contact is called in a file: plane, ball, socket.
VERNIER_API const char* name_of(ContactKind kind);

/// n touches of one object by the tool point of an arm. Known lengths of the object are what makes the scale of an arm
/// observable: the radius of a ball, the distance of parallel faces, the distance of sockets on a bar.
class Contact {
 public:
  /// @param name   how messages name it
  /// @param kind   what is touched
  /// @param joints n x number of joints [rad, m]; a plane or a ball needs 4 touches, a socket 2, a bar of sockets 3
  /// @param known  n lengths [m]: of a ball its radius, with that of the probe's tip; of faces the height above the
  ///               first one (all touched from the same side); of sockets the distance from the first one along the
  ///               bar. None: all 0, one face or one socket
  /// @throws std::invalid_argument naming the contact, for too few touches, another number of lengths, a value that is
  ///         not finite or a radius that is not positive
  VERNIER_API Contact(std::string name, ContactKind kind, MatrixX joints, VectorX known = VectorX());

  /// How messages name it.
  const std::string& name() const { return name_; }
  /// What is touched.
  ContactKind kind() const { return kind_; }
  /// Number of touches.
  Index size() const { return joints_.rows(); }
  /// Joint values of the touches [rad, m], n x number of joints.
  const MatrixX& joints() const { return joints_; }
  /// Known lengths [m], n; see the constructor.
  const VectorX& known() const { return known_; }
  /// Where the touches stand in a file; empty where they are from none.
  const RowOrigin& origin() const { return origin_; }
  /// These touches, said to be from some rows of a file.
  VERNIER_API Contact from(RowOrigin origin) const {
    Contact out = *this;
    out.origin_ = std::move(origin);
    return out;
  }
  /// Whether it has a known length: a ball, or faces or sockets at several distances.
  VERNIER_API bool has_length() const;

 private:
  std::string name_;
  ContactKind kind_;
  MatrixX joints_;
  VectorX known_;
  RowOrigin origin_{};
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/data/contacts.ipp"
#endif
