"""check_floors.py on small generated trees: one offence at a time, and sound trees that pass."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

TOOL = pathlib.Path(__file__).parents[2] / "tools" / "check_floors.py"


def run_on(files):
    """Exit code and output of the tool on a tree {path: text}."""
    with tempfile.TemporaryDirectory() as folder:
        for name, text in {"src/normalshop/core/a.h": "", **files}.items():
            path = pathlib.Path(folder) / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        done = subprocess.run(
            [sys.executable, TOOL, folder], capture_output=True, text=True, check=False)
        return done.returncode, done.stdout


class CheckFloors(unittest.TestCase):
    def rejected(self, path, include, words):
        code, output = run_on({path: f"// first\n#include {include}\n"})
        self.assertEqual(code, 1, output)
        self.assertIn(f"{pathlib.Path(path).name}:2:", output)
        self.assertIn(words, output)

    def accepted(self, path, include):
        code, output = run_on({path: f"#include {include}\n"})
        self.assertEqual((code, output), (0, ""))

    def test_include_upwards(self):
        self.rejected("src/normalshop/core/x.cpp", '"normalshop/rgbn/y.h"', "may not include floor")
        self.rejected("src/normalshop/document/x.h", '"normalshop/io/y.h"', "may not include floor")

    def test_include_sideways(self):
        self.rejected("src/normalshop/rgbn/x.h", '"normalshop/surface/y.h"', "may not include floor")
        self.rejected("src/normalshop/chart/x.h", '"normalshop/capture/y.h"', "may not include")

    def test_include_downwards_is_fine(self):
        self.accepted("src/normalshop/chart/x.h", '"normalshop/surface/y.h"')
        self.accepted("src/normalshop/io/x.cpp", '"normalshop/document/y.h"')

    def test_unknown_floor(self):
        self.rejected("src/normalshop/core/x.h", '"normalshop/misc/y.h"', "is no floor")
        code, output = run_on({"src/normalshop/misc/x.h": ""})
        self.assertEqual(code, 1)
        self.assertIn("belongs to no floor", output)

    def test_detail_is_private(self):
        self.accepted("src/normalshop/io/detail/x.h", "<nlohmann/json.hpp>")
        self.accepted("src/normalshop/io/x.cpp", '"normalshop/io/detail/y.h"')
        self.rejected("src/normalshop/io/detail/x.h", "<tbb/task.h>", "does not own")
        self.rejected("src/normalshop/chart/x.cpp", '"normalshop/core/detail/y.h"', "alone")

    def test_third_party_belongs_to_its_owner(self):
        self.rejected("src/normalshop/chart/x.cpp", "<tbb/parallel_for.h>", "does not own")
        self.rejected("src/normalshop/document/x.cpp", "<OpenImageIO/imageio.h>", "does not own")
        self.rejected("src/normalshop/io/x.h", "<OpenImageIO/imageio.h>", "inside .cpp")
        self.accepted("src/normalshop/io/x.cpp", "<OpenImageIO/imageio.h>")

    def test_highway_in_kernels_and_eigen_everywhere(self):
        self.accepted("src/normalshop/chart/x.cpp", "<hwy/highway.h>")
        self.rejected("src/normalshop/chart/x.h", "<hwy/highway.h>", "inside .cpp")
        self.accepted("src/normalshop/chart/x.h", "<Eigen/Core>")

    def test_apps_do_not_know_each_other(self):
        tree = {"apps/cli/a.h": "", "apps/studio/b.cpp": '#include "cli/a.h"\n'}
        code, output = run_on(tree)
        self.assertEqual(code, 1)
        self.assertIn("app 'studio' may not include app 'cli'", output)
        self.accepted("apps/cli/main.cpp", "<CLI/CLI.hpp>")

    def test_long_files_are_warnings(self):
        code, output = run_on({"src/normalshop/core/long.h": "//\n" * 151})
        self.assertEqual(code, 0)
        self.assertIn("warning:", output)

    def test_no_house(self):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([sys.executable, TOOL, folder], capture_output=True, check=False)
        self.assertEqual(done.returncode, 1)


if __name__ == "__main__":
    unittest.main()
