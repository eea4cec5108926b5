#!/usr/bin/python3
"""check_references.py finds keys that are not listed and keys listed twice, and nothing else."""

import pathlib
import tempfile
import unittest

import check_references


class CheckReferences(unittest.TestCase):
    def faults_of(self, listed, code):
        with tempfile.TemporaryDirectory() as folder:
            for name, text in {"docs/references.md": listed, "src/base/a.cpp": code}.items():
                path = pathlib.Path(folder, name)
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text, encoding="utf-8")
            return check_references.check(folder)

    def test_listed_keys_are_no_fault(self):
        listed = "- **Doe1999**: J. Doe.\n- **vanDoe2003**: J. van Doe.\n- **DoeRoe2013b**: both.\n"
        self.assertEqual(self.faults_of(listed, "// [Doe1999] eq. 3, [vanDoe2003], [DoeRoe2013b]\n"), [])

    def test_unknown_key_is_found_once_with_its_place(self):
        faults = self.faults_of("- **Doe1999**: J. Doe.\n", "\n// [Doe1998]\n// [Doe1998]\n")
        self.assertEqual(faults, ["src/base/a.cpp:2: [Doe1998] is not in docs/references.md"])

    def test_key_listed_twice_is_found(self):
        self.assertEqual(len(self.faults_of("- **Doe1999**: a\n- **Doe1999**: b\n", "")), 1)

    def test_indices_are_no_citations(self):
        self.assertEqual(self.faults_of("", "x[i] = y[2003] + row[kMax] + a[index2020];\n"), [])


if __name__ == "__main__":
    unittest.main()
