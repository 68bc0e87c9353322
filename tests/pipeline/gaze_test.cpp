// SPDX-License-Identifier: GPL-3.0-or-later
// Ground truth from gaze recordings, through all stages.
#include "pipeline/rules/gaze.h"

#include "io/file.h"
#include "io/hdf5/one_form_index.h"
#include "stages/geometry/mesh_ops.h"
#include "tests/pipeline/data_sets.h"
#include "tests/support/recordings.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

class Recorded : public DataSets {
 protected:
  Recorded() {
    std::filesystem::create_directories(data_ / "items");
    put("ant", shapes::bumpy_sphere(2));
    put("bee", shapes::bumpy_sphere(2, 0.35));
    write_index();
  }
  void put(const std::string& name, const Mesh& mesh, bool with_recording = true, bool with_truth = false) {
    ShapeInForm form{.mesh = mesh};
    if (with_recording) form.recording = toy_recording(mesh, 3);
    if (with_truth) {
      form.truths.resize(1);
      for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
        form.truths[0].truth.saliency.push_back(static_cast<double>(v));
    }
    form.about = {{"item", name}};
    const Bytes image = one_form_image(form);
    write_file(data_ / file_of_shape(name),
               std::string_view(reinterpret_cast<const char*>(image.data()), image.size()));
    rows_ +=
        fmt::format("{},,,,mesh,{},0,0,own,{}\n", name, with_truth ? "yes" : "no", with_recording ? 3 : 0);
  }
  void write_index() {
    write_file(data_ / kIndexFile,
               "item,view,class,split,kind,truth,participants,viewers,source,recorded\n" + rows_);
  }

  // "stage@item" of everything that a run computed.
  std::vector<std::string> computed(const std::string& gaze = "",
                                    const std::string& dataset = "scans: false") {
    std::vector<std::string> stages =
        Runs::run(fmt::format("dataset: {{layout: hdf5, {}}}\ngaze: {{{}}}\nscan: {{step_degrees: 2}}\n"
                              "models: {{RS: , HS: }}\n",
                              dataset, gaze));
    std::erase_if(stages, [](const std::string& saved) { return !saved.ends_with("@ant"); });
    for (std::string& saved : stages) saved = saved.substr(0, saved.find('@'));
    return stages;
  }

  std::string rows_;
};

TEST_F(Recorded, EveryStageIsStoredAndPeopleAreScoredAgainstEachOther) {
  EXPECT_THAT(computed(),
              IsSupersetOf({"mesh", "fixations", "gaze_hits", "ground_truth", "scores.RS", "scores.HS"}));
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_THAT(truth().viewers, SizeIs(3));
  EXPECT_GE(score_of("HS", "lcc"), -1);
  EXPECT_THAT(computed(), IsEmpty());
}

TEST_F(Recorded, AnotherSpreadComputesTheDensityAndWhatFollowsAlone) {
  computed();
  EXPECT_THAT(computed("degrees: 2"),
              UnorderedElementsAre("ground_truth", "matched.RS", "scores.RS", "scores.HS", "curve.HS"));
  EXPECT_THAT(computed("degrees: 2, snap: 1"), ElementsAre("gaze_hits")) << "every ray hits: cut off there";
  EXPECT_THAT(computed("degrees: 2, velocity: 29"), ElementsAre("fixations"));
  EXPECT_THAT(computed("degrees: 2, visible: divided"), IsSupersetOf({"visible_shares", "ground_truth"}));
  EXPECT_THAT(computed("degrees: 1, visible: divided"), Not(Contains("visible_shares")));
}

TEST(GazeRecipe, HasAVersionOfItsOwnWhereVisibleMassIsDividedBy) {
  GazeOptions options;
  const auto has_version = [&](int version) {
    return HasSubstr(fmt::format("ground_truth: {{version: {}", version));
  };
  options.truth.weight = GazeWeight::mass;
  EXPECT_THAT(gaze_recipe(options), has_version(3));
  options.truth.visible = GazeVisible::divided;
  EXPECT_THAT(gaze_recipe(options), has_version(4));
  options.truth.weight = GazeWeight::people;
  EXPECT_THAT(gaze_recipe(options), has_version(3));
}

TEST_F(Recorded, ScansHaveWhatTheirPointsShow) {
  computed("", "meshes: true");
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_FALSE(std::isnan(score_of("RS", "lcc", true)));
}

TEST_F(Recorded, PicksAndFacesAreThereIfAskedFor) {
  computed("picks: fixations");
  EXPECT_THAT(truth().picks, SizeIs(3));
  EXPECT_FALSE(std::isnan(score_of("RS", "auc")));
  computed("", "scans: false, score_on: faces");
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_THAT(toy_->value<GroundTruth>("face_truth", mesh_unit(0)).saliency,
              SizeIs(shapes::bumpy_sphere(2).faces.size()));
}

