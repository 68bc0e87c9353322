// SPDX-License-Identifier: GPL-3.0-or-later
// How the ground truth of a data set is written in its files. The defaults are those of the Schelling study:
// a number per vertex, and 0-based indices. [chen2012]
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "stages/core/options.h"

namespace salbench {

// Element that one value belongs to: a vertex, a face in the order of the mesh file, or a point whose
// coordinates stand beside the value.
enum class ValuePer { vertex, face, point };
template <>
struct EnumNames<ValuePer> {
  static constexpr std::array<std::string_view, 3> names = {"vertex", "face", "point"};
};

inline constexpr std::string_view kEmpty = "\"\"";  // an empty text as options are written
inline constexpr std::string_view kPositivesArePicks = "picks";

struct ValuesFormat {
  ValuePer per = ValuePer::vertex;
  std::string column;                                 // name in the header, or number from 1; empty: the only
  std::vector<std::string> points = {"1", "2", "3"};  // columns of x, y, z; of values per point
  double max_distance = 0.02;
  std::string unseen;
  std::string variable;
  double scale = 1;
  std::string positives{kPositivesArePicks};

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("per", self.per, {"what a value belongs to", "", {}, "vertex"});
    visit("column", self.column,
          {"its name in the header, or its number from 1; none: the only one", "", {}, kEmpty});
    visit("points", self.points, {"columns of x, y and z, of values per point", "", {}, "[1, 2, 3]"});
    visit("max_distance", self.max_distance,
          {"a vertex farther from every point was not seen", "R", above(0), "0.02"});
    visit("unseen", self.unseen,
          {"value in the file of what was not seen, such as -1 or nan", "", {}, kEmpty});
    visit("variable", self.variable, {"name in a MAT file", "", {}, kEmpty});
    visit("scale", self.scale,
          {"what the coordinates beside values are multiplied by to be in the shape's unit", "", above(0),
           "1"});
    visit("positives", self.positives,
          {"points that count as picked: picks, above mean, or top 20% of what was seen",
           "",
           {},
           kPositivesArePicks});
  }
};

void check(const ValuesFormat& format);  // throws OptionError

// Points of a density that count as picked.
struct PositiveRule {
  enum class By { picks, mean, top } by = By::picks;
  double percent = 0;  // of the points seen, at the top
};
PositiveRule positive_rule(const ValuesFormat& format);  // throws OptionError

struct IndicesFormat {
  std::int32_t base = 0;
  std::string variable;
  std::vector<std::string> cell;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("base", self.base, {"number of the first vertex", "", between(0, 1), "0"});
    visit("variable", self.variable, {"name in a MAT file", "", {}, kEmpty});
    visit("cell", self.cell, {"row and column in a cell array of a MAT file, from 1", "", {}, "[]"});
  }
};

void check(const IndicesFormat& format);  // throws OptionError

// Rows at the end of a file that fill it up to a fixed number: all zeros, or copies of a row before them.
enum class Padding { none, zeros, copies, any };
template <>
struct EnumNames<Padding> {
  static constexpr std::array<std::string_view, 4> names = {"none", "zeros", "copies", "any"};
};

// Points at the very coordinates of a point before them.
enum class Duplicates { kept, dropped };
template <>
struct EnumNames<Duplicates> {
  static constexpr std::array<std::string_view, 2> names = {"kept", "dropped"};
};

// A point cloud in columns of a text, with its ground truth beside it. Columns are named as in ValuesFormat.
struct ColumnsFormat {
  std::vector<std::string> position;  // x, y, z; empty: shapes are no such texts
  std::vector<std::string> normal;    // x, y, z; empty: none
  bool normalise_normals = false;
  Padding padding = Padding::none;
  Duplicates duplicates = Duplicates::kept;
  std::string density;
  std::string flag;

  bool given() const { return !position.empty(); }
  bool has_truth() const { return !density.empty() || !flag.empty(); }

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("position", self.position, {"columns of x, y and z", "", {}, "[]"});
    visit("normal", self.normal, {"columns of the normal's x, y and z; none: computed", "", {}, "[]"});
    visit("normalise_normals", self.normalise_normals,
          {"make directions of any length to normals; false: another length than 1 is an error",
           "",
           {},
           "false"});
    visit("padding", self.padding, {"rows at the end that fill up the file", "", {}, "none"});
    visit("duplicates", self.duplicates, {"points at the coordinates of one before them", "", {}, "kept"});
    visit("density", self.density, {"column of the saliency; none: no such column", "", {}, kEmpty});
    visit("flag", self.flag, {"column of 0 and 1, 1 for picks; none: no such column", "", {}, kEmpty});
  }
};

void check(const ColumnsFormat& format);  // throws OptionError

struct TruthFormat {
  ValuesFormat values;
  IndicesFormat indices;
  ColumnsFormat columns = {};
};

}  // namespace salbench
