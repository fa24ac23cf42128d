#!/usr/bin/env python3
"""Checks the manual pages without a formatter: man_test.py BIN_DIR

Known requests alone, balanced blocks, the sections that every manual page has, no line that roff would take as a request by
accident, and every option of the help. Prints each fault with its line; exit code 1 where there is any.
"""
import pathlib
import re
import sys

sys.dont_write_bytecode = True
ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "docs"))
from generator import help_text, man  # noqa: E402

REQUESTS = {'.\\"', ".TH", ".SH", ".SS", ".TP", ".PP", ".nf", ".fi", ".ft"}
SECTIONS = ["NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "EXAMPLES AND NOTES", "SEE ALSO"]
ESCAPES = re.compile(r"\\(?:-|e|&|fB|fI|fR|\")")


def faults(text, options):
    lines = text.rstrip("\n").split("\n")
    block = False
    for number, line in enumerate(lines, 1):
        request = line.split(" ")[0]
        if line[:1] in (".", "'") and request not in REQUESTS:
            yield number, f"expected a request among {' '.join(sorted(REQUESTS))}, got '{request}'"
        if request in (".nf", ".fi"):
            if block == (request == ".nf"):
                yield number, f"expected {'.fi' if block else '.nf'}, got '{request}'"
            block = request == ".nf"
        if not line:
            yield number, "expected no empty line, got one"
        if not line.startswith('.\\"') and "\\" in ESCAPES.sub("", line):
            yield number, f"expected a known escape, got '{line}'"
        if len(line.encode()) > 2000:
            yield number, "expected at most 2000 characters, got more"
    if not re.match(r'\.TH [A-Z-]+ 1 ', lines[1]):
        yield 2, f"expected .TH NAME 1, got '{lines[1]}'"
    for section in SECTIONS:
        if f".SH {section}" not in lines:
            yield len(lines), f"expected the section {section}, got none"
    for option in options:
        if f"\\fB{man.escape(option)}\\fR" not in text:
            yield len(lines), f"expected the option {option}, got none"


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    program = str(pathlib.Path(sys.argv[1], "springtower"))
    found = 0
    for name in (program, program + "-viewer"):
        options = {spelling for command in help_text.read(name) for option in command.options for spelling in option.names}
        path = ROOT / "docs" / "man" / (name.rsplit("/", 1)[-1] + ".1")
        for number, fault in faults(path.read_text(), sorted(options)):
            print(f"{path.relative_to(ROOT)}:{number}: {fault}")
            found += 1
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
