// SPDX-License-Identifier: GPL-3.0-or-later
// A file that is edited during a run fails its item, and artefacts always match the file contents named by
// their key.

#include "pipeline/engine/file.h"
#include "pipeline/rules/given_maps.h"
#include "pipeline/rules/models.h"
#include "tests/pipeline/runner_fixture.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

class EditedDuringARun : public RunnerTest {
 protected:
  std::string results_of_run() {
    run(kYaml);
    return results();
  }

  // Plans a run, replaces the file's text, runs, and restores the file. The item fails.
  void run_with(const std::filesystem::path& file, const std::string& text) {
    const std::string before = read_file(data_ / file);
    ToyRun run(data_.path(), store_, kYaml);
    write_file(data_ / file, text);
    run.run();
    write_file(data_ / file, before);
    expect_changed(run, file.filename());
  }
  static void expect_changed(const ToyRun& run, const std::string& file) {
    const std::vector<Failure> failures = run.resolver->failures();
    ASSERT_EQ(failures.size(), 1U);
    EXPECT_FALSE(failures[0].defect);
    EXPECT_THAT(failures[0].cause, HasSubstr(file + ": changed since this run was planned; run it again"));
  }

  static constexpr const char* kYaml = "dataset: {scans: false}\nmodels: {PS: , RS: }\n";
};

TEST_F(EditedDuringARun, AMeshPoisonsNothing) {
  const std::string results_before = results_of_run();
  store_.clear();
  run_with("Meshes/2.off", off_text(shapes::bumpy_sphere(2, 0.1)));
  EXPECT_THAT(store_.take_saved(), Not(Contains("mesh@2")));
  EXPECT_EQ(results_of_run(), results_before);
}

TEST_F(EditedDuringARun, GroundTruthPoisonsNothing) {
  const std::string results_before = results_of_run();
  for (const char* file : {"Distributions/1.val", "RawData/1_2.pid"}) {
    store_.remove("ground_truth", "1");  // not the mesh, so that the plan reads these files
    const std::string text = read_file(data_ / file);
    run_with(file,
             file == std::string("RawData/1_2.pid") ? "7\n" : "0.125\n" + text.substr(text.find('\n') + 1));
    EXPECT_EQ(results_of_run(), results_before) << file;
  }
}

TEST_F(EditedDuringARun, AGivenMapPoisonsNothing) {
  const TemporaryFolder maps;
  const auto values = [](double first) {
    std::string text = fmt::format("{}\n", first);
    for (std::size_t i = 1; i < shapes::bumpy_sphere(2).vertices.size(); ++i)
      text += fmt::format("{}\n", i % 17);
    return text;
  };
  for (const char* name : {"1.val", "2.val"}) maps.write(name, values(0));
  const auto run_over = [&](const auto& before_it_runs) {
    Config config = toy_config(kYaml);
    config.models.push_back(given_model("OWN", find_given_maps(maps.path(), false)));
    ToyRun run(data_.path(), store_, config);
    before_it_runs();
    run.run();
    return to_csv(results_table(run.results()));
  };
  const std::string results_before = run_over([] {});
  store_.clear();
  EXPECT_NE(run_over([&] { maps.write("1.val", values(40)); }), results_before) << "not read before the mesh";
  maps.write("1.val", values(0));
  EXPECT_EQ(run_over([] {}), results_before);
}

// A damaged artefact must be restored with the same content, which another file cannot give.
TEST_F(EditedDuringARun, ADamagedArtefactIsNotMadeAgainFromAnotherFile) {
  run(kYaml);
  store_.damage("mesh", "1");
  store_.remove("normals", "1");
  ToyRun run(data_.path(), store_, kYaml);
  write_file(data_ / "Meshes/1.off", off_text(shapes::bumpy_sphere(2, 0.3)));
  run.run();
  expect_changed(run, "1.off");
  EXPECT_EQ(run.project.rule(run.resolver->failures()[0].job).stage, "normals");
}

TEST(Source, TheDigestIsOfTheBytesThatAreHandedOut) {
  const TemporaryFolder folder;
  const auto path = folder.write("1.val", "1\n2\n");
  File file{.name = "saliency file", .place = path};
  EXPECT_FALSE(file.is_known());
  EXPECT_EQ(file.digest(), file_digest("1\n2\n"));
  EXPECT_EQ(file.read().text(), "1\n2\n");
  folder.write("1.val", "3\n");
  EXPECT_THAT([&] { file.read(); }, Refuses("1.val: changed"));
  EXPECT_EQ(file.digest(), file_digest("1\n2\n"));
  std::filesystem::remove(path);
  EXPECT_THAT([&] { file.read(); }, Refuses("No such file"));
  File gone{.name = "saliency file", .place = path};
  EXPECT_FALSE(gone.digest());
  folder.write("1.val", "3\n");
  EXPECT_THAT([&] { gone.read(); }, Refuses("1.val: changed"));
}

// --- defects ----------------------------------------------------------------------------------------------

// Replaces one stage of every mesh by a function that throws.
class Thrown : public EditedDuringARun {
 protected:
  std::vector<Failure> failures_with(const std::function<ValuePtr(const JobInputs&)>& body,
                                     const std::string& stage = "fpfh") {
    ToyRun run(data_.path(), store_, kYaml);
    run.rule(stage).compute = body;
    run.run();
    for (const Failure& failure : run.resolver->failures())
      EXPECT_EQ(run.project.rule(failure.job).stage, stage);
    return run.resolver->failures();
  }
};

TEST_F(Thrown, BadDataIsTheItemsAndEverythingElseADefect) {
  struct Case {
    std::function<ValuePtr(const JobInputs&)> body;
    bool defect;
    const char* said;
  };
  const Case cases[] = {
      {[](const JobInputs&) -> ValuePtr { throw InputError("1.off:3: bad"); }, false, "1.off:3: bad"},
      {[](const JobInputs&) -> ValuePtr { throw std::logic_error("broken"); }, true,
       "a defect of salbench: broken"},
      {[](const JobInputs&) -> ValuePtr { throw std::bad_alloc(); }, true,
       "out of memory; use fewer --threads"},
      {[](const JobInputs&) -> ValuePtr { throw 5; }, true, "an unknown exception"}};
  for (const Case& one : cases) {
    const std::vector<Failure> failures = failures_with(one.body);
    ASSERT_EQ(failures.size(), 2U) << one.said;
    EXPECT_EQ(failures[0].defect, one.defect) << one.said;
    EXPECT_THAT(failures[0].cause, HasSubstr(one.said));
  }
}

TEST_F(Thrown, AFileThatMemoryDoesNotHoldIsTheItems) {
  const auto no_memory = [](const JobInputs&) -> ValuePtr { throw std::bad_alloc(); };
  const std::string advice =
      ": no memory for what it holds; use fewer --threads, or leave the item out with --items";
  std::vector<Failure> failures = failures_with(no_memory, "mesh");
  ASSERT_EQ(failures.size(), 2U);
  EXPECT_FALSE(failures[0].defect);
  EXPECT_EQ(failures[0].cause, (data_ / "Meshes/1.off").string() + advice);
  failures = failures_with(no_memory, "ground_truth");
  ASSERT_EQ(failures.size(), 2U);
  EXPECT_FALSE(failures[0].defect);
  EXPECT_EQ(failures[0].cause, (data_ / "Distributions/1.val").string() + " and 4 more" + advice);
}

}  // namespace
}  // namespace salbench
