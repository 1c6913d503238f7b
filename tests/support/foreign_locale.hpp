// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clocale>
#include <locale>
#include <string>

namespace vernier_test {

/// A host program that writes 1234.5 as 1.234,5, as long as this exists: in C++ always; in C where the system has such
/// a locale.
class ForeignLocale {
 public:
  ForeignLocale() : in_c_(std::setlocale(LC_ALL, nullptr)), in_cpp_(std::locale()) {
    std::locale::global(std::locale(in_cpp_, new Numbers));
    for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "de_DE", "fr_FR.UTF-8", "nl_NL.UTF-8"})
      if (std::setlocale(LC_ALL, name) != nullptr) break;
  }
  ForeignLocale(const ForeignLocale&) = delete;
  ForeignLocale& operator=(const ForeignLocale&) = delete;
  ~ForeignLocale() {
    std::locale::global(in_cpp_);
    std::setlocale(LC_ALL, in_c_.c_str());
  }

  /// Whether printf writes decimal commas, too.
  static bool of_c() { return std::localeconv()->decimal_point[0] == ','; }

 private:
  struct Numbers : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };

  std::string in_c_;
  std::locale in_cpp_;
};

}  // namespace vernier_test
