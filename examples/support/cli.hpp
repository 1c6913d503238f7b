#pragma once

/// @file
/// What the programs' command lines have in common: options, errors and exit codes.

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>

namespace support {

/// Options of every program.
struct CommonOptions {
  std::string json;        ///< file for the results as JSON; empty: none
  std::string out;         ///< folder for figures
  std::uint64_t seed = 1;  ///< of everything random
  int threads = 1;         ///< that compute at a time
};

/// Wrong usage that the parser could not see, e.g. two options that exclude each other: exit code 2.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A program's command line.
///
///     int main(int argc, char** argv) {
///       return support::run_program("calibrate", "Measured poses in, ...", argc, argv, [](support::Program& program) {
///         std::string data;
///         program.app().add_option("--data", data, "measured poses")->required();
///         program.parse("calibrate_out");
///         ...
///         return 0;
///       });
///     }
class Program {
 public:
  Program(const char* name, const char* description, int argc, const char* const* argv);

  CLI::App& app() { return app_; }
  const CommonOptions& common() const { return common_; }
  const std::string& name() const { return name_; }
  /// As it was typed, words with spaces and the like in quotes.
  std::string command_line() const;

  /// Adds the common options, reads the command line, and makes sure that the JSON file can be written before any
  /// work is done.
  /// @param default_out folder for figures where the user names none
  /// @param out_description,out_type what `--out` is in the help, for a program that writes something else there; null:
  ///        there is no such option
  /// @throws CLI::ParseError, which `run_program` turns into help or exit code 2
  /// @throws std::runtime_error where the JSON file cannot be written
  void parse(const std::string& default_out, const char* out_description = "folder for the figures",
             const char* out_type = "FOLDER");

  /// The folder for figures, made where it is missing.
  /// @throws std::runtime_error naming the folder and the reason
  std::filesystem::path output_folder() const;

 private:
  CLI::App app_;
  std::string name_;
  CommonOptions common_;
  int argc_;
  const char* const* argv_;
};

/// The date, UTC, e.g. "2024-05-01".
std::string today();

/// Makes sure that a file can be written, before the work whose result it takes.
/// @throws std::runtime_error naming the file and the reason
void require_writable(const std::filesystem::path& path);

/// Runs a program's body and reports a failure in one line on standard error.
/// @return the body's value; 0 after help; 2 for wrong usage; 1 for any other failure
int run_program(const char* name, const char* description, int argc, const char* const* argv,
                const std::function<int(Program&)>& body);

}  // namespace support
