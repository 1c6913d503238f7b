#pragma once

/// @file
/// What the programs' command lines have in common: options, errors and exit codes. CLI11 parses them; its headers,
/// which every file would compile anew for seconds, are included by cli.cpp alone.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

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

/// An option, while the command line is described.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  Option required();
  Option needs(Option other);     ///< refused without the other one
  Option excludes(Option other);  ///< refused beside the other one
  Option delimiter(char c);       ///< between the values of one argument
  Option expected(int values);    ///< their number
  Option one_value_each();        ///< of an option that may be repeated
  Option description(const std::string& text);
  Option default_text(const std::string& text);  ///< shown in the help in place of the value

  /// Refuses values outside of [low, high], and NaN.
  /// @tparam T int or double
  template <class T>
  Option within(T low, T high);
  Option positive();                                     ///< refuses NaN and infinity, too
  Option not_negative();                                 ///< likewise
  Option one_of(const std::vector<std::string>& words);  ///< refuses all others

 private:
  CLI::Option* option_;
};

/// A program's command line.
///
///     int main(int argc, char** argv) {
///       return support::run_program("calibrate", "Measured poses in, ...", argc, argv, [](support::Program& program) {
///         std::string data;
///         program.add_option("--data", data, "measured poses", "FILE").required();
///         program.parse("calibrate_out");
///         ...
///         return 0;
///       });
///     }
class Program {
 public:
  Program(const char* name, const char* description, int argc, const char* const* argv);
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  ~Program();

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
  /// The option of this name, added before.
  Option option(const char* name);
  /// Whether the user gave it.
  bool given(const char* name) const;
  /// What `--help` prints.
  std::string help() const;

  const CommonOptions& common() const { return common_; }
  const std::string& name() const { return name_; }
  /// As it was typed, words with spaces and the like in quotes.
  std::string command_line() const;

  /// Adds the common options, reads the command line, and makes sure that the JSON file can be written before any
  /// work is done.
  /// @param default_out folder for figures where the user names none
  /// @param out_description,out_type what `--out` is in the help, for a program that writes something else there; null:
  ///        there is no such option
  /// @throws an exception of the parser, which `run_program` turns into help or exit code 2
  /// @throws std::runtime_error where the JSON file cannot be written
  void parse(const std::string& default_out, const char* out_description = "folder for the figures",
             const char* out_type = "FOLDER");

  /// The folder for figures, made where it is missing.
  /// @throws std::runtime_error naming the folder and the reason
  std::filesystem::path output_folder() const;

 private:
  template <class T>
  Option add(const char* name, T& value, const std::string& help, const char* type, bool default_shown);

  std::unique_ptr<CLI::App> app_;
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
