// SPDX-License-Identifier: BSD-3-Clause
// The text that exported arms have in common: it is C as it stands in its files, and is filled in for an arm.
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "run_command.hpp"
#include "temporary_folder.hpp"
#include "vernier/core/atomic_file.hpp"
#include "vernier/core/check.hpp"
#include "vernier/io/detail/c_code.hpp"
#include "vernier/io/detail/c_tables.hpp"

namespace vernier::c_text_test {
namespace {

constexpr const char* macros =
#include "c_text/macros.c"
    ;
constexpr const char* tables =
#include "c_text/tables.c"
    ;

using Features = std::set<std::string>;

/// All features that the text asks for, and sets of them as arms have them; together these compile every line.
const Features all{"CONTROLLER", "EXP",      "FALLBACK",     "GATES",     "GRAVITY",      "TRANSMISSION",
                   "HYSTERESIS", "LEARNED",  "LINEAR",       "LINKS",     "LOG",          "MAP_PRODUCTS",
                   "MAP_RAW",    "MODIFIED", "ORIENTED",     "PRISMATIC", "RADIAL_BASIS", "REDUNDANT",
                   "SIGMOID",    "SINE",     "SINES",        "TANH",      "TILT",         "MAP_SINES_AND_COSINES",
                   "PAYLOAD",    "MOTION",   "STRAIGHTNESS", "TORQUES",   "MOTORS",       "PAYLOAD_BEND"};
const std::vector<Features> arms{
    {},
    {"ORIENTED", "LOG", "LEARNED", "GATES", "SINES", "MAP_SINES_AND_COSINES", "TANH", "TRANSMISSION"},
    {"EXP",   "FALLBACK", "GATES",        "GRAVITY",      "TRANSMISSION", "HYSTERESIS", "LEARNED",   "LINEAR",
     "LINKS", "LOG",      "MAP_PRODUCTS", "MODIFIED",     "ORIENTED",     "PRISMATIC",  "REDUNDANT", "SIGMOID",
     "SINES", "TILT",     "MOTION",       "STRAIGHTNESS", "PAYLOAD",      "TORQUES"},
    {"REDUNDANT", "GRAVITY", "TORQUES", "LINKS", "LEARNED", "GATES", "MAP_RAW", "RADIAL_BASIS"},
    {"LEARNED", "GATES", "MAP_RAW", "SINE", "TILT", "MOTION", "LINKS", "EXP"},
    {"PRISMATIC", "STRAIGHTNESS", "MOTION", "PAYLOAD", "TORQUES", "LINKS", "EXP"},
    {"CONTROLLER"},
    {"CONTROLLER", "MOTORS", "TRANSMISSION"},
    {"CONTROLLER", "MOTORS", "GATES", "FALLBACK", "LOG", "EXP", "LINEAR", "HYSTERESIS", "PAYLOAD", "PAYLOAD_BEND",
     "MOTION", "LINKS", "TORQUES", "PRISMATIC"},
    {"CONTROLLER", "FALLBACK", "GATES", "LEARNED", "MAP_RAW", "SINE", "LOG", "EXP", "ORIENTED"}};

class CText : public ::testing::Test {
 protected:
  vernier_test::CommandResult run(const std::string& command) {
    return vernier_test::run_command("cd '" + folder_.path().string() + "'; " + command, folder_.path());
  }

  vernier_test::TemporaryFolder folder_{"c_text"};
};

// A file without its first and last lines, which are those of a string literal, is what the literal holds. Unknown
// features are errors.
TEST_F(CText, FilesCompileWithoutAWarning) {
  std::string text = message(macros, detail::c_declarations, detail::c_kinds("ARM"), detail::c_types, tables);
  for (const std::string_view functions : detail::c_functions) text += functions;
  write_file(folder_ / "text.h", text);
  write_file(folder_ / "text.c", "#include \"text.h\"\n");
  std::string left_out;
  for (const char* compiler : {"gcc", "clang"}) {
    if (run(message("command -v ", compiler)).exit_code != 0) {
      left_out = compiler;
      continue;
    }
    for (const char* mode : {"-std=c99 -O2 -c", "-std=c11 -fsyntax-only", "-x c++ -std=c++11 -fsyntax-only"})
      for (const Features& features : arms) {
        std::string command =
            message(compiler, ' ', mode, " -pedantic -Wall -Wextra -Wundef -Wconversion -Wshadow -Werror");
        for (const std::string& feature : all) command += message(" -DHAS_", feature, '=', features.count(feature));
        const auto done = run(command + " text.c");
        EXPECT_EQ(done.exit_code, 0) << command << '\n' << done.errors;
      }
  }
  if (!left_out.empty()) GTEST_SKIP() << left_out << " is not here; another compiler was content";
}

// A feature that is absent takes its lines along, whatever is around.
TEST_F(CText, IsFilledInByFeatures) {
  const char* text =
      "\na\n#if HAS_ONE\n1\n#if HAS_TWO\n2\n#else\nnot 2\n#endif\n#else\n#if HAS_TWO\nonly 2\n#endif\n#endif\n"
      "#if !HAS_TWO\nwithout\n#else\nwith\n#endif\nend\n";
  const auto filled = [&](const Features& features) { return detail::fill_in(text, "x", features); };
  EXPECT_EQ(filled({}), "\na\nwithout\nend\n");
  EXPECT_EQ(filled({"ONE"}), "\na\n1\nnot 2\nwithout\nend\n");
  EXPECT_EQ(filled({"TWO"}), "\na\nonly 2\nwith\nend\n");
  EXPECT_EQ(filled({"ONE", "TWO"}), "\na\n1\n2\nwith\nend\n");
  EXPECT_EQ(detail::fill_in("\n#if HAS_ONE\n1\n#endif\n", "x", {}), "");
}

// `arm` is a name only where an identifier begins with it and an underscore.
TEST_F(CText, IsFilledInWithAName) {
  EXPECT_EQ(
      detail::fill_in("\narm_arm_ *arm, the_arm_, ARM_N;\n#if HAS_A\narm_q(ARM_N)\n#endif\n", "cell3_Left", {"A"}),
      "\ncell3_Left_arm_ *arm, the_arm_, CELL3_LEFT_N;\ncell3_Left_q(CELL3_LEFT_N)\n");
  EXPECT_EQ(detail::with_name("/* arm, 2arm_, `arm_pose`*/ -arm_x", "arm_ARM_"),
            "/* arm, 2arm_, `arm_ARM__pose`*/ -arm_ARM__x");
}

}  // namespace
}  // namespace vernier::c_text_test
