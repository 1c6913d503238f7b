// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// `vernier.Model`: a calibrated arm.

#include <memory>
#include <string>

#include "calibrated_arm.hpp"

namespace python {

/// A calibrated arm.
struct Model {
  std::shared_ptr<const support::CalibratedArm> arm;  ///< its kinematics and corrections
};

/// The arm of the text of a model file.
/// @param name in messages
/// @throws vernier::DataError on malformed text
Model model_of_text(const std::string& text, const std::string& name);

}  // namespace python
