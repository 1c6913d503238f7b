// SPDX-License-Identifier: BSD-3-Clause
// Malformed files: each gives one clear line that names the file, never a crash and never a half-written output.

#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>

#include "replaced.hpp"
#include "temporary_folder.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/io.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::bad_input_test {
namespace {

using Json = nlohmann::ordered_json;
using vernier_test::replaced;
using vernier_test::TemporaryFolder;

/// How a reader answers a file of this content: empty when it takes it, else its complaint.
class Reader {
 public:
  Reader(const std::string& name, std::function<void(const std::filesystem::path&)> read)
      : path_(folder_ / name), read_(std::move(read)) {}

  std::string complaint(const std::string& content) {
    write_file(path_, content);
    try {
      read_(path_);
    } catch (const DataError& e) {
      return e.what();
    }
    return {};
  }

  /// Expects one clear line: it names the file, is short and printable.
  void expect_refused(const std::string& content, const std::string& what) {
    ++cases;
    const std::string line = complaint(content);
    EXPECT_NE(line, "") << what << " was taken";
    if (line.empty()) return;
    EXPECT_EQ(line.find(path_.string()), 0u) << what << ": " << line;
    EXPECT_LT(line.size(), path_.string().size() + 300) << what << ": " << line;
    for (const char c : line.substr(path_.string().size())) EXPECT_TRUE(c >= ' ' && c <= '~') << what << ": " << line;
  }

  int cases = 0;

