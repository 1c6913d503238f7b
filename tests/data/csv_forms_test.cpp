// SPDX-License-Identifier: BSD-3-Clause
// Forms in which programs write CSV files: each is read as it is meant, or refused in one line that says what to state.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "complaint.hpp"
#include "temporary_folder.hpp"
#include "vernier/core/atomic_file.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/data/detail/csv_columns.hpp"

namespace vernier::csv_forms_test {
namespace {

class CsvForms : public ::testing::Test {
 protected:
  CsvForms() { std::filesystem::current_path(folder_.path()); }
  ~CsvForms() override { std::filesystem::current_path(before_); }

  Dataset<2> read(const std::string& text, CsvFormat format = {}) {
    write_file("f.csv", text);
    remarks_.clear();
    format.remark = [this](const std::string& line) { remarks_.push_back(line); };
    return read_dataset<2>("f.csv", {}, format);
  }
  /// What is said of a file that is refused; empty for one that is read.
  std::string refused(const std::string& text, const CsvFormat& format = {}) {
    const std::string said = vernier_test::complaint([&] { (void)read(text, format); });
    for (const char c : said) EXPECT_TRUE(c >= ' ' && c <= '~') << said;
    return said;
  }
  /// Whether a file has the row 0.5, -1.25 rad, 100, -200, 300.5 mm.
  void expect_read(const std::string& text, const CsvFormat& format = {}) {
    SCOPED_TRACE(testing::PrintToString(text));
    Dataset<2> data;
    ASSERT_NO_THROW(data = read(text, format));
    ASSERT_EQ(data.size(), 1);
    EXPECT_DOUBLE_EQ(data.joints()(0, 0), 0.5);
    EXPECT_DOUBLE_EQ(data.joints()(0, 1), -1.25);
    EXPECT_DOUBLE_EQ(data.positions()(0, 0), 0.1);
    EXPECT_DOUBLE_EQ(data.positions()(0, 1), -0.2);
    EXPECT_DOUBLE_EQ(data.positions()(0, 2), 0.3005);
  }

  std::vector<std::string> remarks_{};

