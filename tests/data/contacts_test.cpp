// SPDX-License-Identifier: BSD-3-Clause
// Contacts read from files, and what is refused.

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <string>

#include "complaint.hpp"
#include "temporary_folder.hpp"
#include "vernier/data/csv.hpp"

namespace contacts_test {
namespace {

using namespace vernier;
using vernier_test::complaint;

class ReadContacts : public ::testing::Test {
 protected:
  std::vector<Contact> read(const std::string& text) {
    write_file(folder_ / "c.csv", text);
    return read_contacts(folder_ / "c.csv", 3);
  }
  std::string refused(const std::string& text) {
    try {
      (void)read(text);
    } catch (const DataError& e) {
      const std::string what = e.what();
      return what.substr(what.find("c.csv"));
    }
    return {};
  }
  vernier_test::TemporaryFolder folder_{"contacts"};
};

const std::string header = "contact_id,kind,radius_mm,offset_mm,q1_deg,q2_rad,q3_rad\n";
const std::string plane = "plate,plane,,,90,2,3\nplate,plane,,100,1,2,4\nplate,plane,,0,1,2,5\nplate,plane,,,1,2,6\n";

TEST_F(ReadContacts, ObjectsInTheOrderOfTheirFirstTouches) {
  const std::vector<Contact> out = read(header + "A,socket,,,1,2,3\n" + plane +
                                        "b 1,ball,12.5,,0,0,0\nA,socket,,250,1,2,3\nb 1,ball,12.5,0,0,0,1\n"
                                        "b 1,ball,12.5,,0,0,0\nb 1,ball,12.5,,0,0,0\nA,socket,,0,7,8,9\n");
  ASSERT_EQ(out.size(), 3u);
  EXPECT_EQ(out[0].name(), "A");
  EXPECT_EQ(out[0].kind(), ContactKind::socket);
  EXPECT_EQ(out[0].known(), Vector3(0, 0.25, 0));
  EXPECT_TRUE(out[0].has_length());
  EXPECT_EQ(out[0].joints()(2, 1), 8);
  EXPECT_EQ(out[1].name(), "plate");
  EXPECT_EQ(out[1].kind(), ContactKind::plane);
  EXPECT_EQ(out[1].known(), Eigen::Vector4d(0, 0.1, 0, 0));
  EXPECT_DOUBLE_EQ(out[1].joints()(0, 0), std::numbers::pi / 2);
  EXPECT_EQ(out[2].kind(), ContactKind::ball);
  EXPECT_EQ(out[2].known(), Eigen::Vector4d::Constant(0.0125));
}

TEST_F(ReadContacts, NamesDifferInAnyByte) {
  const std::string same(40, 'n');  // of a name, messages show as much
  const auto out = read(header + "\xC3\xA4,socket,,,0,0,0\n\xC3\xB6,socket,,,0,0,1\n\xC3\xA4,socket,,,0,0,0\n" +
                        "\xC3\xB6,socket,,,0,0,1\n" + same + "1,socket,,,0,0,0\n" + same + "2,socket,,,0,0,1\n" + same +
                        "1,socket,,,0,0,0\n" + same + "2,socket,,,0,0,1\n");
  ASSERT_EQ(out.size(), 4u);
  for (const Contact& contact : out) EXPECT_EQ(contact.size(), 2);
  EXPECT_EQ(out[2].name(), same + "...");
}

TEST_F(ReadContacts, ManyObjectsAreToldApart) {
  std::string rows = header;
  for (int touch = 0; touch < 2; ++touch)
    for (int i = 0; i < 10'000; ++i) rows += message(i, ",socket,,,0,0,", touch, "\n");
  const auto out = read(rows);
  ASSERT_EQ(out.size(), 10'000u);
  EXPECT_EQ(out[9'999].name(), "9999");
  EXPECT_EQ(out[9'999].size(), 2);
}

TEST_F(ReadContacts, ColumnsOfLengthsAreOptional) {
  const auto out = read("kind,contact_id,q1_rad,q2_rad,q3_rad\nsocket,1,0,0,0\nsocket,1,0,0,1\n");
  ASSERT_EQ(out.size(), 1u);
  EXPECT_FALSE(out[0].has_length());
}

TEST_F(ReadContacts, EachKindOfDamageInOneLine) {
  EXPECT_EQ(refused("kind,q1_rad,q2_rad,q3_rad\nplane,1,2,3\n"),
            "c.csv, line 1: no column contact_id in the header (kind, q1_rad, q2_rad, q3_rad)");
  EXPECT_EQ(refused("contact_id,q1_rad,q2_rad,q3_rad\nplane,1,2,3\n"),
            "c.csv, line 1: no column kind in the header (contact_id, q1_rad, q2_rad, q3_rad)");
  EXPECT_EQ(refused(header + "p,cube,,,1,2,3\n"), "c.csv, line 2, column kind: 'cube', must be plane, ball or socket");
  EXPECT_EQ(refused(header + ",plane,,,1,2,3\n"), "c.csv, line 2, column contact_id: no name of what is touched");
  EXPECT_EQ(refused(header + plane + "plate,socket,,,1,2,3\n"),
            "c.csv, line 6, column kind: contact plate is a socket here, and a plane above");
  EXPECT_EQ(refused(header + "p,plane,,,nan,2,3\n"), "c.csv, line 2, column q1_deg: 'nan' is not finite");
  EXPECT_EQ(refused(header + "p,plane,,nan,1,2,3\n"), "c.csv, line 2, column offset_mm: 'nan' is not finite");
  EXPECT_EQ(refused(header + "p,plane,,x,1,2,3\n"), "c.csv, line 2, column offset_mm: 'x' is not a number");
  EXPECT_EQ(refused(header + "p,plane,5,,1,2,3\n"), "c.csv, line 2, column radius_mm: a plane has no radius");
  EXPECT_EQ(refused(header + "b,ball,,,1,2,3\n"), "c.csv: contact b: a ball needs its radius, in a column radius_mm");
  EXPECT_EQ(refused("contact_id,kind,q1_rad,q2_rad,q3_rad\nb,ball,1,2,3\n"),
            "c.csv: contact b: a ball needs its radius, in a column radius_mm");
  EXPECT_EQ(refused(header + "b,ball,-1,,1,2,3\n"), "c.csv, line 2, column radius_mm: a radius must be positive");
  EXPECT_EQ(refused(header + "b,ball,10,5,1,2,3\n"),
            "c.csv, line 2, column offset_mm: a ball has a radius, but no offset");
  EXPECT_EQ(refused(header + "p,plane,,,1,2,3\np,plane,,,1,2,3\np,plane,,,1,2,3\n"),
            "c.csv: contact p: 3 touches of a plane, at least 4 are needed: fewer say where it is, and nothing about "
            "the arm");
  EXPECT_EQ(refused(header + "s,socket,,,1,2,3\ns,socket,,100,1,2,3\n"),
            "c.csv: contact s: 2 touches of a socket, at least 3 are needed: fewer say where it is, and nothing about "
            "the arm");
  EXPECT_EQ(refused("contact_id,kind,q1_rad,q2_rad\np,plane,1,2\n"),
            "c.csv, line 1: no column q3_rad or q3_deg in the header (contact_id, kind, q1_rad, q2_rad)");
}

MatrixX touches(Index n) { return MatrixX::Constant(n, 3, 0.25); }

TEST(Contact, ABarOfSocketsNeedsThree) {
  const auto bar = [](Index n) {
    return complaint([&] { Contact("bar", ContactKind::socket, touches(n), VectorX::LinSpaced(n, 0, 0.4)); });
  };
  EXPECT_EQ(bar(3), "");
  EXPECT_NE(bar(2).find("2 touches of a socket, at least 3 are needed"), std::string::npos) << bar(2);
}

TEST(Contact, LengthsAndJointsAreChecked) {
  EXPECT_EQ(complaint([] { Contact("b", ContactKind::ball, touches(4)); }), "contact b: a ball without its radius");
  EXPECT_EQ(complaint([] { Contact("b", ContactKind::ball, touches(4), VectorX::Ones(3)); }),
            "contact b: 4 touches, but 3 known lengths");
  for (Index i = 0; i < 4; ++i) {
    VectorX radii = VectorX::Constant(4, 0.01);
    radii(i) = 0;
    EXPECT_EQ(complaint([&] { Contact("b", ContactKind::ball, touches(4), radii); }),
              message("contact b: touch ", i, " has a radius of 0 m, must be positive"));
    EXPECT_EQ(complaint([&] { Contact("p", ContactKind::plane, touches(4), radii); }), "");  // a height of 0
    radii(i) = std::numeric_limits<double>::infinity();
    MatrixX joints = touches(4);
    joints(i, 2) = std::numeric_limits<double>::quiet_NaN();
    for (const auto& refused : {complaint([&] { Contact("p", ContactKind::plane, touches(4), radii); }),
                                complaint([&] { Contact("p", ContactKind::plane, joints); })})
      EXPECT_EQ(refused, message("contact p: touch ", i, " has a value that is not finite"));
  }
  EXPECT_EQ(Contact("p", ContactKind::plane, touches(4)).known(), VectorX::Zero(4));
}

}  // namespace
}  // namespace contacts_test
