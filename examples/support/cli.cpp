#include "cli.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <fstream>
#include <new>
#include <optional>
#include <thread>

namespace support {

namespace {

std::string one_line(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

int fail(const char* name, const std::string& what, int code) {
  std::fflush(stdout);
  fmt::print(stderr, "{}: {}\n", name, one_line(what));
  return code;
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
  return *this;
}

Program::Program(const char* name, const char* description, int argc, const char* const* argv)
    : app_(std::make_unique<CLI::App>(description, name)), name_(name), argc_(argc), argv_(argv) {
  common_.threads = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1u, 1024u));
  app_->get_formatter()->column_width(30);
}

Program::~Program() = default;

template <class T>
Option Program::add(const char* name, T& value, const std::string& help, const char* type, bool default_shown) {
  CLI::Option* option = app_->add_option(name, value, help)->type_name(type);
  if (default_shown) option->capture_default_str();
  return Option(option);
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
  return Option(app_->add_flag(name, value, help));
}

Option Program::option(const char* name) { return Option(app_->get_option(name)); }

bool Program::given(const char* name) const { return app_->count(name) > 0; }

std::string Program::help() const { return app_->help(); }

void Program::parse(const std::string& default_out, const char* out_description, const char* out_type) {
  common_.out = default_out;
  add_option("--json", common_.json, "write the results to this file", "FILE");
  if (out_description != nullptr) add_setting("--out", common_.out, out_description, out_type);
  add_setting("--seed", common_.seed, "of everything random", "S").not_negative();  // else -1 would wrap around
  add_setting("--threads", common_.threads, "threads that compute; the results do not depend on it", "T")
      .within(1, 1024);
  app_->parse(argc_, argv_);
  if (!common_.json.empty()) require_writable(common_.json);
}

std::string Program::command_line() const {
  std::string out = name_;
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

void require_writable(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw std::runtime_error(path.string() + ": is a folder, cannot be written as a file");
  std::filesystem::path beside = path;
  beside += ".partial";
  errno = 0;
  const bool opened = std::ofstream(beside, std::ios::app).is_open();
  const int reason = errno;
  if (!opened)
    throw std::runtime_error(path.string() +
                             ": cannot be written: " + (reason != 0 ? std::strerror(reason) : "unknown reason"));
  std::filesystem::remove(beside, error);
}

int run_program(const char* name, const char* description, int argc, const char* const* argv,
                const std::function<int(Program&)>& body) {
  try {
    Program program(name, description, argc, argv);
    int code = 0;
    try {
      code = body(program);
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