 private:
  std::filesystem::path before_ = std::filesystem::current_path();
  vernier_test::TemporaryFolder folder_{"csv_forms"};
};

const std::string head = "q1_rad,q2_rad,x_mm,y_mm,z_mm";
const std::string row = "0.5,-1.25,100,-200,300.5";

std::string with(std::string text, char comma, char point = '.') {
  for (char& c : text) c = c == ',' ? comma : c == '.' ? point : c;
  return text;
}

TEST_F(CsvForms, LineEndsOfAnySystem) {
  expect_read(head + "\r" + row + "\r");              // CR alone
  expect_read("\xEF\xBB\xBF" + head + "\r\r" + row);  // and blank lines
  expect_read("\r\n" + head + "\n" + row + "\r\n");   // mixed
  EXPECT_EQ(refused(head + "\r" + row + "\r0.5,x,1,2,3\r"), "f.csv, line 3, column q2_rad: 'x' is not a number");
  using namespace std::string_literals;
  for (const std::string& mark : {"\xFF\xFE"s, "\xFE\xFF"s})
    EXPECT_NE(refused(mark + "q\0"s).find("f.csv, line 1: binary data, not text (UTF-16?"), std::string::npos);
}

TEST_F(CsvForms, QuotationMarksAroundCells) {
  expect_read("\"q1_rad\",\"q2_rad\",\"x_mm\",\"y_mm\",\"z_mm\"\n" + row + "\n");             // text quoted, as R does
  expect_read("\"\",\"q1_rad\",\"q2_rad\",\"x_mm\",\"y_mm\",\"z_mm\"\n\"1\"," + row + "\n");  // its row names
  expect_read(head + "\n\"0.5\", \"-1.25\" ,\" 100\",\"-200\",\"300.5\"\n");
  expect_read("note," + head + "\n\"tool 3, left\"," + row + "\n");
  expect_read("note," + head + "\n5\" tool," + row + "\n");  // none that enclose
  expect_read("\"q1_rad\" q2_rad x_mm y_mm z_mm\n0.5 \"-1.25\"\t100 -200 300.5\n", {.separator = ' '});
  EXPECT_EQ(refused(head + "\n\"0.5,-1.25,100,-200,300.5\n"), "f.csv, line 2: a quotation mark without its partner");
  EXPECT_EQ(refused(head + "\n\"0\"\"5\",-1.25,100,-200,300.5\n"),
            "f.csv, line 2: text behind a closing quotation mark");
  EXPECT_EQ(refused("\"q1\"_rad,q2_rad\n"), "f.csv, line 1: text behind a closing quotation mark");
}

TEST_F(CsvForms, OtherSeparators) {
  for (const char separator : {';', '\t', '|', ' ', ':'}) {
    expect_read(with(head, separator) + "\n" + with(row, separator) + "\n", {.separator = separator});
    if (separator == ':') continue;  // rare enough not to be named
    const std::string option = separator == ' '    ? "space"
                               : separator == '\t' ? "tab"
                                                   : "'" + std::string(1, separator) + "'";
    const std::string name = separator == ' ' ? "blanks" : separator == '\t' ? "tabs" : option;
    EXPECT_EQ(refused(with(head, separator) + "\n" + with(row, separator) + "\n"),
              "f.csv, line 1: columns are separated by " + name + ", not ','; state that: --separator " + option +
                  " (CsvFormat)");
  }
  expect_read("  q1_rad   q2_rad\tx_mm y_mm z_mm  \n 0.5 -1.25 \t 100 -200   300.5\n", {.separator = ' '});
  EXPECT_NE(refused(head + "\n" + row + "\n", {.separator = ';'}).find("separated by ',', not ';'"), std::string::npos);
  expect_read("sep=;\r\n" + with(head, ';') + "\r\n" + with(row, ';') + "\r\n", {.separator = ';'});  // of Excel
  EXPECT_EQ(refused("sep=;\r\n" + with(head, ';') + "\r\n"),
            "f.csv, line 1: columns are separated by ';', not ','; state that: --separator ';' (CsvFormat)");
}

TEST_F(CsvForms, DecimalCommas) {
  const CsvFormat german{.separator = ';', .decimal = ','};
  expect_read(with(head, ';') + "\n" + with(row, ';', ',') + "\n", german);
  expect_read(with(head, '\t') + "\n" + with(row, '\t', ',') + "\n", {.separator = '\t', .decimal = ','});
  expect_read(with(head, ';') + "\n\"0,5\";-1,25e0;+100;-2,0E2;300,5\n", german);
  // without the options, both are named
  EXPECT_EQ(
      refused(with(head, ';') + "\n" + with(row, ';', ',') + "\n"),
      "f.csv, line 1: columns are separated by ';', not ','; state that: --separator ';' --decimal ',' (CsvFormat)");
  EXPECT_NE(refused(with(head, ';') + "\n" + with(row, ';', ',') + "\n", {.separator = ';'})
                .find("line 2, column q1_rad: '0,5' is not a number; if its comma is a decimal one: --decimal ','"),
            std::string::npos);
  EXPECT_NE(refused(with(head, ';') + "\n" + with(row, ';') + "\n", german)
                .find("line 2, column q1_rad: '0.5' is not a number; if its point is a decimal one: --decimal ."),
            std::string::npos);
  EXPECT_NE(refused(head + "\n0,5,-1,25,100,0,-200,0,300,5\n").find("line 2: 10 values, the header has 5; decimal"),
            std::string::npos);
  for (const char* thousands : {"1.234,5", "1 234,5", "1'234,5", "1,234,567"})
    EXPECT_NE(refused(with(head, ';') + "\n0,5;1;" + thousands + ";2;3\n", german).find("line 2, column x_mm: "),
              std::string::npos)
        << thousands;
  EXPECT_NE(refused(head + "\n0.5,1,\"1,234.5\",2,3\n").find("line 2, column x_mm: '1,234.5' is not a number"),
            std::string::npos);
}

TEST_F(CsvForms, FormatsThatCannotBe) {
  for (const char separator : {'.', '-', '+', 'x', '7', '"', '\n', '_'})
    EXPECT_NE(refused(head + "\n", {.separator = separator}).find("cannot be a separator"), std::string::npos);
  EXPECT_NE(refused(head, {.separator = ';', .decimal = ';'}).find("cannot be a decimal point"), std::string::npos);
  EXPECT_NE(refused(head, {.decimal = ','}).find("both the separator and the decimal point"), std::string::npos);
}

// A header is hinted at where it differs by case, by brackets or by its unit, and by nothing else.
TEST(CsvColumns, NearestNames) {
  for (const auto& [name, known] : std::vector<std::pair<std::string, std::string>>{{"Q1_RAD", "q1_rad"},
                                                                                    {"X_mm", "x_mm"},
                                                                                    {"x [mm]", "x_mm"},
                                                                                    {"x(mm)", "x_mm"},
                                                                                    {" Z  [ m ] ", "z_m"},
                                                                                    {"q1(deg)", "q1_deg"},
                                                                                    {"q12 rad", "q12_rad"},
                                                                                    {"From_Q3_Deg", "from_q3_deg"},
                                                                                    {"RX-rad", "rx_rad"},
                                                                                    {"x [\xC2\xB5m]", "x_um"},
                                                                                    {"Y [\xCE\xBCm]", "y_um"},
                                                                                    {"temperature [\xC2\xB0"
                                                                                     "C]",
                                                                                     "temperature_c"},
                                                                                    {"Temperature_C", "temperature_c"},
                                                                                    {"Time_s", "time_s"},
                                                                                    {"TIME [ms]", "time_ms"},
                                                                                    {"time", "time_s"},
                                                                                    {"time_min", "time_s"},
                                                                                    {"x_inch", "x_mm"},
                                                                                    {"x", "x_mm"},
                                                                                    {"q2", "q2_rad"},
                                                                                    {"q2_degrees", "q2_rad"},
                                                                                    {"temperature_k", "temperature_c"},
                                                                                    {"Segment", "segment"},
                                                                                    {"Contact-ID", "contact_id"},
                                                                                    {"distance", "distance_mm"},
                                                                                    {"rx_mm", "rx_rad"},
                                                                                    // no hint
                                                                                    {"x_mm", ""},
                                                                                    {"q1_rad", ""},
                                                                                    {"note", ""},
                                                                                    {"", ""},
                                                                                    {"x_axis_current", ""},
                                                                                    {"q1_current_a", ""},
                                                                                    {"timestamp", ""},
                                                                                    {"q", ""},
                                                                                    {"q01_rad", ""},
                                                                                    {"\xC2", ""},
                                                                                    {"xy", ""},
                                                                                    {"current_x_mm", ""}})
    EXPECT_EQ(detail::nearest_column(name), known) << name;
}

TEST_F(CsvForms, ColumnsThatAreNotReadAreSaidOnce) {
  (void)read(head + ",note,Time_s,visit,x_inch,q1 (deg),,segment\n" + row + ",a,1,2,3,4,5,6\n");
  EXPECT_EQ(remarks_, (std::vector<std::string>{"f.csv: columns that are not read: note, Time_s (time_s?), x_inch "
                                                "(x_mm?), q1 (deg) (q1_deg?)"}));
  (void)read(head + ",from_q1_rad,from_q2_rad,segment\n" + row + ",1,2,3\n");  // it has no effect then
  EXPECT_EQ(remarks_, (std::vector<std::string>{"f.csv: columns that are not read: segment"}));
  (void)read(head + ",time_s,temperature_c,segment\n" + row + ",1,2,3\n");
  EXPECT_TRUE(remarks_.empty());
  std::string many = head, values = row;
  for (int k = 0; k < 15; ++k) many += ",n" + std::to_string(k), values += ",1";
  (void)read(many + "\n" + values + "\n");
  ASSERT_EQ(remarks_.size(), 1u);
  EXPECT_NE(remarks_[0].find("n10, n11, and 3 more"), std::string::npos) << remarks_[0];
  (void)read(head + ",\xFF\x1B[2J\n" + row + ",1\n");
  EXPECT_EQ(remarks_, (std::vector<std::string>{"f.csv: columns that are not read: ??[2J"}));
}

// Without anybody to tell, a name that looks like a known one is refused, and others are left alone.
TEST_F(CsvForms, NobodyToTell) {
  write_file("f.csv", head + ",note\n" + row + ",a\n");
  EXPECT_EQ(read_dataset<2>("f.csv").size(), 1);
  for (const auto& [name, known] :
       {std::pair{"RX_rad", "rx_rad"}, {"time", "time_s"}, {"Temperature [C]", "temperature_c"}}) {
    write_file("f.csv", head + "," + name + "\n" + row + ",1\n");
    EXPECT_EQ(vernier_test::complaint([] { (void)read_dataset<2>("f.csv"); }),
              message("f.csv, line 1: column '", name, "' is not known; is it ", known,
                      "? Rename it, or take CsvFormat::remark, and it is not read"));
  }
  write_file("f.csv", "q1_rad,q2_rad,Move\n1,2,j\n");
  EXPECT_NE(vernier_test::complaint([] { (void)read_targets<2>("f.csv"); }).find("is it move?"), std::string::npos);
  write_file("f.csv", "q1_rad,q2_rad,distance_mm,Distance_m\n1,2,3,4\n");
  EXPECT_NE(vernier_test::complaint([] { (void)read_distances<2>("f.csv"); }).find("is it distance_m?"),
            std::string::npos);
}

TEST_F(CsvForms, ColumnsThatAreThereTwice) {
  for (const char* name : {"segment", "time_s", "temperature_c", "from_q1_rad", "x_mm", "move", "visit"}) {
    const std::string text = head + "," + name + "," + name + "\n" + row + ",1,1\n";
    EXPECT_EQ(refused(text), std::string("f.csv, line 1: column ") + name + " is there twice");
  }
  for (const auto& [a, b, stem] : {std::tuple{"time_s", "time_ms", "time"}, {"rx_rad", "rx_deg", "rx"}})
    EXPECT_EQ(refused(head + "," + a + "," + b + "\n" + row + ",1,1\n"),
              message("f.csv, line 1: columns ", a, " and ", b, " both give ", stem));
  EXPECT_EQ(refused("q1_rad,q2_rad,q2_deg,x_mm,y_mm,z_mm\n"), "f.csv, line 1: columns q2_rad and q2_deg both give q2");
  EXPECT_EQ(refused(head + ",from_q1_rad,from_q1_mm,from_q2_rad\n" + row + ",1,1,1\n"),
            "f.csv, line 1: columns from_q1_mm and from_q1_rad both give from_q1");
  expect_read(head + ",note,note,,\n" + row + ",1,2,3,\n");  // which mean nothing
  for (const auto& read_one : std::vector<std::pair<std::string, void (*)()>>{
           {"contact_id,contact_id,kind,q1_rad\n", [] { (void)read_contacts("f.csv", 1); }},
           {"pose,pose,cycle,x_mm,y_mm,z_mm\n", [] { (void)read_labelled_poses("f.csv", {"pose"}); }},
           {"move,move,q1_rad\n", [] { (void)read_targets<1>("f.csv"); }}}) {
    write_file("f.csv", read_one.first);
    EXPECT_NE(vernier_test::complaint(read_one.second).find("is there twice"), std::string::npos) << read_one.first;
  }
}

TEST_F(CsvForms, JointsOfAnotherArm) {
  EXPECT_EQ(refused("q0_rad,q1_rad,q2_rad,x_mm,y_mm,z_mm\n"),
            "f.csv, line 1: column q0_rad, but the robot has 2 joints, counted from 1");
  for (const char* name : {"q3_deg", "q9_mm", "q12_um"})
    EXPECT_EQ(refused(head + "," + name + "\n"),
              message("f.csv, line 1: column ", name, ", but the robot has 2 joints"));
  // a part of the approach is not passed over
  EXPECT_NE(refused(head + ",from_q2_rad\n" + row + ",1\n").find("no column from_q1_rad"), std::string::npos);
  EXPECT_NE(refused(head + ",from_q1_rad\n" + row + ",1\n").find("no column from_q2_rad"), std::string::npos);
  EXPECT_NE(refused(head + ",from_q1_rad,from_q2_rad,from_q3_rad\n" + row + ",1,1,1\n").find("column from_q3_rad, but"),
            std::string::npos);
}

TEST_F(CsvForms, TimesInSecondsAndMilliseconds) {
  const auto timed = [&](const std::string& name, const std::string& value) {
    return head + "," + name + "\n" + row + "," + value + "\n";
  };
  EXPECT_EQ(read(timed("time_s", "1714561234.25")).times()(0), 1714561234.25);  // Unix time
  EXPECT_EQ(read(timed("time_ms", "1714561234250")).times()(0), 1714561234.25);
  EXPECT_EQ(read(timed("time_ms", "250")).times()(0), 0.25);
  EXPECT_EQ(read(timed("time_s", "-3.5e1")).times()(0), -35);
  EXPECT_EQ(read(timed("time_s", "99999999999")).times()(0), 99999999999.0);
  const std::string beyond = " is beyond any time (1e11 s); time_s is in seconds, milliseconds are a column time_ms";
  for (const char* value : {"1714561234250", "1e11", "-1714561234250"})
    EXPECT_EQ(refused(timed("time_s", value)), message("f.csv, line 2, column time_s: '", value, "'", beyond));
  EXPECT_EQ(refused(timed("time_ms", "1714561234250000")),
            "f.csv, line 2, column time_ms: '1714561234250000'" + beyond);
  for (const char* date : {"2024-05-01T12:00:00Z", "2024-05-01", "12:30:05", "5/1/2024"})
    EXPECT_EQ(refused(timed("time_s", date)),
              message("f.csv, line 2, column time_s: '", date,
                      "' is a date or a time of day; seconds are needed, Unix time or any other"));
  for (const char* none : {"", "nan", "inf", "noon"})
    EXPECT_NE(refused(timed("time_s", none)).find("line 2, column time_s: "), std::string::npos) << none;
  write_file("f.csv", "pose,x_mm,y_mm,z_mm,time_ms\n1,2,3,4,1500\n");
  EXPECT_EQ(read_labelled_poses("f.csv", {"pose"}).times(0), 1.5);
}

// A row that was measured before the one above was not approached from there.
TEST_F(CsvForms, TimesThatGoBack) {
  const auto rows = [&](const std::vector<double>& times, const std::string& more = "", const std::string& cell = "") {
    std::string out = head + ",time_s" + more + "\n";
    for (std::size_t i = 0; i < times.size(); ++i) out += message(i, ",0,1,2,3,", times[i], cell, '\n');
    return out;
  };
  const auto data = read(rows({0, 1, 1, 0.5, 2}));
  for (const auto& [i, known] : {std::pair<Index, bool>{0, false}, {1, true}, {2, true}, {3, false}, {4, true}})
    EXPECT_EQ(std::isfinite(data.previous()(i, 0)), known) << i;
  ASSERT_EQ(remarks_.size(), 1u);
  EXPECT_EQ(remarks_[0].find("f.csv, line 5: the time goes back; the approach of 1 such pose is unknown"), 0u);
  (void)read(rows({3, 2, 1}, ",from_q1_rad,from_q2_rad", ",0,0"));  // stated
  EXPECT_TRUE(remarks_.empty());
  (void)read(rows({3, 3, 3}));
  EXPECT_TRUE(remarks_.empty());
}

// Every column has limits of its own.
TEST_F(CsvForms, ValuesThatCanBeMeant) {
  const auto cell = [&](const std::string& name, const std::string& value) {
    std::string header = head, values = row;
    if (const auto at = header.find(name); at != std::string::npos) {
      const auto column = std::count(header.begin(), header.begin() + static_cast<std::ptrdiff_t>(at), ',');
      std::size_t begin = 0;
      for (std::ptrdiff_t k = 0; k < column; ++k) begin = values.find(',', begin) + 1;
      values.replace(begin, std::min(values.find(',', begin), values.size()) - begin, value);
    } else {
      header += "," + name;
      values += "," + value;
    }
    return refused(header + "\n" + values + "\n");
  };
  for (const auto& [name, inside, outside] : {std::tuple{"q1_rad", "-9999", "131072"},
                                              {"x_mm", "9.9e9", "1e10"},  // UTM coordinates are inside
                                              {"y_mm", "5400000000", "-1e12"},
                                              {"temperature_c", "-20", "-273.15"},
                                              {"temperature_c", "80.5", "293.15"},
                                              {"segment", "1714561234250", "1e16"}}) {
    EXPECT_EQ(cell(name, inside), "") << name << ' ' << inside;
    const std::string said = cell(name, outside);
    EXPECT_EQ(said.find(message("f.csv, line 2, column ", name, ": '", outside, "' is ")), 0u) << said;
  }
  EXPECT_NE(cell("temperature_c", "293.15").find("kelvin?"), std::string::npos);
  const auto said = [&](const std::string& text, const auto& read_it) {
    write_file("f.csv", text);
    return vernier_test::complaint([&] { read_it(); });
  };
  const auto distances = [] { (void)read_distances<1>("f.csv"); };
  EXPECT_EQ(said("q1_rad,distance_m\n1,9999\n", distances), "");
  EXPECT_NE(said("q1_rad,distance_m\n1,100000\n", distances).find("beyond any measured distance"), std::string::npos);
  EXPECT_NE(said("q1_m,distance_m\n10000,1\n", distances).find("beyond any travel of a joint"), std::string::npos);
  const auto labels = [] { (void)read_labelled_poses("f.csv", {"pose"}); };
  EXPECT_EQ(said("pose,x_mm,y_mm,z_mm\n999999999,1,2,3\n", labels), "");
  EXPECT_NE(said("pose,x_mm,y_mm,z_mm\n3000000000,1,2,3\n", labels).find("beyond any number of a pose"),
            std::string::npos);
  EXPECT_NE(said("pose,x_mm,y_mm,z_mm,rx_rad,ry_rad,rz_rad\n1,1,2,3,0,0,1001\n", labels).find("rotation vector"),
            std::string::npos);
  const auto contacts = [] { (void)read_contacts("f.csv", 1); };
  EXPECT_NE(said("contact_id,kind,q1_rad,radius_m\na,ball,1,1001\n", contacts).find("beyond any gauge"),
            std::string::npos);
}

TEST_F(CsvForms, SignsAndExponentsOfOtherPrograms) {
  EXPECT_EQ(refused(head + "\n0.5,\xE2\x88\x92"
                           "1.25,1,2,3\n"),  // U+2212
            "f.csv, line 2, column q2_rad: '???1.25' is not a number; a sign or a blank in it is not ASCII");
  EXPECT_EQ(refused(head + "\n0.5,1,1\xC2\xA0"
                           "234,2,3\n"),  // a no-break space
            "f.csv, line 2, column x_mm: '1??234' is not a number; a sign or a blank in it is not ASCII");
  for (const char* cell : {"1.5D3", "-2d-01", "+1.D+2"})
    EXPECT_EQ(refused(head + "\n0.5,1," + cell + ",2,3\n"),
              message("f.csv, line 2, column x_mm: '", cell, "' is not a number; an exponent begins with E"));
}

// Prismatic joints are lengths in what is written, too.
TEST_F(CsvForms, WritesTheTypesOfJoints) {
  using enum JointType;
  const std::array types{revolute, prismatic, prismatic};
  JointRows<3> joints(2, 3), previous(2, 3);
  joints << 0.5, 0.25, -1, 0.1, 0.2, 0.3;
  previous << 1, 2, 3, 4, 5, 6;
  const Dataset<3> data(joints, PointRows::Ones(2, 3));
  const auto header = [](const Dataset<3>& one, std::span<const JointType> of) {
    write_dataset("w.csv", one, of);
    const std::string text = read_file("w.csv");
    return text.substr(0, text.find('\n'));
  };
  EXPECT_EQ(header(data, types), "q1_rad,q2_m,q3_m,x_mm,y_mm,z_mm");
  EXPECT_EQ(read_dataset<3>("w.csv", types).joints(), joints);
  EXPECT_EQ(header(data.approached_from(previous), types),
            "from_q1_rad,from_q2_m,from_q3_m,q1_rad,q2_m,q3_m,x_mm,y_mm,z_mm");
  EXPECT_EQ(read_dataset<3>("w.csv", types).previous(), previous);
  EXPECT_EQ(header(data, {}), "q1_rad,q2_rad,q3_rad,x_mm,y_mm,z_mm");
  EXPECT_EQ(vernier_test::complaint([&] { write_dataset("w.csv", data, std::span(types).first(2)); }),
            "write_dataset: 2 types of joints for 3 joints");
}

TEST_F(CsvForms, ColumnsWithOtherNames) {
  const CsvFormat format{.columns = {{"q1_rad", "A1"}, {"q2_rad", "Joint 2"}, {"x_mm", "y_mm"}, {"y_mm", "x_mm"}}};
  expect_read("A1,Joint 2,y_mm,x_mm,z_mm\n" + row, format);
  EXPECT_TRUE(remarks_.empty());
  // a file that calls one of them as we do, or lacks it, is told
  expect_read("q1_rad,Joint 2,y_mm,x_mm,z_mm\n" + row, format);
  EXPECT_EQ(remarks_, std::vector<std::string>{"f.csv: no column 'A1' for q1_rad"});
  EXPECT_EQ(refused("A1,q1_rad,q2_rad,x_mm,y_mm,z_mm\n1," + row, {.columns = {{"q1_rad", "A1"}}}),
            "f.csv, line 1: column q1_rad is there twice");
  EXPECT_EQ(refused("A1,q1_deg,q2_rad,x_mm,y_mm,z_mm\n1," + row, {.columns = {{"q1_rad", "A1"}}}),
            "f.csv, line 1: columns q1_rad and q1_deg both give q1");
  EXPECT_EQ(refused(head + "\n" + row, {.columns = {{"joint_1", "A1"}}}),
            "CsvFormat: 'A1' cannot stand for joint_1, which is no column of any file");
  EXPECT_EQ(vernier_test::complaint([&] {
              (void)read_dataset<2>("f.csv", {}, {.columns = {{"q1_rad", "A1"}}});
            }),
            "f.csv, line 1: no column 'A1' for q1_rad");
}

TEST_F(CsvForms, TextForOtherColumnsHasDecimalPoints) {
  write_file("f.csv", "target;q1_rad;note\n\"P1,5\";0,5;1,5\n");
  const CsvText text = read_csv_text("f.csv", {.separator = ';', .decimal = ','});
  EXPECT_EQ(text.header, (std::vector<std::string>{"target", "q1_rad", "note"}));
  EXPECT_EQ(text.rows, (std::vector<std::vector<std::string>>{{"P1,5", "0.5", "1,5"}}));
}

}  // namespace
}  // namespace vernier::csv_forms_test
