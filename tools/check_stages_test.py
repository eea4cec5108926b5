#!/usr/bin/python3
"""Every fault that check_stages.py is there for is found in a small made-up tree, and nothing in a sound one."""

import pathlib
import tempfile
import unittest

import check_stages

TABLE = """
set(MENISCUS_STAGES base io render)  # left to right
set(base_uses)
set(io_uses base)
set(render_uses base io)
"""
SOUND = {
    "CMakeLists.txt": TABLE,
    "include/meniscus/base.h": "#include <vector>\n",
    "include/meniscus/io.h": '#include "meniscus/base.h"\n',
    "src/base/error.cpp": '#include "meniscus/base.h"\n',
    "src/io/bytes.h": '#include "meniscus/base.h"\n',
    "src/io/vtk.cpp": '#include "io/bytes.h"\n#include "meniscus/io.h"\n',
    "src/render/film.cpp": '#include "io/bytes.h"\n#include "meniscus/io.h"\n',
    "tests/io/vtk.cpp": '#include "io/bytes.h"\n',
    "tools/build.sh": "ninja  # neither curl nor wget\n",
}


class CheckStages(unittest.TestCase):
    def faults_with(self, changed):
        with tempfile.TemporaryDirectory() as folder:
            for name, text in {**SOUND, **changed}.items():
                path = pathlib.Path(folder, name)
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text, encoding="utf-8")
            return check_stages.check(folder)

    def assert_one_fault(self, changed, *parts):
        faults = self.faults_with(changed)
        self.assertEqual(len(faults), 1, faults)
        for part in parts:
            self.assertIn(part, faults[0])

    def test_sound_tree_has_no_fault(self):
        self.assertEqual(self.faults_with({}), [])

    def test_stage_that_includes_to_its_right_is_found_with_its_line(self):
        self.assert_one_fault({"src/base/error.cpp": '\n#include "io/bytes.h"\n'}, "src/base/error.cpp:2", "may not")

    def test_public_header_counts_as_its_stage(self):
        self.assert_one_fault({"src/base/error.cpp": '#include "meniscus/io.h"\n'}, "base may not include io")

    def test_angle_brackets_and_odd_spaces_do_not_hide_an_include(self):
        self.assert_one_fault({"src/base/error.cpp": " #  include <meniscus/io.h>\n"}, "base may not include io")

    def test_folder_of_public_headers_counts_as_its_stage(self):
        self.assert_one_fault(
            {"include/meniscus/io/vtk.h": "", "src/base/error.cpp": '#include "meniscus/io/vtk.h"\n'},
            "base may not include io",
        )

    def test_tests_of_a_stage_are_held_to_the_same_table(self):
        self.assert_one_fault({"tests/base/error.cpp": '#include "io/bytes.h"\n'}, "tests/base/error.cpp:1")

    def test_public_header_must_not_include_a_private_one(self):
        self.assert_one_fault({"include/meniscus/io.h": '#include "io/bytes.h"\n'}, "public header")

    def test_missing_header_of_ours_is_found(self):
        self.assert_one_fault({"src/io/vtk.cpp": '#include "meniscus/oi.h"\n'}, "does not exist")

    def test_unknown_folder_is_found(self):
        self.assert_one_fault({"src/helpers/text.cpp": ""}, "src/helpers/text.cpp", "no stage")

    def test_cycle_within_a_stage_is_found_once(self):
        self.assert_one_fault(
            {"src/io/a.h": '#include "io/b.h"\n', "src/io/b.h": '#include "a.h"\n'}, "cycle", "src/io/a.h", "src/io/b.h"
        )

    def test_table_that_points_right_is_found(self):
        self.assert_one_fault({"CMakeLists.txt": TABLE.replace("set(base_uses)", "set(base_uses io)")}, "base uses io")

    def test_stage_without_a_row_is_found(self):
        self.assert_one_fault({"CMakeLists.txt": TABLE.replace("set(base_uses)", "")}, "no set(base_uses")

    def test_downloads_are_found(self):
        for text in ("include(FetchContent)", "file(DOWNLOAD x y)", "ExternalProject_Add(x)"):
            self.assert_one_fault({"cmake/more.cmake": text + "\n"}, "cmake/more.cmake:1", "downloads")
        for name in ("tools/build.sh", "Makefile", ".ci/run"):
            self.assert_one_fault({name: "\tcurl -O somewhere\n"}, name + ":1", "downloads")


if __name__ == "__main__":
    unittest.main()
