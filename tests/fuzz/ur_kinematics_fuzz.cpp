// SPDX-License-Identifier: BSD-3-Clause
// Kinematics files of Universal Robots' driver: what is read can be written, and read again.
#include "reader_fuzz.hpp"
#include "vernier/urdf/ur_kinematics.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return vernier::fuzz::read_as_file(data, size, [](const std::string& path) {
    const vernier::UrKinematics once = vernier::read_ur_kinematics(path);
    const std::string text = once.text({});
    const vernier::fuzz::InputFile copy(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
    try {
      if (vernier::read_ur_kinematics(copy.path()).hash != once.hash) vernier::fuzz::finding("another hash", text);
    } catch (const vernier::DataError& error) {
      vernier::fuzz::finding("what was written is refused", error.what());
    }
    static_cast<void>(once.robot("arm"));
  });
}
