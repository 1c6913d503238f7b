// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What the programs' command lines have in common: options, errors and exit codes. CLI11 parses them; its headers,
/// which every file would compile anew for seconds, are included by cli.cpp alone.

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace support {

/// Options of every program.
struct CommonOptions {
  std::string json;        ///< file for the results as JSON; empty: none
  std::string out;         ///< folder for figures, or a file
  std::uint64_t seed = 1;  ///< of all random numbers
  int threads = 1;         ///< that compute at a time
};

/// Wrong usage that the parser could not see, e.g. two options that exclude each other: exit code 2.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Groups of options in the help, in this order.
enum class Group { input, model, validation, output, general };

/// What the help says of a program beside its options.
struct About {
  const char* name;
  const char* purpose;                  ///< one sentence: what the program does
  std::array<const char*, 2> examples;  ///< command lines that are as they would be typed
  const char* done = "done";            ///< exit code 0
  const char* failed = "not done, or in part; one line on standard error says why";  ///< exit code 1
};

/// Values that completion offers, by option.
using OfferedValues = std::map<const CLI::Option*, std::vector<std::string>>;

/// An option, while the command line is described.
class Option {
 public:
  Option(CLI::Option* option, OfferedValues& offered) : option_(option), offered_(&offered) {}

  Option required();
  Option required_without(const std::string& others);  ///< says so in the help; the program checks it
  Option needs(Option other);                          ///< refused without the other one
  Option excludes(Option other);                       ///< refused beside the other one
  Option delimiter(char c);                            ///< between the values of one argument
  Option expected(int values);                         ///< their number
  Option one_value_each();                             ///< of an option that may be repeated
  Option description(const std::string& text);
  Option default_text(const std::string& text);  ///< shown in the help in place of the value

  /// Refuses values outside of [low, high], and NaN.
  /// @tparam T int or double
  template <class T>
  Option within(T low, T high);
  Option positive();                                     ///< refuses NaN and infinity, too
  Option not_negative();                                 ///< likewise
  Option one_of(const std::vector<std::string>& words);  ///< refuses all others
  Option offers(const std::vector<std::string>& words);  ///< completion offers these, beside files if it takes a FILE

 private:
  CLI::Option* option_;
  OfferedValues* offered_;
};

/// A program's command line.
///
///     int main(int argc, char** argv) {
///       const support::About about{"calibrate", "Calibrates a robot ...", {"calibrate --data ...", "calibrate ..."}};
///       return support::run_program(about, argc, argv, [](support::Program& program) {
///         std::string data;
///         program.add_option("--data", data, "measured poses", "FILE").required();
///         program.parse("calibrate_out");
///         ...
///         return 0;
///       });
///     }
class Program {
 public:
  Program(const About& about, int argc, const char* const* argv);
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  ~Program();

  /// The group of the options that are added from here on; at first it is `Group::input`.
  void group(Group group) { group_ = group; }
  /// An option that has no default, or whose default the help describes. A name without dashes is a positional
  /// argument.
  /// @tparam T text, path, number, an optional number, or a vector of texts, paths or numbers
  /// @param type what the help calls the value
  template <class T>
  Option add_option(const char* name, T& value, const std::string& help, const char* type) {
    return add(name, value, help, type, false);
  }
  /// An option whose default, the present value, is shown in the help.
  template <class T>
  Option add_setting(const char* name, T& value, const std::string& help, const char* type) {
    return add(name, value, help, type, true);
  }
  Option add_flag(const char* name, bool& value, const char* help);
  /// An option that names a file to be written; `parse` opens it, see `open_output`.
  Option add_output(const char* name, std::string& file, const std::string& help);
  /// The option of this name, added before.
  Option option(const char* name);
  /// Whether the user gave it.
  bool given(const char* name) const;
  /// What `--help` prints.
  std::string help() const;
  /// What `--completion` prints: a function for bash that completes options and values.
  std::string completion() const;

  const CommonOptions& common() const { return common_; }
  const char* name() const { return about_.name; }
  /// As it was typed, words with spaces and the like in quotes.
  std::string command_line() const;

  /// Adds the common options, reads the command line, and opens the outputs.
  /// @param default_out folder for figures where the user names none
  /// @param out_description,out_type what `--out` is in the help, for a program that writes something else there; an
  ///        output where the type is FILE, and required where there is no default. Null: there is no such option
  /// @throws an exception of the parser, which `run_program` turns into help or exit code 2
  /// @throws as `open_output`
  void parse(const std::string& default_out, const char* out_description = "folder for the figures",
             const char* out_type = "FOLDER");

  /// Makes sure, before any work, that a file can be written. `-` becomes standard output, and what the program prints
  /// for people goes to standard error then. A file that cannot be replaced is mentioned on standard error.
  /// @param name of the option, for messages
  /// @param file empty: nothing is to be written
  /// @throws UsageError where another output is the same file, or standard output goes there
  /// @throws std::runtime_error naming the file and the reason why it cannot be written
  void open_output(const std::string& name, std::string& file);

  /// Makes sure, before any work, that the folder for figures can be made and takes files.
  /// @throws std::runtime_error naming the folder and the reason
  void require_output_folder() const;

  /// The folder for figures, made where it is missing.
  /// @throws std::runtime_error naming the folder and the reason
  std::filesystem::path output_folder() const;

 private:
  template <class T>
  Option add(const char* name, T& value, const std::string& help, const char* type, bool default_shown);

  About about_;
  std::unique_ptr<CLI::App> app_;
  Group group_ = Group::input;
  OfferedValues offered_;
  CommonOptions common_;
  std::vector<std::pair<std::string, std::string*>> outputs_;  // options and their files
  std::map<std::string, std::string> opened_;                  // the option by where it leads
  int argc_;
  const char* const* argv_;
};

/// The date, UTC, e.g. "2024-05-01".
std::string today();

/// An output for a message: its name, or "standard output".
std::string shown(const std::string& output);

/// Whether figures may lie beside an output: it is a file in a folder that takes others.
bool has_room_beside(const std::string& output);

/// Makes sure, before any work, that files can be written to a folder, which may be missing.
/// @throws std::runtime_error naming the folder and the reason
void require_folder(const std::filesystem::path& folder);

/// Runs a program's body and reports a failure in one line on standard error.
/// @return the body's value; 0 after help; 2 for wrong usage; 1 for any other failure
int run_program(const About& about, int argc, const char* const* argv, const std::function<int(Program&)>& body);

}  // namespace support
