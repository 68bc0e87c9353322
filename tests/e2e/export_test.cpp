// What `salbench export` writes: it says what the cache says, and other programs read it.
#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "io/hdf5_file.h"
#include "tests/e2e/workspace.h"
#include "tests/support/job_counts.h"
#include "tests/support/toy_data.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kPython = "/usr/bin/python3";  // Debian's, which sees Debian's h5py and VTK

Hdf5Content read_hdf5(const fs::path& path) { return hdf5_content(read_bytes(path).value(), path.string()); }

std::string text_of(const Attributes& attributes, std::string_view name) {
  const AttributeValue* value = find_attribute(attributes, name);
  return value == nullptr ? "" : std::get<std::string>(*value);
}

// Of one export: its arrays and the attributes of its groups by their paths.
struct Export {
  explicit Export(const fs::path& path) : content(read_hdf5(path)) {
    for (const Array& array : content.arrays) arrays[array.name] = &array;
    for (const auto& [object, attributes] : content.attributes_of) attributes_of[object] = attributes;
  }
  Hdf5Content content;
  std::map<std::string, const Array*> arrays;
  std::map<std::string, Attributes> attributes_of;
};

std::string group_of(const Attributes& artefact) {
  const std::string stage = text_of(artefact, "stage"), item = text_of(artefact, "item");
  return text_of(artefact, "kind") == "histogram" ? "means/" + stage + "/" + item : item + "/" + stage;
}

void expect_same_arrays(const Arrays& artefact, const Export& exported, const std::string& group) {
  for (const Array& array : artefact) {
    const auto found = exported.arrays.find(group + "/" + array.name);
    ASSERT_NE(found, exported.arrays.end()) << group << "/" << array.name;
    EXPECT_EQ(found->second->shape, array.shape) << found->first;
    EXPECT_TRUE(found->second->values == array.values) << found->first;
    EXPECT_EQ(found->second->unit, array.unit) << found->first;
    EXPECT_EQ(found->second->description, array.description) << found->first;
  }
}

// The row of /scores that says where it is from with this key.
std::map<std::string, Cell> row_with_key(const Table& table, const std::string& key) {
  const auto column = std::find(table.columns.begin(), table.columns.end(), "key") - table.columns.begin();
  for (const auto& cells : table.rows) {
    if (cells[static_cast<std::size_t>(column)] != Cell(key)) continue;
    std::map<std::string, Cell> row;
    for (std::size_t c = 0; c < cells.size(); ++c) row[table.columns[c]] = cells[c];
    return row;
  }
  return {};
}

