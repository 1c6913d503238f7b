#include "cli.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <fstream>
#include <new>
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

}  // namespace

Program::Program(const char* name, const char* description, int argc, const char* const* argv)
    : app_(description, name), name_(name), argc_(argc), argv_(argv) {
  common_.threads = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1u, 1024u));
  app_.get_formatter()->column_width(30);
  app_.option_defaults()->always_capture_default();
}

void Program::parse(const std::string& default_out, const char* out_description, const char* out_type) {
  common_.out = default_out;
  app_.add_option("--json", common_.json, "write the results to this file")
      ->type_name("FILE")
      ->always_capture_default(false);
  if (out_description != nullptr) app_.add_option("--out", common_.out, out_description)->type_name(out_type);
  app_.add_option("--seed", common_.seed, "of everything random")
      ->type_name("S")
      ->check(CLI::NonNegativeNumber.description(""));  // else -1 would wrap around
  app_.add_option("--threads", common_.threads, "threads that compute; the results do not depend on it")
      ->type_name("T")
      ->check(CLI::Range(1, 1024).description(""));
  app_.parse(argc_, argv_);
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
      program.app().exit(error);  // prints the help
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