TEST_F(Recorded, AnItemWithoutARecordingIsNamedAndTheOthersGoOn) {
  put("cat", shapes::bumpy_sphere(2), false, false);
  write_index();
  computed("", "scans: false, participants: recorded");
  EXPECT_THAT(failures(), ElementsAre(HasSubstr("cat: has no recording of gaze")));
}

TEST_F(Recorded, WhereItemsHaveOtherGroundTruthTheConfigurationDecides) {
  put("cat", shapes::bumpy_sphere(2), true, true);
  write_index();
  computed();
  EXPECT_THAT(failures(), Each(HasSubstr("write dataset: {participants: recorded}")));
  EXPECT_THAT(failures(), SizeIs(2));
  EXPECT_EQ(truth(2).saliency[7], 7);
  computed("", "scans: false, participants: recorded");
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_NE(truth(2).saliency[7], 7);
}

TEST_F(Recorded, SelectingItemsDecidesNothing) {
  put("cat", shapes::bumpy_sphere(2), false, true);
  write_index();
  ToyRun toy(data_.path(), store_, "dataset: {layout: hdf5, scans: false}\nmodels: {RS: }\n", "ant");
  toy.run();
  ASSERT_THAT(toy.resolver->failures(), SizeIs(1));
}

TEST_F(Recorded, ASetWithoutOneSaysSo) {
  rows_.clear();
  put("cat", shapes::bumpy_sphere(2), false, true);
  write_index();
  EXPECT_THAT([&] { computed("", "scans: false, participants: recorded"); },
              Refuses<ConfigError>("no item of the data set has a recording of gaze"));
}

// --- the form ---------------------------------------------------------------------------------------------

std::string text_of(const Bytes& image) {
  return {reinterpret_cast<const char*>(image.data()), image.size()};
}

TEST(RecordingInForm, IsReadAsItWas) {
  ShapeInForm form{.mesh = shapes::tetrahedron()};
  form.recording = {.people = {"Zoë", "B"},
                    .person = {0, 0, 1},
                    .time = {0, 8.25, 1},
                    .valid = {1, 0, 1},
                    .origins = {{0, 0, 9}, {NAN, 0, 0}, {0, 9, 0}},
                    .directions = {{0, 0, -1}, {NAN, NAN, NAN}, {0, -1, 0}}};
  const auto found = shape_in_form(text_of(one_form_image(form)), "a.h5");
  ASSERT_TRUE(found);
  EXPECT_EQ(found->recording.people, form.recording.people);
  EXPECT_EQ(found->recording.person, form.recording.person);
  EXPECT_EQ(found->recording.time, form.recording.time);
  EXPECT_EQ(found->recording.valid, form.recording.valid);
  EXPECT_EQ(found->recording.directions[2], form.recording.directions[2]);
  EXPECT_TRUE(found->recording.points.empty());
}

TEST(RecordingInForm, WhatNoStageCouldWorkOnIsNamedWithItsRow) {
  using R = GazeRecording;
  const struct {
    void (*spoil)(R&);
    const char* named;
  } rows[] = {{[](R& r) { r.person[3] = 7; }, "row 3 (0-based)"},
              {[](R& r) { r.people[1] = "P1"; }, "\"P1\""},
              {[](R& r) { r.people[1] = "a\tb"; }, "a.h5: "},
              {[](R& r) { r.person[0] = 1; }, "row 1 (0-based)"},
              {[](R& r) { r.time[4] = r.time[3]; }, "row 4 (0-based)"},
              {[](R& r) { r.time[4] = NAN; }, "row 4 (0-based)"},
              {[](R& r) { r.valid[2] = 3; }, "row 2 (0-based)"},
              {[](R& r) { r.origins[2].x() = INFINITY; }, "row 2 (0-based)"},
              {[](R& r) { r.directions[2] *= 2; }, "row 2 (0-based)"},
              {[](R& r) { r.time.pop_back(); }, "\"recording/time\""},
              {[](R& r) { r.origins.clear(); }, "'recording/origins'"}};
  for (const auto& row : rows) {
    ShapeInForm form{.mesh = shapes::tetrahedron()};
    form.recording = toy_recording(form.mesh, 2, 1);
    EXPECT_NO_THROW(shape_in_form(text_of(one_form_image(form)), "a.h5"));
    row.spoil(form.recording);
    EXPECT_THAT([&] { shape_in_form(text_of(one_form_image(form)), "a.h5"); }, Refuses(row.named));
  }
}

}  // namespace
}  // namespace salbench
