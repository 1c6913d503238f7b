// SPDX-License-Identifier: BSD-3-Clause
#include "cli.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <new>
#include <optional>
#include <set>
#include <system_error>
#include <thread>

#include "console.hpp"
#include "vernier/core/atomic_file.hpp"
#include "vernier/core/detail/destination.hpp"

namespace support {

namespace {

std::string one_line(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

/// Where standard output went before what is for people was sent elsewhere; empty: it still goes there.
std::string output_stream;  // NOLINT(cert-err58-cpp)

/// A line on standard error. If that cannot be written, nobody reads it: the exit code still tells.
void say(const std::string& line) { static_cast<void>(std::fputs((line + "\n").c_str(), stderr)); }

int fail(const char* name, const std::string& what, int code) {
  std::fflush(stdout);
  std::string line = what;
  if (const std::size_t at = output_stream.empty() ? std::string::npos : line.find(output_stream);
      at != std::string::npos)
    line.replace(at, output_stream.size(), "standard output");
  if (line.starts_with(std::string(name) + ": ")) line.erase(0, std::strlen(name) + 2);  // of the function so called
  say(fmt::format("{}: {}", styled(name, Look::bad, STDERR_FILENO), one_line(line)));
  return code;
}

/// Keeps standard output for a result, and sends what is printed to standard error.
/// @return a path that leads to what was standard output
std::string standard_output() {
  std::fflush(stdout);
  const int kept = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  if (kept < 0 || dup2(STDERR_FILENO, STDOUT_FILENO) < 0)
    throw std::runtime_error(fmt::format("standard output cannot be written: {}", std::strerror(errno)));
  return output_stream = fmt::format("/dev/fd/{}", kept);
}

/// Whether a stream of this process goes to a regular file.
bool goes_to(int stream, const std::string& file) {
  struct stat of_stream {
  }, of_file{};
  return fstat(stream, &of_stream) == 0 && stat(file.c_str(), &of_file) == 0 && S_ISREG(of_file.st_mode) &&
         of_stream.st_dev == of_file.st_dev && of_stream.st_ino == of_file.st_ino;
}

constexpr std::array<Group, 5> groups{Group::input, Group::model, Group::validation, Group::output, Group::general};

const char* title_of(Group group) {
  constexpr std::array<const char*, groups.size()> titles{"Input", "Model", "Validation", "Output", "General"};
  return titles[static_cast<std::size_t>(group)];
}

/// What is printed in place of the program's work.
struct Answer {
  std::string text;
};

constexpr std::size_t width_of_help = 80;

/// Text in lines of the help's width, those behind the first one indented.
std::string wrapped(const std::string& text, std::size_t indent, std::size_t column = 0) {
  std::string out;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    if (column > indent && column + 1 + end - at > width_of_help) {
      out += '\n' + std::string(indent, ' ');
      column = indent;
    } else if (at > 0) {
      out += ' ';
      ++column;
    }
    out.append(text, at, end - at);
    column += end - at;
    at = end + 1;
  }
  return out + '\n';
}

/// A name and what it means, which begins in a column of its own.
std::string entry(const std::string& name, const std::string& meaning, std::size_t column) {
  std::string out = "  " + name;
  if (meaning.empty()) return "  " + wrapped(name, 6, 2);
  if (out.size() + 2 > column) return out + '\n' + std::string(column, ' ') + wrapped(meaning, column, column);
  out.resize(column, ' ');
  return out + wrapped(meaning, column, column);
}

/// An option as it is typed.
std::string with_value(const CLI::Option& option) {
  const std::string name = option.get_name(option.get_positional(), !option.get_positional());
  if (option.get_items_expected_max() == 0) return name;
  const std::string more =
      option.get_expected_max() > 1 && option.get_type_name().find(',') == std::string::npos ? "..." : "";
  return option.get_positional() ? option.get_type_name() : name + ' ' + option.get_type_name() + more;
}

/// What an option does, its default, and which others it needs or excludes.
std::string explained(const CLI::Option& option) {
  std::string out = (option.get_required() ? "REQUIRED: " : "") + option.get_description();
  const std::string value = option.get_default_str();  // of several values in brackets already
  if (!value.empty()) out += value.front() == '[' ? " " + value : fmt::format(" [{}]", value);
  const auto list = [&](const char* title, const std::set<CLI::Option*>& others) {
    std::vector<std::string> names;
    for (const CLI::Option* other : others) names.push_back(other->get_name());
    std::sort(names.begin(), names.end());
    if (!names.empty()) out += fmt::format("; {} {}", title, fmt::join(names, ", "));
  };
  list("needs", option.get_needs());
  list("not with", option.get_excludes());
  return out;
}

/// A check of one value that the help does not mention.
template <class T, class Accepts>
void check(CLI::Option& option, const std::string& wanted, const Accepts& accepts) {
  option.check(CLI::Validator(
      [wanted, accepts](std::string& text) {
        T value{};
        if (CLI::detail::lexical_cast(text, value) && accepts(value)) return std::string();
        return fmt::format("Value {} {}", text, wanted);
      },
      ""));
}

}  // namespace

Option Option::required() {
  option_->required();
  return *this;
}

Option Option::required_without(const std::string& others) {
  option_->description("REQUIRED without " + others + ": " + option_->get_description());
  return *this;
}

Option Option::needs(Option other) {
  option_->needs(other.option_);
  return *this;
}

Option Option::excludes(Option other) {
  option_->excludes(other.option_);
  return *this;
}

Option Option::delimiter(char c) {
  option_->delimiter(c);
  return *this;
}

Option Option::expected(int values) {
  option_->expected(values);
  return *this;
}

Option Option::one_value_each() {
  option_->allow_extra_args(false);
  return *this;
}

Option Option::description(const std::string& text) {
  option_->description(text);
  return *this;
}

Option Option::default_text(const std::string& text) {
  option_->default_str(text);
  return *this;
}

template <class T>
Option Option::within(T low, T high) {
  check<T>(*option_, fmt::format("not in range {} to {}", low, high),
           [low, high](T value) { return value >= low && value <= high; });
  return *this;
}
template Option Option::within(int, int);
template Option Option::within(double, double);

Option Option::positive() {
  check<double>(*option_, "is not a positive number", [](double value) { return value > 0 && std::isfinite(value); });
  return *this;
}

Option Option::not_negative() {
  check<double>(*option_, "is not a number of at least 0",
                [](double value) { return value >= 0 && std::isfinite(value); });
  return *this;
}

Option Option::one_of(const std::vector<std::string>& words) {
  option_->check(CLI::IsMember(words).description(""));
  return offers(words);
}

Option Option::offers(const std::vector<std::string>& words) {
  (*offered_)[option_] = words;
  return *this;
}

Program::Program(const About& about, int argc, const char* const* argv)
    : about_(about), app_(std::make_unique<CLI::App>(about.purpose, about.name)), argc_(argc), argv_(argv) {
  common_.threads = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1u, 1024u));
  app_->set_help_flag();  // shown with the others
}

