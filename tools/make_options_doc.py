#!/usr/bin/python3
"""Writes docs/options.md from what the program says of itself.

    tools/make_options_doc.py PROGRAM [--check]

With --check nothing is written; the exit code is 1 if the document is not what would be written.
"""

import pathlib
import re
import subprocess
import sys

DOCUMENT = pathlib.Path(__file__).resolve().parent.parent / "docs" / "options.md"
COMMANDS = ["", "info", "render", "bench", "bench raycast", "compare", "simulate"]
HEAD = """# Options

What `--help` prints, command by command. This file is made by `tools/make_options_doc.py build/release/meniscus`;
a test checks that it is up to date. The [guide](guide.md) explains what the options are for.
"""


def help_of(program, command):
    done = subprocess.run([program, *command.split(), "--help"], capture_output=True, text=True, check=True)
    text = "\n".join(line.rstrip() for line in done.stdout.strip().splitlines())
    return re.sub(r"\n{3,}", "\n\n", text)


def document_of(program):
    parts = [HEAD]
    for command in COMMANDS:
        parts.append(f"## {('meniscus ' + command).strip()}\n\n```text\n{help_of(program, command)}\n```\n")
    return "\n".join(parts)


def main():
    arguments = [argument for argument in sys.argv[1:] if argument != "--check"]
    if len(arguments) != 1:
        print(__doc__.strip(), file=sys.stderr)
        return 2
    document = document_of(arguments[0])
    if "--check" not in sys.argv:
        DOCUMENT.parent.mkdir(exist_ok=True)
        DOCUMENT.write_text(document, encoding="utf-8")
        return 0
    if DOCUMENT.is_file() and DOCUMENT.read_text(encoding="utf-8") == document:
        return 0
    print(f"{DOCUMENT} is not up to date: run tools/make_options_doc.py {arguments[0]}")
    return 1


if __name__ == "__main__":
    sys.exit(main())
