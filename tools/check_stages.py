#!/usr/bin/python3
"""Checks that each stage includes only what it may, and that no build file downloads anything.

    tools/check_stages.py [ROOT]

The stages and what each may include are read from ROOT/CMakeLists.txt: `set(MENISCUS_STAGES ...)`, left to
right, and `set(<stage>_uses ...)`. A file belongs to a stage by its place: src/<stage>/, tests/<stage>/,
include/meniscus/<stage>.h or include/meniscus/<stage>/. Found faults are printed one a line; the exit code is
the number of faults, 99 at most.
"""

import pathlib
import re
import sys

SOURCE_SUFFIXES = {".h", ".hpp", ".cpp", ".cc", ".inl"}
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*["<]([^">]+)[">]', re.MULTILINE)
DOWNLOAD = re.compile(
    r"FetchContent|ExternalProject|file\s*\(\s*DOWNLOAD|\bcurl\b|\bwget\b|\bgit\s+clone\b|\bpip3?\s+install\b|\bnpm\b",
    re.IGNORECASE,
)
NOT_OURS = {".git", "build", "demo"}


def without_comments(text, mark):
    return re.sub(mark + r".*", "", text)


def read_table(root):
    """The stages in order, and for each the set that it may include; and the faults of the table itself."""
    text = without_comments((root / "CMakeLists.txt").read_text(encoding="utf-8"), "#")
    lists = {name: values.split() for name, values in re.findall(r"\bset\(\s*(\w+)([^)]*)\)", text)}
    stages = lists.get("MENISCUS_STAGES", [])
    faults = [] if stages else ["CMakeLists.txt: no set(MENISCUS_STAGES ...)"]
    uses = {}
    for place, stage in enumerate(stages):
        if f"{stage}_uses" not in lists:
            faults.append(f"CMakeLists.txt: no set({stage}_uses ...)")
        uses[stage] = set(lists.get(f"{stage}_uses", []))
        for other in sorted(uses[stage] - set(stages[:place])):
            faults.append(f"CMakeLists.txt: {stage} uses {other}, which is not a stage to its left")
    return stages, uses, faults


def stage_of(path, stages):
    """The stage that a path (relative to the root) belongs to, or None."""
    parts = path.parts
    if parts[0] in ("src", "tests") and len(parts) > 2 and parts[1] in stages:
        return parts[1]
    if parts[:2] == ("include", "meniscus") and len(parts) > 2:
        name = path.stem if len(parts) == 3 else parts[2]
        return name if name in stages else None
    return None


def resolve(root, file, name):
    """The project's file that an include line means, relative to the root, or None: somebody else's header."""
    for folder in (file.parent, pathlib.Path("src"), pathlib.Path("include"), pathlib.Path("tests")):
        candidate = (root / folder / name).resolve()
        if candidate.is_file() and candidate.is_relative_to(root):
            return candidate.relative_to(root)
    return None


def read_includes(root):
    """For every source file: [(line, name as written, resolved path or None)]."""
    graph = {}
    for folder in ("src", "include", "apps", "tests", "bench"):
        for path in sorted((root / folder).rglob("*")):
            if path.suffix not in SOURCE_SUFFIXES or not path.is_file():
                continue
            file = path.relative_to(root)
            text = path.read_text(encoding="utf-8")
            graph[file] = [
                (text.count("\n", 0, match.start()) + 1, match.group(1), resolve(root, file, match.group(1)))
                for match in INCLUDE.finditer(text)
            ]
    return graph


def include_faults(graph, stages, uses):
    for file, includes in graph.items():
        stage = stage_of(file, stages)
        if file.parts[0] in ("src", "include") and stage is None and file.name != "meniscus.h":
            yield f"{file}: belongs to no stage of CMakeLists.txt"
            continue
        for line, name, target in includes:
            if target is None:
                if name.startswith("meniscus/"):
                    yield f"{file}:{line}: {name} does not exist"
                continue
            other = stage_of(target, stages)
            if stage and other and other != stage and other not in uses[stage]:
                yield f"{file}:{line}: {stage} may not include {other} ({name})"
            if file.parts[0] == "include" and target.parts[0] != "include":
                yield f"{file}:{line}: a public header includes a private one ({name})"


def cycle_faults(graph):
    """Cycles of the include graph, each once, by a depth-first walk."""
    done, path = set(), []

    def walk(file):
        if file in path:
            yield "include cycle: " + " -> ".join(map(str, path[path.index(file) :] + [file]))
            return
        if file in done:
            return
        path.append(file)
        for _, _, target in graph.get(file, []):
            if target is not None:
                yield from walk(target)
        path.pop()
        done.add(file)

    for file in graph:
        yield from walk(file)


def download_faults(root):
    for path in sorted(root.rglob("*")):
        file = path.relative_to(root)
        if NOT_OURS & set(file.parts[:1]) or not path.is_file():
            continue
        is_build_file = (
            path.name in ("CMakeLists.txt", "CMakePresets.json", "Makefile")
            or path.suffix in (".cmake", ".sh")
            or path.name.endswith(".cmake.in")
            or file == pathlib.Path(".ci/run")
        )
        if not is_build_file:
            continue
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            found = DOWNLOAD.search(without_comments(line, "#"))
            if found:
                yield f"{file}:{number}: a build file downloads ({found.group(0)})"


def check(root):
    root = pathlib.Path(root).resolve()
    stages, uses, faults = read_table(root)
    graph = read_includes(root)
    return [*faults, *include_faults(graph, stages, uses), *cycle_faults(graph), *download_faults(root)]


def main():
    root = sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent
    faults = check(root)
    for fault in faults:
        print(fault)
    return min(len(faults), 99)


if __name__ == "__main__":
    sys.exit(main())
