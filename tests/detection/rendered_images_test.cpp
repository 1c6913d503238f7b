// SPDX-License-Identifier: BSD-3-Clause
// From the print to a calibrated arm: images of a virtual arm are rendered, and the programs find the rest.
#include <gtest/gtest.h>

#include <string>

#include "rendered_board.hpp"
#include "run_command.hpp"
#include "simulated_views.hpp"
#include "temporary_folder.hpp"
#include "vernier/core/atomic_file.hpp"
#include "vernier/io/camera_files.hpp"
#include "vernier/io/model_file.hpp"
#include "vernier/kinematics/robots.hpp"

namespace vn = vernier;

namespace rendered_images_test {
namespace {

TEST(RenderedImages, CalibrateAnArm) {
  const vernier_test::TemporaryFolder folder("rendered");
  const auto run = [&](const std::string& line) {
    const auto done = vernier_test::run_command(
        "cd '" + folder.path().string() + "'; '" + VERNIER_EXAMPLES_DIR + "/" + line, folder.path());
    EXPECT_EQ(done.exit_code, 0) << line << done.errors;
    return done.output;
  };
  run("make_board' --rows 6 --columns 9 --square-mm 40 --marker-mm 30 --dictionary DICT_4X4_50 --svg board.svg --board "
      "board.json");
  vernier_test::ViewSetup setup;
  setup.board = vn::read_board((folder / "board.json").string());
  setup.camera = {.fx = 700, .fy = 703, .cx = 322, .cy = 238, .k1 = -0.1, .k2 = 0.05, .width = 640, .height = 480};
  setup.images = 40;
  const vn::Robot<6> robot = vn::robots::abb_irb120();
  const vn::DhChain<6> actual = vn::with_geometric_errors(robot.chain, {}, 3);
  const vernier_test::SimulatedViews taken = vernier_test::simulated_views(actual, robot.limits, setup, 4);
  vn::Rng rng(6);
  std::filesystem::create_directory(folder / "floor");
  std::filesystem::create_directory(folder / "table");
  for (std::size_t i = 0; i < taken.views.views.size(); ++i) {
    const vn::View& view = taken.views.views[i];
    const vn::JointVector<6> q = taken.rows.joints.row(static_cast<vn::Index>(i)).transpose();
    const vn::Isometry3 board_T_camera =
        taken.bases[static_cast<std::size_t>(view.board)] * actual.pose(q) * taken.tool;
    std::string name = view.image;
    name.replace(name.find(".png"), 4, ".pgm");
    vernier_test::write_image((folder / (view.board == 0 ? "floor" : "table") / name).string(),
                              vernier_test::rendered(setup.board, setup.camera, board_T_camera.inverse(), 0, rng),
                              setup.camera.width, setup.camera.height);
  }
  vn::ImageRows rows = taken.rows;
  for (std::string& image : rows.images) image.replace(image.find(".png"), 4, ".pgm");
  vn::write_file((folder / "joints.csv").string(), vn::image_joints_text(rows));

  const std::string detected = run(
      "detect_board' --board board.json --images 'floor/*.pgm' 'table/*.pgm' --place floor table --out corners.csv");
  EXPECT_NE(detected.find(" of 40 images"), std::string::npos) << detected;
  const vn::CornerViews views = vn::read_corners((folder / "corners.csv").string(), setup.board);
  EXPECT_EQ(views.boards, (std::vector<std::string>{"floor", "table"}));
  EXPECT_GT(views.views.size(), 32u);
  run("calibrate' --robot abb_irb120 --data joints.csv --corners corners.csv --board board.json --camera-mount flange "
      "--save model.json");
  const auto model = vn::load<6>((folder / "model.json").string());
  const auto error = [&](const vn::DhChain<6>& chain) {
    return vernier_test::error_after_registration(chain, actual, robot.limits, 7);
  };
  EXPECT_GT(error(robot.chain), 1e-3);
  EXPECT_LT(error(model.identified().chain()), 0.2e-3);
  vn::write_file((folder / "pick.script").string(), "movej([0.2, -0.3, 0.6, -0.2, 0.5, 0.4])\n");
  EXPECT_NE(run("correct' --model model.json --program pick.script --out corrected.script").find("1 targets corrected"),
            std::string::npos);
}

}  // namespace
}  // namespace rendered_images_test
