// SPDX-License-Identifier: BSD-3-Clause
// Geometry written into URDF files: what changes, what stays, and what others read.
#include "vernier/urdf/export_urdf.hpp"

#include <gtest/gtest.h>

#include <regex>

#include "complaint.hpp"
#include "larger.hpp"
#include "real_matrix.hpp"
#include "replaced.hpp"
#include "urdf_samples.hpp"
#include "vernier/core/version.hpp"
#include "vernier/urdf/detail/origin_patch.hpp"

namespace vernier::export_urdf_test {
namespace {

ExportNote note() {
  ExportNote out{"my -- arm", "measured.csv", "2026-01-02", 80, "jointwise", {}, {}};
  out.error_full.n = out.error_exported.n = 20;
  out.error_full.mean = 0.0000612;
  out.error_exported.mean = 0.0001234;
  return out;
}

/// A text without origins and without the exported comment.
std::string without_origins(std::string text) {
  const std::size_t comment = text.find("\n  <!-- geometry of ");
  if (comment != std::string::npos) text.erase(comment, text.find("-->", comment) + 3 - comment);
  return std::regex_replace(text, std::regex("\\s*<origin[^>]*>(</origin>)?"), "");
}

/// Rows, and frames where asked, moved by what arms are made with and more.
ArmGeometry moved(const UrdfChain& chain, Rng& rng, double size, bool frames) {
  const ArmGeometry nominal = chain.robot.geometry();
  VectorX p = nominal.parameters();
  const Index rows_end = 6 + 5 * (nominal.joints() - 1);
  for (Index i = frames ? 0 : 6; i < (frames ? p.size() : rows_end); ++i) p(i) += rng.uniform(-size, size);
  if (!frames) p(rows_end + 3) += rng.uniform(-size, size);  // theta of the last row turns its joint
  const ArmGeometry out = nominal.with_parameters(p);
  return frames ? out : out.with_frames(nominal.base(), nominal.tool());
}

double worst_difference(const ArmGeometry& a, const ArmGeometry& b, Rng& rng, int samples) {
  MatrixX q(samples, a.joints());
  for (Index i = 0; i < q.size(); ++i) q(i) = rng.uniform(-3, 3);
  const auto left = a.poses(q), right = b.poses(q);
  double worst = 0;
  for (std::size_t i = 0; i < left.size(); ++i)
    worst = vernier_test::larger(worst, vernier_test::difference(left[i], right[i]));
  return worst;
}

struct Sample {
  const std::string& text;
  const char *base, *tip;
};

std::vector<Sample> samples() {
  return {{vernier_test::ur_like_urdf(), "base_link", "tool0"},
          {vernier_test::abb_like_urdf(), "base_link", "tool0"},
          {vernier_test::seven_axis_urdf(), "link_0", "link_7"}};
}

TEST(ExportUrdf, ReadsBackAsTheSameArm) {
  Rng rng(1);
  for (const Sample& sample : samples()) {
    const UrdfChain chain = parse_urdf(sample.text, "in", sample.base, sample.tip);
    for (const double size : {1e-3, 0.3}) {
      const bool frames = chain.tip_link == "tool0" && size < 0.1;
      const ArmGeometry arm = moved(chain, rng, size, frames);
      const UrdfChain back = parse_urdf(export_urdf(chain, arm, note()), "out", sample.base, sample.tip);
      EXPECT_LE(worst_difference(arm, back.robot.geometry(), rng, 1000), 1e-12) << sample.tip << size;
      EXPECT_EQ(back.robot.limits, chain.robot.limits);
      EXPECT_EQ(back.joints, chain.joints);
    }
  }
}

TEST(ExportUrdf, EveryByteOutsideOfOriginsStays) {
  Rng rng(2);
  for (const Sample& sample : samples()) {
    const UrdfChain chain = parse_urdf(sample.text, "in", sample.base, sample.tip);
    const std::string out = export_urdf(chain, moved(chain, rng, 1e-3, false), note());
    EXPECT_EQ(without_origins(out), without_origins(sample.text));
    EXPECT_NE(out, sample.text);
    // fixed joints, other branches and pictures are as they were
    for (const char* line : {"<origin xyz=\"0 0 0\" rpy=\"0 0 3.141592653589793\"/>\n      <geometry>",
                             "<joint name=\"flange-tool0\" type=\"fixed\">\n    <origin rpy=\"1.5707963267948966 0 "
                             "1.5707963267948966\" xyz=\"0 0 0\"/>",
                             "<origin xyz='0.01 0 0.02' rpy='0 0 0.3'/>", "<origin  rpy='", "'\r\n\t\txyz='",
                             "<!-- an arm with <origin> in a comment -->"})
      EXPECT_EQ(out.find(line) == std::string::npos, sample.text.find(line) == std::string::npos) << line;
  }
}

TEST(ExportUrdf, AnUnchangedArmChangesNoByteButTheComment) {
  for (const Sample& sample : samples()) {
    const UrdfChain chain = parse_urdf(sample.text, "in", sample.base, sample.tip);
    std::string out = export_urdf(chain, chain.robot.geometry(), note());
    const std::size_t comment = out.find("\n  <!-- geometry of ");
    ASSERT_NE(comment, std::string::npos);
    out.erase(comment, out.find("-->", comment) + 3 - comment);
    EXPECT_EQ(out, sample.text);
  }
}

TEST(ExportUrdf, TheCommentSaysWhatItIsAndHowGood) {
  const UrdfChain chain = parse_urdf(vernier_test::seven_axis_urdf(), "in");
  const std::string out = export_urdf(chain, chain.robot.geometry(), note());
  for (const char* words :
       {"geometry of my - - arm, calibrated by Vernier ", "2026-01-02", "fitted to 80 poses", "of 20 held-out poses",
        "this file: mean 0.123 mm", "full model (jointwise): mean 0.061 mm", "corrected twice"})
    EXPECT_NE(out.find(words), std::string::npos) << words;
  const std::string twice = export_urdf(parse_urdf(out, "again"), chain.robot.geometry(), note());
  EXPECT_EQ(parse_urdf(twice, "twice").robot.rows, chain.robot.rows);
}

TEST(ExportUrdf, OriginsThatAreMissingArePutIn) {
  const std::string text =
      "<robot name='two'><link name='a'/><link name='b'/><link name='c'/><link name='d'/>\n"
      "  <joint name='empty' type='revolute'>\n    <origin/>\n    <parent link='a'/><child link='b'/><axis xyz='0 0 "
      "1'/>\n  </joint>\n"
      "  <joint name='none' type='revolute'>\n    <parent link='b'/><child link='c'/><axis xyz='0 1 0'/>\n  </joint>\n"
      "  <joint name='fixed' type='fixed'><parent link='c'/><child link='d'/></joint></robot>";
  const UrdfChain chain = parse_urdf(text, "in");
  Rng rng(3);
  const ArmGeometry arm = moved(chain, rng, 0.1, true);
  const std::string out = export_urdf(chain, arm, note());
  EXPECT_LE(worst_difference(arm, parse_urdf(out, "out").robot.geometry(), rng, 100), 1e-12);
  EXPECT_NE(out.find("<joint name='none' type='revolute'>\n    <origin xyz=\""), std::string::npos) << out;
  EXPECT_NE(out.find("\"/>\n    <parent link='b'/>"), std::string::npos) << out;
  EXPECT_NE(out.find("<origin xyz=\""), std::string::npos);
}

TEST(ExportUrdf, TheNoteSaysEveryNumberInItsPlace) {
  ExportNote out{"arm\n\x7f", "a\tb.csv", "2026\xc3\xa9", 80, "joint\rwise", {}, {}};
  out.error_full.n = 21;
  out.error_full.mean = 0.0000612;
  out.error_full.p95 = 0.0001326;
  out.error_full.max = 0.002;
  out.error_exported.n = 20;
  out.error_exported.mean = 0.0001234;
  out.error_exported.p95 = 0.0003004;
  out.error_exported.max = 0.0104997;
  EXPECT_EQ(out.lines(),
            (std::vector<std::string>{
                message("geometry of arm??, calibrated by Vernier ", VERNIER_VERSION_MAJOR, ".", VERNIER_VERSION_MINOR,
                        ".", VERNIER_VERSION_PATCH, ", 2026??"),
                "fitted to 80 poses of a?b.csv; position errors of 21 held-out poses:",
                "this file: mean 0.123 mm, 95 % 0.3 mm, max 10.5 mm",
                "full model (joint?wise): mean 0.061 mm, 95 % 0.133 mm, max 2 mm",
                "Do not send commands that were corrected by that model to whatever uses this file: they would be "
                "corrected twice."}));
}

// Elements called joint or origin elsewhere, in comments and in texts are no joints and no origins; nor do signs in
// quoted values end a tag.
TEST(ExportUrdf, OnlyOriginsOfJointsAreTouched) {
  const std::string text =
      "<?xml version='1.0'?>\n<?note <joint name='x'> ?>\n<robot name='two'><link name='a'/><link "
      "name='b'><visual><origin "
      "xyz='9 9 9'/></visual></link><link name='c'/>\n"
      "<transmission name='t'><joint name='one'><origin xyz='7 7 7'/></joint></transmission>\n"
      "<!-- <joint name='z'><origin xyz='6 6 6'/> -->\n"
      "<joint name='one' type='revolute' note='a > b'>"
      "<parent link='a'/><child link='b'/><axis xyz='0 0 1'/><origin xyz='1 0 0'/>"
      "<sensor><origin xyz='8 8 8'/></sensor><![CDATA[ > <origin xyz='5 5 5'/> ]]></joint>\n"
      "<joint name='two' type='fixed'><parent link='b'/><child link='c'/><origin xyz='0 0 2' rpy='0 0 0'/></joint>"
      "</robot>\n";
  const UrdfChain chain = parse_urdf(text, "in");
  const ArmGeometry arm = chain.robot.geometry();
  Isometry3 base = arm.base().isometry(), tool = arm.tool().isometry();
  base.translation().y() += 0.25;
  tool.translation().z() += 0.5;
  std::string expected = text;
  expected = vernier_test::replaced(expected, "<origin xyz='1 0 0'/>", "<origin rpy=\"0 0 0\" xyz='1 0.25 0'/>");
  expected = vernier_test::replaced(expected, "xyz='0 0 2'", "xyz='0 0 2.5'");
  std::string out = export_urdf(chain, arm.with_frames(FrameParameters(base), FrameParameters(tool)), note());
  const std::size_t comment = out.find("\n  <!-- geometry of ");
  ASSERT_NE(comment, std::string::npos);
  EXPECT_EQ(out.substr(0, comment), text.substr(0, comment));
  EXPECT_EQ(text.substr(0, comment).substr(comment - 18), "<robot name='two'>");
  out.erase(comment, out.find("-->", comment) + 3 - comment);
  EXPECT_EQ(out, expected);
  const std::string marked =
      vernier_test::replaced(text, "<origin xyz='1 0 0'/>", "<origin note=\"it's\" mark='>' xyz='1 0 0'/>");
  EXPECT_EQ(detail::with_origins(marked, {{"one", base}}, {}),
            vernier_test::replaced(marked, "<origin note=\"it's\" mark='>' xyz='1 0 0'/>",
                                   "<origin rpy=\"0 0 0\" note=\"it's\" mark='>' xyz='1 0.25 0'/>"));
}

// Half a micrometre is written, too.
TEST(ExportUrdf, SmallChangesAreWritten) {
  const UrdfChain chain = parse_urdf(vernier_test::abb_like_urdf(), "in", "base_link", "tool0");
  const ArmGeometry arm = chain.robot.geometry();
  Isometry3 base = arm.base().isometry(), tool = arm.tool().isometry();
  base.translation().x() += 5e-7;
  tool.translation().x() += 5e-7;
  const ArmGeometry moved_frames = arm.with_frames(FrameParameters(base), FrameParameters(tool));
  const UrdfChain back = parse_urdf(export_urdf(chain, moved_frames, note()), "out", "base_link", "tool0");
  Rng rng(5);
  EXPECT_LE(worst_difference(moved_frames, back.robot.geometry(), rng, 20), 1e-12);
}

TEST(ExportUrdf, TheGeometryHasTheJointsOfTheChain) {
  const std::string text =
      "<robot name='two'><link name='a'/><link name='b'/><link name='c'/>"
      "<joint name='one' type='revolute'><parent link='a'/><child link='b'/></joint>"
      "<joint name='two' type='prismatic'><parent link='b'/><child link='c'/></joint></robot>";
  const UrdfChain chain = parse_urdf(text, "in");
  const auto told = [&](const ArmGeometry& arm) {
    return vernier_test::complaint([&] { (void)joint_origins(chain, arm); });
  };
  const DhRow turns, slides{.joint = JointType::prismatic};
  EXPECT_EQ(told(chain.robot.geometry()), "");
  EXPECT_EQ(told({detail::ChainTable({turns, turns}, false), {}, {}}),
            "joint_origins: the geometry is not of the chain to 'c', 2 joints");
  EXPECT_EQ(told({detail::ChainTable({turns, slides}, true), {}, {}}),
            told({detail::ChainTable({turns, turns}, false), {}, {}}));
  EXPECT_EQ(told({detail::ChainTable({turns}, false), {}, {}}),
            told({detail::ChainTable({turns, turns}, false), {}, {}}));
}

TEST(ExportUrdf, AnotherToolNeedsAFixedJoint) {
  const UrdfChain chain = parse_urdf(vernier_test::seven_axis_urdf(), "in");
  const ArmGeometry arm = chain.robot.geometry();
  Isometry3 tool = chain.robot.tool;
  tool.translation().x() += 0.1;
  EXPECT_NE(vernier_test::complaint([&] {
              (void)export_urdf(chain, arm.with_frames(arm.base(), tool), note());
            }).find("no fixed joint in front of 'link_7'"),
            std::string::npos);
  EXPECT_NE(vernier_test::complaint([&] {
              (void)export_urdf(chain, RobotDescription::of(robots::ur10()).geometry(), note());
            }).find("the geometry is not of the chain"),
            std::string::npos);
}

// Whatever is accepted is written back as it is meant; everything else is refused, by no other exception.
TEST(ExportUrdf, DamagedBytesAreRefusedOrExportedRightly) {
  Rng rng(4);
  const std::string pieces = "<>/\"'=! -?&;#[]ax0.e\n\t";
  int accepted = 0;
  for (int i = 0; i < 3000; ++i) {
    const Sample sample = samples()[static_cast<std::size_t>(i) % 3];
    std::string text = sample.text;
    for (int damage = 0; damage <= i % 3; ++damage) {
      const auto at = static_cast<std::size_t>(rng.uniform() * static_cast<double>(text.size()));
      const char piece = pieces[static_cast<std::size_t>(rng.uniform() * static_cast<double>(pieces.size()))];
      if (i % 4 == 0)
        text.erase(at, 1 + static_cast<std::size_t>(rng.uniform() * 40));
      else if (i % 4 == 1)
        text.insert(at, 1, piece);
      else
        text[at] = piece;
    }
    try {
      const UrdfChain chain = parse_urdf(text, "in", sample.base, sample.tip);
      const ArmGeometry arm = moved(chain, rng, 1e-3, false);
      const UrdfChain back = parse_urdf(export_urdf(chain, arm, note()), "out", sample.base, sample.tip);
      EXPECT_LE(worst_difference(arm, back.robot.geometry(), rng, 2), 1e-11) << text;
      ++accepted;
    } catch (const std::invalid_argument&) {
    }
  }
  EXPECT_GT(accepted, 150);
}

TEST(ExactNumber, HasAPointWhereItHasAnExponent) {
  EXPECT_EQ(detail::exact_number(0.1), "0.1");
  EXPECT_EQ(detail::exact_number(-0.0), "0");
  EXPECT_EQ(detail::exact_number(1e-5), "1.0e-05");
  EXPECT_EQ(detail::exact_number(1.25e-20), "1.25e-20");
  EXPECT_EQ(std::stod(detail::exact_number(1.0 / 3)), 1.0 / 3);
}

}  // namespace
}  // namespace vernier::export_urdf_test
