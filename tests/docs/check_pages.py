#!/usr/bin/env python3
"""Checks every page of the repository: check_pages.py BIN_DIR

- every relative link leads to a file, and its anchor to a heading of that file;
- every path between backticks is there (build outputs and placeholders in capitals aside);
- every option of `springtower COMMAND`, of the viewer, and every other word that begins with two dashes is one that the help lists;
- every constant kName between backticks is in the sources;
- every work that a page or a source cites by name and year is in docs/references.bib.

Prints one line for each fault, with file and line; exit code 1 where there is any.
"""
import pathlib
import re
import sys

sys.dont_write_bytecode = True
ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "docs"))
from generator import help_text  # noqa: E402

# Options of other programs that pages name, and where they come from.
OTHER_OPTIONS = {
    "--preset", "--build", "--target", "--install", "--prefix", "--test-dir",  # cmake, ctest
    "--sanitize",  # test.sh
    "--list",  # .ci/long
    "--update",  # bench/callgrind.py, the pinned tests
    "--check",  # docs/generate.py
    "--from", "--count", "--limit", "--write", "--file", "--shrink", "--fault", "--minutes", "--bin",  # tests/random, .ci/long
    "--kind",  # ccd_queries
    "--benchmark_filter",  # springtower_benchmarks
    "--help", "--help-all", "--version",
}
SKIPPED_FOLDERS = ("build/", "out/", "lib/", "figures/", "/")
MONTHS = ("January", "February", "March", "April", "May", "June", "July", "August", "September", "October", "November", "December")
SOURCES = ("core", "broadphase", "narrowphase", "solver", "scenarios", "api", "include", "apps", "bench", "examples", "tests")


def pages():
    found = sorted(path for path in ROOT.rglob("*.md") if not {"build", ".git", "out"} & set(path.relative_to(ROOT).parts))
    if len(found) < 20:
        sys.exit(f"check_pages.py: expected at least 20 pages below {ROOT}, got {len(found)}")
    return found


def slug(heading):
    """The anchor that GitHub gives a heading."""
    heading = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading)
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def anchors(path):
    """All anchors of a page; headings in code blocks are none."""
    found, seen, code = set(), {}, False
    for line in path.read_text().split("\n"):
        code ^= line.startswith("```")
        match = None if code else re.match(r"#{1,6} (.*)", line)
        if match:
            name = slug(match.group(1))
            found.add(name if name not in seen else f"{name}-{seen[name]}")
            seen[name] = seen.get(name, 0) + 1
    return found


def bad_links(path, line):
    for target in re.findall(r"\]\(([^)\s]+)\)", line):
        if re.match(r"[a-z]+:", target):
            continue
        name, _, anchor = target.partition("#")
        file = (path.parent / name).resolve() if name else path
        if not file.exists():
            yield f"expected a file, got the link '{target}'"
        elif anchor and file.suffix == ".md" and anchor not in anchors(file):
            yield f"expected a heading, got the anchor '{target}'"


def is_path(word):
    """Whether a word between backticks names something of the repository."""
    if not re.fullmatch(r"[\w.*{},+-]+(/[\w.*{},+-]+)*/?", word) or re.search(r"[A-Z]{3,}", word):
        return False
    if word.startswith(SKIPPED_FOLDERS):
        return False
    return word.split("/")[0] in TOP and ("/" in word)


def exists(word, folder):
    """A file or folder, also without the ending of a source, or a pattern that something matches."""
    for base in (ROOT, folder):
        for ending in ("", ".h", ".cpp", ".md"):
            if "*" in word and list(base.glob(word + ending)):
                return True
            if "*" not in word and (base / (word.rstrip("/") + ending)).exists():
                return True
    return False


def bad_paths(path, line):
    for code in re.findall(r"`([^`]+)`", line):
        for word in re.split(r"[\s,]+", code):
            word = word.split(":")[0].strip("();,\"'")
            if is_path(word) and not exists(word, path.parent):
                yield f"expected a path of the repository, got '{word}'"


