// SPDX-License-Identifier: BSD-3-Clause
// A calibrated model in; one C header that predicts and corrects as the library does out.

#include <fmt/format.h>

#include <cctype>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "cli.hpp"
#include "json_file.hpp"
#include "payload_option.hpp"
#include "vernier/core/atomic_file.hpp"
#include "vernier/core/data_error.hpp"
#include "vernier/io/export_c.hpp"
#include "vernier/io/json.hpp"

namespace {

namespace vn = vernier;

/// Mean held-out error of the stage that is deployed [m], from the results that calibrate wrote.
/// @throws vn::DataError where they are those of another calibration, or of none
double held_out_error(const std::string& results, const vn::SavedModel& model) {
  const nlohmann::json document = vn::read_json(results);
  const vn::JsonNode root(document, results);
  const auto of = [](const std::string& name, std::int64_t rows) {
    return vn::message("'", name, "', ", rows, " rows");
  };
  const std::string here = of(root.at("robot").text(), root.at("train_rows").integer(0, INT32_MAX)),
                    there = of(model.name(), model.provenance().rows);
  if (here != there) root.fail("are results of another calibration: " + here + "; the model: " + there);
  return 1e-3 * root.at("stages").at(root.at("chosen").text()).at("mean_mm").number();
}

int run(support::Program& program) {
  std::string model, results, name = "arm";
  program.add_option("--model", model, "calibrated model that calibrate saved", "FILE").required();
  program.add_option("--results", results,
                     "what calibrate wrote by --json, in place of the held-out error that the model keeps", "FILE");
  program.group(support::Group::output);
  program.add_setting("--name", name, "what all names in the file begin with", "NAME");
  program.group(support::Group::model);
  support::PayloadOption payload;
  payload.add_to(program);
  program.parse("", "write the C header to this file", "FILE");
  const std::string out = program.common().out;

  vn::SavedModel saved = vn::read_model(model);
  vn::CExport options{.name = name};
  if (payload.mass) {
    if (!saved.states_payload()) support::refuse_payload();
    saved = saved.carrying(payload.payload());
  }
  if (!results.empty()) options.held_out_error = held_out_error(results, saved);
  const std::string source = vn::c_source(saved, options);
  if (const double known = saved.provenance().held_out_error; results.empty() && known > 0)
    options.held_out_error = known;
  vn::write_file(out, source);
  std::string capitals = name;
  for (char& letter : capitals) letter = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
  fmt::print("{}: {} kB\nA library of it: cc -O2 -shared -fPIC -D{}_API= -x c {} -o {}.so -lm\n", support::shown(out),
             (source.size() + 500) / 1000, capitals, vn::writing_of(out) == vn::Writing::through ? name + ".h" : out,
             name);
  if (!program.common().json.empty()) {
    support::Json json{{"file", support::shown(out)}, {"name", name}, {"bytes", source.size()}};
    if (options.held_out_error) json["held_out_error_mm"] = *options.held_out_error * 1e3;
    support::write_json(program.common().json, json);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const support::About about{"export_c",
                             "Writes a calibrated model as one C header that predicts poses and corrects commands.",
                             {"export_c --model model.json --out arm.h",
                              "export_c --model model.json --name cell3 --payload-kg 2.5 --out cell3.h"}};
  return support::run_program(about, argc, argv, run);
}
