// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/shapes/mesh_file.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

constexpr std::string_view kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

std::vector<Triangle> faces_of(const std::string& records) {
  return parse_obj(std::string(kSquare) + records, "x.obj").faces;
}

void expect_refusal(std::string_view text, std::string_view why) {
  EXPECT_THAT([&] { parse_obj(text, "x.obj"); }, Refuses(why)) << text;
}

TEST(Obj, ReadsEveryFormOfACorner) {
  for (const char* face :
       {"f 1 2 3\n", "f 1/4 2/5 3/6\n", "f 1//7 2//7 3//7\n", "f 1/1/1 2/2/2 3/3/3", "f -4 -3 -2",
        "f -4/-1 -3/-1 -2/-1", "f 1 \\\n2 \\\r\n 3\n", "f 1 2\\\n3\n", "\tf  1\t2 3 # face\r\n"})
    EXPECT_THAT(faces_of(face), ElementsAre(Triangle{0, 1, 2})) << face;
}

TEST(Obj, PassesOverOtherRecords) {
  const Mesh mesh = parse_obj(
      "# made by hand \\\nmtllib a.mtl\no thing\ng part\nv 1 2 3 1.0\nv 4 5 6 0.1 0.2 0.3\nvt 0 0\nvn 0 0 1\n"
      "v 7 8 9\nusemtl red\ns off\nl 1 2\np 1\nf 1 2 3\n",
      "x.obj");
  EXPECT_THAT(mesh.vertices, ElementsAre(Vec3(1, 2, 3), Vec3(4, 5, 6), Vec3(7, 8, 9)));
  EXPECT_THAT(mesh.faces, ElementsAre(Triangle{0, 1, 2}));
}

TEST(Obj, NegativeIndicesCountBackFromWhereTheyStand) {
  const Mesh mesh = parse_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 5 5\nf -1 -2 -3\n", "x.obj");
  EXPECT_THAT(mesh.faces, ElementsAre(Triangle{0, 1, 2}, Triangle{3, 2, 1}));
}

TEST(Obj, NamesFileAndLineOfWhatIsWrong) {
  for (const char* record :
       {"f 1 2 0\n", "f 1 2 5\n", "f 1 2 -5\n", "f 1 2 3000000000\n", "f 1 2 99999999999999999999\n",
        "f 1 2\n", "f\n", "f 1 2 3x\n", "f 1 2 3-1\n", "f 1 2 /3\n", "v 1 one 0\n", "v 1 2\n"})
    expect_refusal(std::string(kSquare) + record, "x.obj:5: ");
  expect_refusal("\nf 1 2 5\n" + std::string(kSquare), "x.obj:2:");  // before its vertices
  expect_refusal("", "without a vertex");
  expect_refusal("PK\x03\x04 an archive\n", "x.obj:1:");
}

}  // namespace
}  // namespace salbench
