# SPDX-License-Identifier: GPL-3.0-or-later
"""Reference histograms: the mean over all items, over some, or a given table."""


from support import SCANS, VIEWS, Workspace

OVER_ALL = "mean over all items of the data set or split"


class Reference(Workspace):
    def density(self, dataset="meshes"):
        return [row["GS"] for row in self.rows(f"mean_histograms_{dataset}")]

    def test_a_part_is_matched_to_the_mean_over_all(self):
        self.configure(SCANS)
        said = self.salbench("run", "--items", "2").stderr
        self.assertEqual(said.count("jobs of items that are left out come first"), 1)
        self.assertEqual(self.record()["reference"], OVER_ALL)
        self.assertEqual(self.artefacts()["map.PS"], 1 + VIEWS, "of the other mesh its ground truth alone")
        results, part, densities = self.results(), self.rows(item="2"), [self.density(), self.density("scans")]
        self.assertEqual(self.rows(item="1"), [])
        self.salbench("run")
        self.assertEqual((self.rows(item="2"), [self.density(), self.density("scans")]), (part, densities))
        self.assertNotIn("come first", self.salbench("run", "--items", "2").stderr)
        self.assertEqual(self.results(), results)
        self.assertIn("\n0 jobs to do", self.salbench("plan", "--items", "2").stdout)

    def test_that_of_the_items_alone_is_asked_for_by_name(self):
        self.salbench("run")
        of_all, part = self.density(), self.rows(item="2")
        self.salbench("run", "--items", "2", "--reference", "items")
        self.assertEqual(self.record()["reference"], "mean over the items of the run")
        self.assertNotEqual(self.density(), of_all)
        self.assertNotEqual(self.rows(item="2"), part)
        self.salbench("run", "--reference", "items")
        self.assertEqual((self.computed(), self.density()), (0, of_all), "over all items it is what there is without it")

    def test_one_that_is_given_takes_the_place_of_the_data_sets_own(self):
        self.salbench("run")
        own = self.results()
        table = (self.out / "mean_histograms_meshes.csv").rename(self.folder / "reference.csv")
        said = self.salbench("run", "--reference", table).stderr
        self.assertEqual((self.record()["reference"].split()[0], self.results(), "scaled" in said), ("given", own, False))
        flat = self.write("flat.csv", "bin,GS\n" + "".join(f"{bin},0.01\n" for bin in range(100)))
        self.assertRegex(self.salbench("run", "--reference", flat).stderr, "flat.csv.* sums to 1.*scaled")
        self.assertNotEqual(self.results(), own)
        self.salbench("run")
        self.assertEqual((self.computed(), self.results()), (0, own))

    def test_remarks_of_a_table_are_warnings(self):
        """In either of the forms that a table has had."""
        remarks = ["PARTIAL: 1 of 2, so far", "SIMULATED: by chance, not people"]
        lines = ["GS", *["1"] * 100]
        now = [lines[0] + ",remarks", f'{lines[1]},"{" | ".join(remarks)}"', *(f"{line}," for line in lines[2:])]
        for text in (now, [*(f"# {remark}" for remark in remarks), *lines]):
            said = self.salbench("run", "--reference", self.write("reference.csv", "\n".join(text) + "\n")).stderr
            for remark in remarks:
                self.assertEqual(said.count(f"reference.csv: {remark}"), 1, said)

    def test_an_export_and_gc_of_a_part_know_the_whole(self):
        self.salbench("run")
        self.salbench("export", "--items", "2", "--to", self.folder / "2.h5")
        self.assertEqual(self.artefacts()["matched.PS"], 2, "no other ones")
        self.salbench("gc", "--items", "2")
        self.assertEqual((self.artefacts()["ground_truth"], self.artefacts()["matched.PS"]), (2, 1), "the mean is made of both")

    def test_another_item_that_fails_is_a_warning(self):
        (self.data / "Meshes/1.off").write_text("OFF\n1 0 0\n0 0 0\n")
        self.assertRegex(self.salbench("run", "--items", "2").stderr, "(?m)^warning: 1: mesh: ")
        self.fails()
        self.assertEqual(len(self.rows(item="2")), 2)