 private:
  TemporaryFolder folder_{"bad_input"};
  std::filesystem::path path_;
  std::function<void(const std::filesystem::path&)> read_;
};

/// Content that is no text of any of our formats.
std::vector<std::pair<std::string, std::string>> hopeless() {
  std::string binary, random;
  for (int i = 0; i < 600; ++i) binary += static_cast<char>(i * 7 % 256);
  Rng rng(8);
  for (int i = 0; i < 3000; ++i) random += static_cast<char>(rng.below(256));
  return {{"nothing", ""},
          {"blanks", " \n\t\r\n  "},
          {"a byte-order mark alone", "\xEF\xBB\xBF"},
          {"binary", binary},
          {"random bytes", random},
          {"zeros", std::string(1000, '\0')},
          {"UTF-16", std::string("{\0\"\0n\0", 6)},
          {"bad UTF-8", "{\"name\": \"\xC3\x28\"}"},
          {"a long line", std::string(200000, 'x')},
          {"HTML", "<html><body>404</body></html>"}};
}

// --- CSV -------------------------------------------------------------------------------------------------------------

const std::string csv_header = "q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad,x_mm,y_mm,z_mm\n";
const std::string csv_row = "0.1,0.2,0.3,0.4,0.5,0.6,100,200,300\n";

TEST(BadInput, MeasuredPoses) {
  Reader reader("poses.csv", [](const auto& path) { (void)read_dataset<6>(path); });
  ASSERT_EQ(reader.complaint(csv_header + csv_row + csv_row), "");
  for (const auto& [what, content] : hopeless()) reader.expect_refused(content, what);
  for (const char* cell :
       {"nan", "NaN",   "-nan", "inf",  "-inf", "Infinity", "1e999", "-1e999", "1e300", "1e10", "abc",  "",
        " ",   "1.2.3", "1,5",  "0x10", "1e",   "--1",      "+-1",   "1 2",    "1\"",   "1;2",  "NULL", "#REF!"})
    for (const char* target : {"0.1", "0.6", "300"})
      reader.expect_refused(csv_header + csv_row + replaced(csv_row, target, cell), std::string("cell ") + cell);
  for (const char* column : {"q1_rad", "q3_rad", "q6_rad", "x_mm", "y_mm", "z_mm"}) {
    reader.expect_refused(replaced(csv_header, column, "other") + csv_row, std::string("no ") + column);
    reader.expect_refused(replaced(csv_header, column, std::string(column).substr(0, 2)) + csv_row,
                          std::string("no unit in ") + column);
    reader.expect_refused(replaced(csv_header, column, "x_inch") + csv_row, std::string("another unit in ") + column);
    reader.expect_refused(
        replaced(csv_header, "\n", std::string(",") + column + "\n") + replaced(csv_row, "\n", ",1\n"),
        std::string("twice ") + column);
  }
  reader.expect_refused(csv_header, "no rows");
  reader.expect_refused(csv_row + csv_row, "no header");
  reader.expect_refused(csv_header + replaced(csv_row, "300\n", "300,400\n"), "a value too many");
  reader.expect_refused(csv_header + replaced(csv_row, ",300\n", "\n"), "a value too few");
  reader.expect_refused(csv_header + csv_row + "0.1", "truncated in the first value");
  reader.expect_refused(csv_header + csv_row + csv_row.substr(0, 20), "truncated in a row");
  reader.expect_refused(csv_header + csv_row + std::string("0.1,\0.2", 7), "a zero byte");
  reader.expect_refused(replaced(csv_header, "q6_rad", "q6_rad,q7_rad") + replaced(csv_row, "0.6", "0.6,0.7"),
                        "a joint too many");
  reader.expect_refused(replaced(csv_header, "z_mm", "z_mm,rx_rad") + replaced(csv_row, "300", "300,0.1"),
                        "half an orientation");
  for (std::size_t n = 1; n < csv_header.size(); n += 5)
    reader.expect_refused(csv_header.substr(0, n), "half a header");
  RecordProperty("cases", reader.cases);
  EXPECT_GE(reader.cases, 120);
}

TEST(BadInput, Targets) {
  Reader reader("targets.csv", [](const auto& path) { (void)read_joints<3>(path); });
  ASSERT_EQ(reader.complaint("q1_deg,q2_deg,q3_mm\n1,2,3\n"), "");
  for (const auto& [what, content] : hopeless()) reader.expect_refused(content, what);
  reader.expect_refused("q1_deg,q2_deg,q3_mm\n", "no rows");
  reader.expect_refused("q1_deg,q2_deg,q3_mm\n1,2\n", "a value too few");
  reader.expect_refused("q1_deg,q2_deg,q3_mm\n1,2,nan\n", "NaN");
  reader.expect_refused("q1_deg,q3_mm\n1,3\n", "a joint missing");
  reader.expect_refused("q1_deg,q1_rad,q2_deg,q3_mm\n1,2,3,4\n", "a joint twice");
}

// --- JSON ------------------------------------------------------------------------------------------------------------

/// Every place in a document, as JSON pointers; of a list the first entry stands for all.
void places(const Json& value, const Json::json_pointer& at, std::vector<Json::json_pointer>& out) {
  out.push_back(at);
  if (value.is_object())
    for (const auto& [key, member] : value.items()) places(member, at / key, out);
  if (value.is_array() && !value.empty()) places(value.front(), at / std::size_t{0}, out);
}

/// Puts wrong values at every place of a valid document, cuts it off at many lengths, and expects each to be refused.
/// @param free   keys that may hold anything
/// @param texts  keys that are texts of any content
/// @param spare  keys that may be left out
void expect_refused_when_damaged(Reader& reader, const Json& valid, const std::vector<std::string>& free,
                                 const std::vector<std::string>& texts, const std::vector<std::string>& spare) {
  ASSERT_EQ(reader.complaint(valid.dump(1)), "");
  const auto among = [](const std::vector<std::string>& keys, const std::string& key) {
    return std::find(keys.begin(), keys.end(), key) != keys.end();
  };
  std::vector<Json::json_pointer> all;
  places(valid, Json::json_pointer(), all);
  Json deep = 1;
  for (int i = 0; i < 200; ++i) deep = Json::array({deep});
  for (const auto& place : all) {
    const std::string key = place.empty() ? "" : place.back();
    if (among(free, key)) continue;
    const std::vector<Json> wrong{
        nullptr, true, "wrong", 1e300, -1e300, Json::array(), Json::object(), Json::array({1, "x"}), deep};
    for (const Json& value : wrong) {
      if (value.is_string() && among(texts, key)) continue;
      if (value.is_boolean() && valid.at(place).is_boolean()) continue;
      Json damaged = valid;
      damaged[place] = value;
      reader.expect_refused(damaged.dump(1), place.to_string() + " = " + value.dump().substr(0, 20));
    }
    if (place.empty() || among(spare, key)) continue;
    Json damaged = valid;
    if (valid.at(place.parent_pointer()).is_array()) {
      damaged.at(place.parent_pointer()).erase(0);
    } else {
      damaged.at(place.parent_pointer()).erase(key);
    }
    reader.expect_refused(damaged.dump(1), "without " + place.to_string());
  }
  const std::string text = valid.dump(1);
  for (std::size_t n = 0; n + 1 < text.size(); n += 1 + text.size() / 60)
    reader.expect_refused(text.substr(0, n), message("the first ", n, " bytes"));
  for (const char* from : {",", ":", "\"", "{", "["}) {
    reader.expect_refused(replaced(text, from, ""), std::string("without the first ") + from);
    reader.expect_refused(replaced(text, from, std::string(from) + "\x01"),
                          std::string("a control character after ") + from);
  }
  reader.expect_refused(text + "x", "something behind");
  reader.expect_refused(text + text, "twice");
  reader.expect_refused(replaced(text, "{", "{\"name\": \"first\","), "a key twice");
  reader.expect_refused(std::string(100000, '['), "nested without end");
  std::string nested;
  for (int i = 0; i < 50000; ++i) nested += "{\"a\":";
  reader.expect_refused(nested, "objects nested without end");
  for (const char* number : {"NaN", "Infinity", "-Infinity", "1e999", "0x1", "1.", ".5", "01", "1e", "--1", "nan"})
    reader.expect_refused("{\"schema_version\": " + std::string(number) + ", \"name\": " + number + "}", number);
  for (const auto& [what, content] : hopeless()) reader.expect_refused(content, what);
}

TEST(BadInput, RobotFiles) {
  const Json row{{"type", "revolute"}, {"a_mm", 100},   {"alpha_deg", 90},   {"d_mm", 10},
                 {"theta_deg", 0},     {"beta_deg", 0}, {"lower_deg", -170}, {"upper_deg", 170}};
  const Json valid{{"name", "an arm"}, {"convention", "standard"}, {"joints", {row, row, row}}};
  Reader reader("robot.json", [](const auto& path) { (void)load_robot(path); });
  expect_refused_when_damaged(reader, valid, {}, {"name"}, {"type", "beta_deg", "lower_deg", "upper_deg", "0"});
  const Json bare{{"a_mm", 100}, {"alpha_deg", 90}, {"d_mm", 10}, {"theta_deg", 0}};
  const Json limits{{"lower_deg", -170}, {"upper_deg", 170}};
  const Json counted{
      {"name", "an arm"},
      {"convention", "standard"},
      {"joints", {bare, bare, bare}},
      {"controller", {{"chain", {"J1", "J2", "J1 - J3"}}, {"limits", {limits, limits, limits}}}},
      {"base", {{"x_mm", 1}, {"y_mm", 2}, {"z_mm", 3}, {"rx_deg", 4}, {"ry_deg", 5}, {"rz_deg", 6}, {"known", true}}},
      {"down", {0, 0, 1}}};
  expect_refused_when_damaged(
      reader, counted, {"base", "0"}, {"name"},
      {"controller", "limits", "lower_deg", "upper_deg", "base", "rx_deg", "ry_deg", "rz_deg", "known", "down"});
  const auto with = [&](const char* key, const Json& value) {
    Json damaged = valid;
    damaged["joints"][1][key] = value;
    return damaged.dump();
  };
  reader.expect_refused(with("lower_deg", 170), "limits upside down");
  reader.expect_refused(with("a_m", 0.1), "a in two units");
  reader.expect_refused(with("a_inch", 4), "an unknown unit");
  reader.expect_refused(with("type", "spherical"), "an unknown joint");
  reader.expect_refused(with("type", "prismatic"), "a prismatic joint with limits in degrees");
  reader.expect_refused(with("a_mm", 1e6), "a link of a kilometre");
  reader.expect_refused(with("alpha_deg", 1e5), "hundreds of turns");
  for (const int n : {0, 10, 50}) {
    Json damaged = valid;
    damaged["joints"] = std::vector<Json>(static_cast<std::size_t>(n), row);
    reader.expect_refused(damaged.dump(), message(n, " joints"));
  }
  RecordProperty("cases", reader.cases);
  EXPECT_GE(reader.cases, 200);
}

/// A model with all that a model can have.
CalibratedRobot<6> model() {
  const auto robot = robots::abb_irb120();
  const JointRows<6> joints = sample_joints(robot.limits, 30, 5);
  using Model = CalibratedRobot<6>::Model;
  JointTerms terms(6);
  terms.gear_ratio = true;
  terms.linear_ranges = std::vector<JointRange>(6, {-1, 1});
  terms.gravity.emplace(robot.chain);
  terms.hysteresis = {0.02};
  terms.tilt.emplace(robot.chain);
  terms.transmission[0] = terms.transmission[2] = Fourier::up_to(2);
  const Model::Arm arm(
      {with_geometric_errors(robot.chain, {}, 3), JointErrors(terms, VectorX::Constant(terms.size(), 1e-4))});
  const CalibratedRobot<6> plain("an arm",
                                 Model(robot.chain, arm, Model::Arm(robot.chain), JointCoverage<6>::covering(joints))
                                     .with_thermal({22, 20, 24, VectorX::Constant(42, 1e-6)}),
                                 robot.limits, {"poses.csv", 30, "2024-05-01", "commanded"});
  ErrorModelEstimate estimate{
      .arm = detail::parameterised(FittedArm::of(arm), {{7, -1, 1e-3, 1}, {7, -1, 1e-4, 1, true}},
                                   VectorX::Ones(terms.size()), VectorX::Ones(terms.size()), VectorX())};
  estimate.covariance = MatrixX::Identity(terms.size() + 2, terms.size() + 2);
  const HiddenLayer layer{.nodes = 4, .input_map = InputMap::sines_and_cosines};
  const Eigen::Matrix<double, Eigen::Dynamic, 3> beta = 1e-4 * joints.topLeftCorner<4, 3>();
  const ElmPredictor<6, 3> network(layer, {VectorX::Zero(12), VectorX::Ones(12)}, layer.draw(6, 2), beta,
                                   Vector3::Zero());
  return plain.with_estimate(estimate).with_learned(network, JointCoverage<6>::covering(joints));
}

TEST(BadInput, ModelFiles) {
  Reader reader("model.json", [](const auto& path) {
    const SavedModel saved = read_model(path);
    if (saved.dof() != 6) throw DataError(path.string() + ": joints: not 6");
    (void)saved.as<6>();
  });
  const Json valid = to_json(model());
  expect_refused_when_damaged(
      reader, valid, {"written_by"}, {"name", "data_file", "date"},
      {"lower_rad", "upper_rad", "learned", "periodic", "linear_ranges", "thermal", "estimate", "per_kelvin"});
  const auto with = [&](const char* pointer, const Json& value) {
    Json damaged = valid;
    damaged[Json::json_pointer(pointer)] = value;
    return damaged.dump();
  };
  reader.expect_refused(with("/schema_version", 1), "an old version");
  reader.expect_refused(with("/schema_version", 7), "a new version");
  reader.expect_refused(with("/convention", "modified"), "a chain of the other convention");
  reader.expect_refused(with("/provenance/rows", -1), "fewer than no rows");
  reader.expect_refused(with("/provenance/rows", 1.5), "half a row");
  reader.expect_refused(with("/provenance/fitted_rows", {1, 2.5}), "a row that is no number");
  reader.expect_refused(with("/provenance/fitted_rows", {4294967296u}), "a row of more than 32 bits");
  reader.expect_refused(with("/learned/hidden_nodes", 0), "no nodes");
  reader.expect_refused(with("/learned/hidden_nodes", 5), "a node more than weights");
  reader.expect_refused(with("/learned/hidden_nodes", 100001), "too many nodes");
  reader.expect_refused(with("/learned/hidden_nodes", 18446744073709551615ull), "far too many nodes");
  reader.expect_refused(with("/learned/coverage/2/margin", 0), "a gate without margin");
  reader.expect_refused(with("/learned/coverage/2/ranges/0/0", 100), "a gate upside down");
  reader.expect_refused(with("/arm/joint_errors/linear_ranges/1/0", 2), "a linear range upside down");
  reader.expect_refused(with("/thermal/measured_c/0", 30), "temperatures upside down");
  reader.expect_refused(with("/arm/joint_errors/transmission/2/orders", {1, 2, 3}), "an order more than coefficients");
  reader.expect_refused(with("/arm/joint_errors/transmission/2/orders", {2, 1}), "orders upside down");
  reader.expect_refused(with("/arm/joint_errors/transmission/2/orders", {0, 1}), "a harmonic of order 0");
  reader.expect_refused(with("/arm/joint_errors/hysteresis/widths_rad/0", 0), "a step without width");
  reader.expect_refused(with("/arm/joint_errors/hysteresis/widths_rad", {0.1, 0.2}), "more widths than coefficients");
  reader.expect_refused(with("/arm/joint_errors/gravity/down/0", 1), "gravity stronger than gravity");
  reader.expect_refused(with("/arm/joint_errors/tilt/down/2", 0), "tilts without gravity");
  reader.expect_refused(with("/arm/joint_errors/tilt/coefficients_rad", {1e-3, 2e-3}), "tilts of a third of a joint");
  reader.expect_refused(with("/arm/joint_errors/backlash", 1), "a joint error nobody knows");
  reader.expect_refused(with("/provenance/measured", "colours"), "another kind of measurement");
  reader.expect_refused(with("/learned/input_map", "raw"), "weights of another layer");
  reader.expect_refused(with("/joints/3/lower_rad", 100), "limits upside down");
  reader.expect_refused(with("/estimate/position_sigma_m", -1), "noise below none");
  reader.expect_refused(with("/estimate/variance_factor", 0), "no variance");
  reader.expect_refused(with("/estimate/geometric/0/parameter", "d9"), "a parameter of another arm");
  reader.expect_refused(with("/estimate/geometric/0/scale", 0), "an unknown without unit");
  reader.expect_refused(with("/estimate/geometric", std::vector<Json>(100, valid["estimate"]["geometric"][0])),
                        "more unknowns than twice the parameters");
  Json huge = valid;  // a covariance that no memory holds
  Json& transmission = huge["arm"]["joint_errors"]["transmission"];
  for (Json& joint : transmission) {
    joint["orders"] = Json::array();
    for (int order = 1; order <= 1000; ++order) joint["orders"].push_back(order);
    joint["coefficients_rad"] = std::vector<double>(2000, 0);
  }
  const std::size_t few = valid["arm"]["joint_errors"]["coefficients"].get<std::size_t>() - 8;
  huge["arm"]["joint_errors"]["coefficients"] = few + 12000;
  huge["estimate"]["coefficient_scales"] = std::vector<double>(few + 12000, 1);
  huge["estimate"]["coefficient_prior_stds"] = std::vector<double>(few + 12000, 1);
  huge["estimate"]["stds_in_scales"] = std::vector<double>(few + 12002, 1);
  EXPECT_NE(reader.complaint(huge.dump()).find(message("estimate: has ", few + 12002, " unknowns, more than 10000")),
            std::string::npos);
  reader.expect_refused(with("/estimate/geometric/0/prior_std", -1), "a prior narrower than none");
  reader.expect_refused(with("/estimate/coefficient_scales/3", 0), "a coefficient without unit");
  reader.expect_refused(with("/estimate/stds_in_scales/3", -1), "a negative deviation");
  reader.expect_refused(with("/estimate/correlated", 3), "a factor of another size");
  reader.expect_refused(with("/estimate/correlation_factor", "AACAPw=="), "a factor of one number");
  reader.expect_refused(with("/estimate/correlation_factor", "AACAPw="), "no base64");
  RecordProperty("cases", reader.cases);
  EXPECT_GE(reader.cases, 400);
}

// What exactly is said: a list that is one too long, and values next to their limits.
TEST(BadInput, ModelFilesSayWhatIsTooMuch) {
  Reader reader("model.json", [](const auto& path) { (void)load<6>(path); });
  const Json valid = to_json(model());
  const auto told = [&](const std::string& pointer, const Json& value) {
    Json changed = valid;
    changed[Json::json_pointer(pointer)] = value;
    const std::string line = reader.complaint(changed.dump());
    const std::size_t at = line.find("model.json: ");
    return at == std::string::npos ? line : line.substr(at + 12);
  };
  const auto one_more = [&](const std::string& pointer) {
    const Json& list = valid.at(Json::json_pointer(pointer));
    return told(pointer + "/" + std::to_string(list.size()), list.front());
  };
  EXPECT_EQ(one_more("/joints"), "arm.rows: has 6 entries, must have 7");  // the list of joints states their number
  for (const char* list : {"/arm/rows", "/outside_arm/rows", "/coverage", "/learned/coverage",
                           "/arm/joint_errors/linear_ranges", "/arm/joint_errors/transmission"}) {
    const std::string line = one_more(list);
    EXPECT_NE(line.find(": has 7 entries, must have 6"), std::string::npos) << list << ": " << line;
  }
  const std::size_t terms = valid["estimate"]["coefficient_scales"].size();
  for (const char* key : {"coefficient_scales", "coefficient_prior_stds"})
    EXPECT_EQ(one_more(std::string("/estimate/") + key),
              message("estimate.", key, ": has ", terms + 1, " entries, must have ", terms));
  EXPECT_EQ(one_more("/thermal/rates_per_k"), "thermal.rates_per_k: has 43 entries, must have 42");

  EXPECT_EQ(told("/estimate/correlated", 3), "estimate.correlation_factor: is not the base64 of 6 finite numbers");
  for (const char* key :
       {"position_sigma_m", "joint_sigma_rad", "orientation_sigma_rad", "fallback_error_m", "temperature_std_k"}) {
    EXPECT_EQ(told(std::string("/estimate/") + key, -1e-9), message("estimate.", key, ": must not be negative"));
    EXPECT_EQ(told(std::string("/estimate/") + key, 0), "") << key;
  }
  for (const char* key : {"variance_factor", "residual_variance"})
    EXPECT_EQ(told(std::string("/estimate/") + key, 0), message("estimate.", key, ": must be positive"));

  EXPECT_EQ(told("/learned/weight_limit", 0), "learned.weight_limit: must be positive");
  EXPECT_EQ(told("/learned/hidden_nodes", 100001), "learned.hidden_nodes: must lie in 1..100000");
  EXPECT_EQ(told("/learned/coverage/1/ranges", Json::array()), "learned.coverage[1].ranges: is empty");
  EXPECT_EQ(told("/learned/coverage/1/ranges", {{0.5, 0.5}}), "");  // a joint held still
  EXPECT_EQ(told("/arm/joint_errors/linear_ranges/1", {0.5, 0.5}), "");
  EXPECT_EQ(told("/thermal/measured_c", {22, 22}), "");
  EXPECT_EQ(told("/provenance/rows", 2147483648u), "provenance.rows: must lie in 0..2147483647");

  // directions of gravity as they are written: 17 digits, never a millionth off
  for (const char* term : {"gravity", "tilt"}) {
    const std::string place = std::string("/arm/joint_errors/") + term + "/down";
    for (const double off : {-0.9e-6, 0.9e-6}) EXPECT_EQ(told(place, {0, 0, -1 + off}), "") << term << off;
    for (const double off : {-1.1e-6, 1.1e-6})
      EXPECT_EQ(told(place, {0, 0, -1 + off}), message("arm.joint_errors.", term, ".down: must have length 1"));
  }

  const std::string transmission = "/arm/joint_errors/transmission/2", named = "arm.joint_errors.transmission[2]";
  EXPECT_EQ(told(transmission + "/orders", {1, 5000}), "");
  EXPECT_EQ(told(transmission + "/orders", {1, 5001}), named + ".orders[1]: must lie in 2..5000");
  EXPECT_EQ(told(transmission + "/orders", {3, 3}), named + ".orders[1]: must lie in 4..5000");
  EXPECT_EQ(told(transmission + "/harmonics", 2), "");  // as older files have them
  EXPECT_EQ(told(transmission + "/harmonics", 500), named + ".coefficients_rad: has 4 entries, must have 1000");
  EXPECT_EQ(told(transmission + "/harmonics", 501), named + ".harmonics: must lie in 0..500");
  EXPECT_EQ(told(transmission + "/centre_rad", 0.1),
            named + ": hidden nodes of a joint are no longer supported; calibrate again, with harmonics");
}

TEST(BadInput, LearnedKernels) {
  Reader reader("model.json", [](const auto& path) { (void)load<6>(path); });
  const JointRows<6> joints = sample_joints(robots::abb_irb120().limits, 5, 5);
  const KernelPredictor<6, 3> kernels(Kernel::squared_exponential, InputMap::raw, {VectorX::Zero(6), VectorX::Ones(6)},
                                      joints, 1e-4 * joints.leftCols<3>(), Vector3::Zero());
  Json valid = to_json(model().with_learned(kernels, JointCoverage<6>::covering(joints)));
  const auto with = [&](const char* pointer, const Json& value) {
    Json damaged = valid;
    damaged[Json::json_pointer(pointer)] = value;
    return damaged.dump();
  };
  reader.expect_refused(with("/learned/kind", "forest"), "another kind");
  reader.expect_refused(with("/learned/kernel", "triangle"), "another kernel");
  reader.expect_refused(with("/learned/input_map", "sines_and_cosines"), "features of another map");
  reader.expect_refused(with("/learned/samples", 6), "a sample more than centres");
  reader.expect_refused(with("/learned/samples", 0), "no samples");
  reader.expect_refused(with("/learned/coefficients_m/3", "a"), "a coefficient that is no number");
  reader.expect_refused(with("/learned/mean_m", {1, 2}), "a mean of two numbers");
}

TEST(BadInput, MissingFilesAndFolders) {
  const TemporaryFolder folder("bad_input");
  const auto complaint = [](const auto& call) -> std::string {
    try {
      call();
    } catch (const DataError& e) {
      return e.what();
    }
    return "none";
  };
  const auto missing = folder / "missing";
  EXPECT_EQ(complaint([&] { (void)read_dataset<6>(missing); }), missing.string() + ": No such file or directory");
  EXPECT_EQ(complaint([&] { (void)load_robot(missing); }), missing.string() + ": No such file or directory");
  EXPECT_EQ(complaint([&] { (void)load<6>(missing); }), missing.string() + ": No such file or directory");
  EXPECT_EQ(complaint([&] { (void)load_robot(folder.path()); }), folder.path().string() + ": is a folder, not a file");
  EXPECT_EQ(complaint([&] { (void)load<6>(folder.path()); }), folder.path().string() + ": is a folder, not a file");
  EXPECT_EQ(complaint([&] { (void)load_robot("/dev/zero"); }), "/dev/zero: has more than 32 MiB");
}

}  // namespace
}  // namespace vernier::bad_input_test
