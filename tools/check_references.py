#!/usr/bin/python3
"""Checks that every citation key in the code and in docs/, like [Author2003] in brackets, stands in docs/references.md.

    tools/check_references.py [ROOT]

Prints one fault a line: an unknown key with the first place that cites it, or a key that is listed twice. The exit
code is the number of faults, 99 at most.
"""

import collections
import pathlib
import re
import sys

CITATION = re.compile(r"\[([A-Za-z]*[A-Z][a-z]+[A-Za-z]*(?:19|20)[0-9]{2}[a-z]?)\]")
ENTRY = re.compile(r"^- \*\*(\w+)\*\*", re.MULTILINE)


def check(root):
    root = pathlib.Path(root).resolve()
    listed = collections.Counter(ENTRY.findall((root / "docs/references.md").read_text(encoding="utf-8")))
    faults = [f"docs/references.md: {key} is listed {times} times" for key, times in listed.items() if times > 1]
    unknown = {}
    for folder in ("src", "include", "apps", "tests", "bench", "docs"):
        for path in sorted((root / folder).rglob("*")):
            if path.suffix not in (".h", ".cpp", ".md"):
                continue
            for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
                for key in CITATION.findall(line):
                    if key not in listed:
                        unknown.setdefault(key, f"{path.relative_to(root)}:{number}")
    return faults + [f"{place}: [{key}] is not in docs/references.md" for key, place in unknown.items()]


def main():
    faults = check(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent)
    for fault in faults:
        print(fault)
    return min(len(faults), 99)


if __name__ == "__main__":
    sys.exit(main())