def bad_options(line, options):
    """Options after a command against that command's; all others against all that there are."""
    every = set().union(*options.values()) | OTHER_OPTIONS
    rest = line
    for match in re.finditer(r"(?:build/\w+/bin/)?springtower(-viewer)?((?: (?![`|>&#])[^\s`|]+)*)", line):
        words = match.group(2).split()
        command = "springtower-viewer" if match.group(1) else words[0] if words else ""
        if command not in options:
            continue
        for option in re.findall(r"(?<![\w-])--[a-z][\w-]*", match.group(2)):
            if option not in options[command] | {"--help", "--help-all"}:
                yield f"expected an option of 'springtower {command}', got '{option}'"
        rest = rest.replace(match.group(0), " ")
    for option in re.findall(r"(?<![\w-])--[a-z][\w-]*", rest):
        if option not in every and not option.startswith("--benchmark_") and not option.startswith("--gtest_"):
            yield f"expected an option that a help lists, got '{option}'"


def constants():
    text = "\n".join(path.read_text(errors="replace") for folder in SOURCES for path in (ROOT / folder).rglob("*")
                     if path.suffix in (".h", ".cpp", ".def"))
    return set(re.findall(r"\bk[A-Z]\w+", text))


def bad_constants(line, known):
    for name in re.findall(r"`(k[A-Z]\w+)`", line):
        if name not in known:
            yield f"expected a constant of the sources, got '{name}'"


CITATION = re.compile(r"\b((?:[A-Z][\w']+(?:, | and | & | et al\.,? )?)+) ?\(?((?:18|19|20)\d\d)\b(?!-)")


def plain(name):
    """A name without the ways to write its umlauts."""
    return name.replace("\u00fc", "u").replace("\u00f6", "o").replace("u" + "e", "u").replace("o" + "e", "o")


def works():
    """(surname, year) of every author of docs/references.bib."""
    found = set()
    for entry in (ROOT / "docs" / "references.bib").read_text().split("\n@"):
        authors, year = re.search(r"author\s*= \{(.*)\},", entry), re.search(r"year\s*= \{(\d+)\}", entry)
        if authors and year:
            for author in authors.group(1).split(" and "):
                surname = re.sub(r"[{}\\\"']", "", author.split(",")[0])
                found.add((plain(surname.split()[-1]), year.group(1)))
            title = re.search(r"title\s*= \{+(\w+)", entry)  # a talk or a page may be cited by it
            found.add((plain(title.group(1)), year.group(1)))
    return found


def bad_citations(line, known):
    for match in CITATION.finditer(line):
        names = re.findall(r"[A-Z][\w'é]+", match.group(1))
        if names[-1] in MONTHS or names == ["The"] or names == ["Debian"]:
            continue
        if not any((plain(name), match.group(2)) in known for name in names):
            yield f"expected a work of docs/references.bib, got '{match.group(0)}'"


def cited_in_sources(known):
    for folder in SOURCES:
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix in (".h", ".cpp", ".def"):
                for number, line in enumerate(path.read_text(errors="replace").split("\n"), 1):
                    if "//" in line or "evidence" in line or path.suffix == ".def":
                        yield from ((path, number, fault) for fault in bad_citations(line, known))


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    program = str(pathlib.Path(sys.argv[1], "springtower"))
    commands = help_text.read(program) + help_text.read(program + "-viewer")
    options = {command.name: {name for option in command.options + command.former for name in option.names} for command in commands
               if not command.commands}
    known, cited = constants(), works()
    faults = 0
    for path, number, fault in cited_in_sources(cited):
        print(f"{path.relative_to(ROOT)}:{number}: {fault}")
        faults += 1
    for path in pages():
        # The change log names what is gone.
        history = path.name == "CHANGELOG.md"
        for number, line in enumerate(path.read_text().split("\n"), 1):
            found = list(bad_links(path, line))
            if not history:
                found += [*bad_paths(path, line), *bad_options(line, options), *bad_constants(line, known), *bad_citations(line, cited)]
            for fault in found:
                print(f"{path.relative_to(ROOT)}:{number}: {fault}")
            faults += len(found)
    print(f"{len(pages())} pages, {faults} faults")
    sys.exit(1 if faults else 0)


TOP = {path.name for path in ROOT.iterdir()} - {"build"}

if __name__ == "__main__":
    main()