bool same_number(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

void expect_same_scores(const Hdf5Content& artefact, const Table& table) {
  auto row = row_with_key(table, text_of(artefact.attributes, "key"));
  ASSERT_FALSE(row.empty());
  const auto& scores = std::get<std::vector<double>>(find_array(artefact.arrays, "scores")->values);
  const char* columns[] = {"auc", "auc_exact", "nss", "cc", "lcc"};
  for (std::size_t c = 0; c < 5; ++c)
    EXPECT_TRUE(same_number(std::get<double>(row[columns[c]]), scores[c])) << columns[c];
  const auto& counts = std::get<std::vector<std::int64_t>>(find_array(artefact.arrays, "counts")->values);
  EXPECT_EQ(std::get<std::int64_t>(row["n_points"]), counts[0]);
  EXPECT_EQ(std::get<std::int64_t>(row["n_picks"]), counts[1]);
  const std::string view = std::get<std::string>(row["view"]), item = std::get<std::string>(row["item"]);
  EXPECT_EQ(view.empty() ? item : item + "_" + view, text_of(artefact.attributes, "item"));
  EXPECT_EQ("scores." + std::get<std::string>(row["model"]), text_of(artefact.attributes, "stage"));
}

TEST(Export, OfFiveItemsSaysWhatTheCacheSaysToTheBit) {
  const Workspace toy;
  write_toy_item(toy.data(), "3", shapes::bumpy_sphere(1));  // equal meshes would share artefacts
  write_toy_item(toy.data(), "4", shapes::bumpy_sphere(1, 0.3));
  write_toy_item(toy.data(), "5", shapes::bumpy_sphere(1, 0.4));
  const Outcome ended = toy.salbench("export", {"--to", (toy / "new folder" / "toy.h5").string()});
  ASSERT_EQ(ended.status, 0) << ended.err;

  const Export exported(toy / "new folder" / "toy.h5");
  ASSERT_EQ(exported.content.tables.size(), 1U);
  std::size_t arrays = 0, scores = 0;
  for (const fs::path& path : toy.artefacts()) {
    const Hdf5Content artefact = read_hdf5(path);
    if (text_of(artefact.attributes, "kind") == "scores") {
      expect_same_scores(artefact, exported.content.tables[0].table);
      ++scores;
      continue;
    }
    const std::string group = group_of(artefact.attributes);
    expect_same_arrays(artefact.arrays, exported, group);
    const Attributes& said = exported.attributes_of.at(group);
    for (const auto& [name, value] : said)
      EXPECT_EQ(*find_attribute(artefact.attributes, name), value) << group << " " << name;
    EXPECT_EQ(said.size(), 8U);
    arrays += artefact.arrays.size();
  }
  EXPECT_EQ(exported.arrays.size(), arrays);
  EXPECT_EQ(exported.content.tables[0].table.rows.size(), scores);
  EXPECT_EQ(scores, JobCounts(kToyConfig, 5).of_kind("scores"));
}

TEST(Export, TellsConfigurationAndVersions) {
  const Workspace toy(kMeshesOnly);
  ASSERT_EQ(toy.salbench("export", {"--to", (toy / "toy.h5").string()}).status, 0);
  const Export exported(toy / "toy.h5");
  const Attributes& root = exported.content.attributes;
  EXPECT_THAT(text_of(root, "program"), testing::StartsWith("salbench "));
  EXPECT_THAT(text_of(root, "configuration"), AllOf(HasSubstr("seed: 2016"), HasSubstr("scans: false")));
  EXPECT_THAT(text_of(root, "stage_versions"), AllOf(HasSubstr("fpfh: "), HasSubstr("map.PS: ")));
  EXPECT_EQ(text_of(root, "protocol"), "published");
  EXPECT_EQ(text_of(exported.attributes_of.at("1"), "dataset"), "meshes");
  toy.configure(text_of(root, "configuration"));  // and can be run again as it stands there
  EXPECT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(toy.computed(), 0);
}

TEST(Export, ChoosesItemsAndStages) {
  const Workspace toy(kMeshesOnly);
  const Outcome ended =
      toy.salbench("export", {"--to", (toy / "toy.h5").string(), "--items", "2", "--stage", "normals, map"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const Export exported(toy / "toy.h5");
  std::vector<std::string> names;
  for (const auto& [name, array] : exported.arrays) names.push_back(name);
  EXPECT_THAT(names, testing::ElementsAre("2/map.PS/saliency", "2/map.RS/saliency", "2/normals/normals"));
  EXPECT_TRUE(exported.content.tables.empty());
}

TEST(Export, TwiceGivesTheSameBytes) {
  const Workspace toy(kMeshesOnly);
  ASSERT_EQ(toy.salbench("export", {"--to", (toy / "a.h5").string()}).status, 0);
  toy.forget_everything();
  ASSERT_EQ(toy.salbench("export", {"--to", (toy / "b.h5").string(), "--threads", "1"}).status, 0);
  EXPECT_EQ(read_bytes(toy / "a.h5"), read_bytes(toy / "b.h5"));
}

TEST(Export, IsReadByTheExampleCopiedAndLinked) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("export", {"--to", (toy / "copy.h5").string()}).status, 0);
  ASSERT_EQ(toy.salbench("export", {"--link", "--to", (toy / "links" / "toy.h5").string()}).status, 0);
  EXPECT_LT(fs::file_size(toy / "links" / "toy.h5"), fs::file_size(toy / "copy.h5") / 2);
  const Outcome copy = run_process({kPython, SALBENCH_READ_EXPORT, (toy / "copy.h5").string()});
  const Outcome linked = run_process({kPython, SALBENCH_READ_EXPORT, (toy / "links" / "toy.h5").string()});
  ASSERT_EQ(copy.status, 0) << copy.err;
  ASSERT_EQ(linked.status, 0) << linked.err;
  EXPECT_EQ(linked.out, copy.out);

  const Export exported(toy / "copy.h5");
  double at_picks = 0;
  for (const std::string item : {"1", "2"}) {
    const auto& map = std::get<std::vector<double>>(exported.arrays.at(item + "/map.PS/saliency")->values);
    auto picks =
        std::get<std::vector<std::int32_t>>(exported.arrays.at(item + "/ground_truth/picks")->values);
    std::sort(picks.begin(), picks.end());
    picks.erase(std::unique(picks.begin(), picks.end()), picks.end());
    double sum = 0;
    for (const std::int32_t point : picks) sum += map[static_cast<std::size_t>(point)];
    at_picks += sum / static_cast<double>(picks.size()) / 2;
  }
  EXPECT_THAT(lines_with(copy.out, "meshes"),
              testing::Contains(testing::ContainsRegex(fmt::format("PS +{:.4f}", at_picks))))
      << copy.out;
}

TEST(Export, ShapesAreReadByVtkAndPandas) {
  const Workspace toy;
  for (const char* format : {"csv", "ply", "vtp"})
    ASSERT_EQ(toy.salbench("export", {"--format", format, "--to", (toy / "shapes").string()}).status, 0);
  ASSERT_EQ(toy.salbench("export", {"--to", (toy / "toy.h5").string()}).status, 0);
  const Outcome read =
      run_process({kPython, SALBENCH_READ_SHAPES, (toy / "toy.h5").string(), (toy / "shapes").string()});
  EXPECT_EQ(read.status, 0) << read.err;
  EXPECT_EQ(read.out, fmt::format("ok: {} items\n", JobCounts().shapes()));
}

TEST(Export, SaysWhatItCannotDo) {
  const Workspace toy;
  const auto complaint = [&](const std::vector<std::string>& further) {
    std::vector<std::string> words = {"--to", (toy / "x").string()};
    words.insert(words.end(), further.begin(), further.end());
    const Outcome ended = toy.salbench("export", words);
    EXPECT_EQ(ended.status, 2);
    EXPECT_FALSE(fs::exists(toy / "x"));
    return ended.err;
  };
  EXPECT_THAT(complaint({"--stage", "maps"}), AllOf(HasSubstr("'maps'"), HasSubstr("map.PS")));
  EXPECT_THAT(complaint({"--format", "stl"}), AllOf(HasSubstr("stl"), HasSubstr("vtp")));
  EXPECT_THAT(complaint({"--format", "ply", "--link"}), HasSubstr("--link"));
  write_toy_item(toy.data(), "1_3", shapes::bumpy_sphere(1));
  EXPECT_THAT(complaint({}), HasSubstr("'1_3'"));
}

}  // namespace
}  // namespace salbench
