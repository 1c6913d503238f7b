// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// How programs speak to people: quietly if asked, and with colours where a terminal shows them.

#include <string>

namespace support {

/// From here on standard output takes nothing for people, and no progress is shown.
/// @throws std::runtime_error where the system has no /dev/null
void be_quiet();

/// Whether `be_quiet` was called.
bool is_quiet();

/// How a text stands out.
enum class Look { strong, good, bad };

/// A text that stands out on a terminal, and is as it was elsewhere, with NO_COLOR in the environment
/// (https://no-color.org) or on a terminal that has no colours. The text must say the same without.
/// @param stream descriptor that it is printed to
std::string styled(const std::string& text, Look look, int stream = 1);

}  // namespace support