Program::~Program() = default;

template <class T>
Option Program::add(const char* name, T& value, const std::string& help, const char* type, bool default_shown) {
  CLI::Option* option = app_->add_option(name, value, help)->type_name(type)->group(title_of(group_));
  if (default_shown) option->capture_default_str();
  return {option, offered_};
}
template Option Program::add(const char*, std::string&, const std::string&, const char*, bool);
template Option Program::add(const char*, std::filesystem::path&, const std::string&, const char*, bool);
template Option Program::add(const char*, int&, const std::string&, const char*, bool);
template Option Program::add(const char*, std::ptrdiff_t&, const std::string&, const char*, bool);
template Option Program::add(const char*, std::uint64_t&, const std::string&, const char*, bool);
template Option Program::add(const char*, double&, const std::string&, const char*, bool);
template Option Program::add(const char*, std::optional<std::ptrdiff_t>&, const std::string&, const char*, bool);
template Option Program::add(const char*, std::optional<double>&, const std::string&, const char*, bool);
template Option Program::add(const char*, std::vector<std::string>&, const std::string&, const char*, bool);
template Option Program::add(const char*, std::vector<std::filesystem::path>&, const std::string&, const char*, bool);
template Option Program::add(const char*, std::vector<std::ptrdiff_t>&, const std::string&, const char*, bool);
template Option Program::add(const char*, std::vector<std::uint64_t>&, const std::string&, const char*, bool);
template Option Program::add(const char*, std::vector<double>&, const std::string&, const char*, bool);

Option Program::add_flag(const char* name, bool& value, const char* help) {
  return {app_->add_flag(name, value, help)->group(title_of(group_)), offered_};
}

Option Program::add_output(const char* name, std::string& file, const std::string& help) {
  outputs_.emplace_back(name, &file);
  return add_option(name, file, help, "FILE");
}

Option Program::option(const char* name) { return {app_->get_option(name), offered_}; }

bool Program::given(const char* name) const { return app_->count(name) > 0; }

std::string Program::help() const {
  std::string usage = fmt::format("usage: {}", about_.name), out;
  for (const Group group : groups) {
    std::string lines;
    for (const CLI::Option* option : app_->get_options()) {
      if (option->get_group() != title_of(group)) continue;
      const std::string name = with_value(*option);
      if (option->get_required()) usage += ' ' + name;
      lines += entry(name, explained(*option), 26);
    }
    if (!lines.empty()) out += fmt::format("\n{}:\n{}", title_of(group), lines);
  }
  out += "\nExamples:\n";
  for (const char* example : about_.examples) out += entry(example, "", 0);
  out += "\nExit codes:\n" + entry("0", about_.done, 5) + entry("1", about_.failed, 5) +
         entry("2", "wrong usage: an unknown option, a missing one, a value out of range", 5);
  return wrapped(about_.purpose, 0) + "\n" + wrapped(usage + " [OPTION...]", 4) + out;
}

std::string Program::completion() const {
  std::string options, cases, unoffered;
  for (const CLI::Option* option : app_->get_options()) {
    if (option->get_lnames().empty()) continue;
    const std::string name = "--" + option->get_lnames().front(), type = option->get_type_name();
    options += (options.empty() ? "" : " ") + name;
    if (option->get_items_expected_max() == 0) continue;
    const bool files = type.find("FILE") != std::string::npos || type == "FOLDER" || type == "PREFIX";
    const auto offered = offered_.find(option);
    if (offered != offered_.end())
      cases += fmt::format("    {}) mapfile -t COMPREPLY < <(compgen -W '{}' -- \"$word\"{}); return ;;\n", name,
                           fmt::join(offered->second, " "), files ? "; compgen -f -- \"$word\"" : "");
    else
      (files ? cases : unoffered) +=
          files ? fmt::format("    {}) return ;;\n", name) : (unoffered.empty() ? "" : " | ") + name;
  }
  if (!unoffered.empty()) cases += fmt::format("    {}) compopt +o default 2>/dev/null; return ;;\n", unoffered);
  return fmt::format(
      "# bash completion of {0}, printed by {0} --completion. Files are completed by default.\n"
      "_vernier_{0}() {{\n"
      "  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}}\n"
      "  COMPREPLY=()\n"
      "  case $before in\n{1}  esac\n"
      "  [[ -z $word || $word == -* ]] && mapfile -t COMPREPLY < <(compgen -W '{2}' -- \"$word\")\n"
      "}}\n"
      "complete -o default -F _vernier_{0} {0}\n",
      about_.name, cases, options);
}

void Program::parse(const std::string& default_out, const char* out_description, const char* out_type) {
  group(Group::output);
  common_.out = default_out;
  add_output("--json", common_.json, "write the results to this file; -: to standard output");
  if (out_description != nullptr) {
    const bool file = out_type == std::string("FILE");
    const Option out = default_out.empty() ? add_option("--out", common_.out, out_description, out_type)
                                           : add_setting("--out", common_.out, out_description, out_type);
    if (file && default_out.empty()) Option(out).required();
    if (file) outputs_.emplace_back("--out", &common_.out);
  }
  bool quiet = false;
  add_flag("--quiet", quiet, "print nothing but errors; files and exit codes are as without");
  group(Group::general);
  add_setting("--seed", common_.seed, "seed of all random numbers", "S").not_negative();  // else -1 would wrap around
  add_setting("--threads", common_.threads, "threads that compute; the results do not depend on it", "T")
      .within(1, 1024);
  bool completion_asked = false;
  add_flag("--completion", completion_asked, "print the completion for bash: source <(PROGRAM --completion)");
  app_->set_help_flag("-h,--help", "print this help")->group(title_of(Group::general));
  if (argc_ == 2 && argv_[1] == std::string("--completion")) throw Answer{completion()};
  app_->parse(argc_, argv_);
  if (completion_asked) throw UsageError("--completion stands alone");
  for (const auto& [name, file] : outputs_) open_output(name, *file);
  if (quiet) be_quiet();
}

void Program::open_output(const std::string& name, std::string& file) {
  if (file.empty()) return;
  const bool figure = name == "--out" || name == "--svg";
  if (!figure && std::filesystem::path(file).extension() == ".svg")  // else a figure may overwrite it
    throw UsageError(fmt::format("{} {}: names that end in .svg are for figures; take another name", name, file));
  vernier::detail::Destination to{.file = {}, .descriptor = STDOUT_FILENO};
  vernier::Writing writing = vernier::Writing::through;
  if (file != "-") {
    writing = vernier::writing_of(file);
    to = vernier::detail::destination_of(file);
  }
  std::string place = fmt::format("descriptor {}", to.descriptor);
  if (to.descriptor < 0) {
    for (const int stream : {STDOUT_FILENO, STDERR_FILENO})
      if (writing != vernier::Writing::through && goes_to(stream, to.file))
        throw UsageError(fmt::format("{} {}: standard {} goes to that file", name, file,
                                     stream == STDOUT_FILENO ? "output" : "error"));
    place = std::filesystem::weakly_canonical(std::filesystem::absolute(to.file)).string();
  }
  if (const auto [other, alone] = opened_.try_emplace(place, name);
      !alone && !std::filesystem::is_character_file(to.file.empty() ? "-" : to.file))
    throw UsageError(fmt::format("{} and {} cannot both be {}", other->second, name,
                                 to.descriptor == STDOUT_FILENO ? "standard output" : file));
  if (writing == vernier::Writing::in_place)
    say(fmt::format("{}: {} cannot be replaced by a whole new file; it is written in place, at the end", about_.name,
                    file));
  if (to.descriptor == STDOUT_FILENO) file = standard_output();
}

void Program::require_output_folder() const {
  if (common_.out == "-") throw UsageError("--out takes a folder, which cannot be standard output");
  require_folder(common_.out);
}

std::string Program::command_line() const {
  std::string out = about_.name;
  for (int i = 1; i < argc_; ++i) {
    const std::string word = argv_[i];
    const bool plain = !word.empty() && word.find_first_of(" \t\n\"'\\$`&|;<>()*?[]#~!{}") == std::string::npos;
    out += ' ';
    if (plain) {
      out += word;
      continue;
    }
    out += '\'';
    for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    out += '\'';
  }
  return out;
}

std::filesystem::path Program::output_folder() const {
  std::error_code error;
  std::filesystem::create_directories(common_.out, error);
  if (error) throw std::runtime_error(common_.out + ": the folder cannot be made: " + error.message());
  if (!std::filesystem::is_directory(common_.out)) throw std::runtime_error(common_.out + ": is not a folder");
  return common_.out;
}

std::string today() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  return fmt::format("{:04}-{:02}-{:02}", utc.tm_year + 1900, utc.tm_mon + 1, utc.tm_mday);
}

std::string shown(const std::string& output) { return output == output_stream ? "standard output" : output; }

bool has_room_beside(const std::string& output) { return vernier::writing_of(output) == vernier::Writing::replaced; }

void require_folder(const std::filesystem::path& folder) {
  std::filesystem::path there = folder.empty() ? "." : folder;
  std::error_code error;
  while (!std::filesystem::exists(std::filesystem::symlink_status(there, error)) && there != there.root_path())
    there = there.has_parent_path() ? there.parent_path() : ".";
  if (!std::filesystem::is_directory(there, error)) throw std::runtime_error(there.string() + ": is not a folder");
  if (faccessat(AT_FDCWD, there.c_str(), W_OK | X_OK, AT_EACCESS) != 0)
    throw std::runtime_error(
        fmt::format("{}: this folder takes no new files: {}", there.string(), std::strerror(errno)));
}

int run_program(const About& about, int argc, const char* const* argv, const std::function<int(Program&)>& body) {
  const char* name = about.name;
  try {
    Program program(about, argc, argv);
    int code = 0;
    try {
      code = body(program);
    } catch (const Answer& answer) {
      fmt::print("{}", answer.text);
    } catch (const CLI::ParseError& error) {
      if (error.get_exit_code() != 0) return fail(name, std::string(error.what()) + " (see --help)", 2);
      fmt::print("{}", program.help());
    }
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) return fail(name, "standard output cannot be written", 1);
    return code;
  } catch (const UsageError& error) {
    return fail(name, std::string(error.what()) + " (see --help)", 2);
  } catch (const std::bad_alloc&) {
    return fail(name, "out of memory", 1);
  } catch (const std::exception& error) {
    return fail(name, error.what(), 1);
  }
}

}  // namespace support
