"""The help of the programs as data: what pages, man pages and completions are made of."""
import dataclasses
import re
import subprocess

# Where the description of an option begins in `COMMAND --help` (apps/common/arguments.cpp sets it).
DESCRIPTION_COLUMN = 34


@dataclasses.dataclass
class Option:
    """One option or positional. names: its spellings, empty for a positional. value: its placeholder, or empty for a flag."""
    names: list
    value: str
    needs: str
    excludes: list
    required: bool
    repeated: bool
    text: str


@dataclasses.dataclass
class Command:
    """One command, or a whole program without commands. footer: what stands below the options, as it is printed."""
    name: str
    text: str
    usage: str
    positionals: list
    options: list
    former: list
    commands: list
    footer: str


def printed(program, *arguments):
    """What the program prints on standard output; ends with a message where it fails."""
    result = subprocess.run([program, *arguments], capture_output=True, text=True)
    if result.returncode != 0:
        raise SystemExit(f"{program} {' '.join(arguments)}: expected exit code 0, got {result.returncode}: {result.stderr.strip()}")
    return result.stdout


def allowed(program, *arguments):
    """The names that an error message lists as allowed, when the last argument is no name at all."""
    result = subprocess.run([program, *arguments], capture_output=True, text=True)
    match = re.search(r": expected (.*), got '", result.stderr)
    if result.returncode != 2 or not match:
        raise SystemExit(f"{program} {' '.join(arguments)}: expected an error that lists what is allowed, got {result.stderr.strip()}")
    names = []
    for part in re.split(r", | or ", match.group(1)):
        names += re.findall(r"[\w-]+", part.replace("(also:", " "))
    return names


def _option(head, text):
    excludes = re.search(r"Excludes:((?: --[\w-]+)+)", head)
    needs = re.search(r"Needs: (--[\w-]+)", head)
    first = re.sub(r"(Excludes|Needs):( --[\w-]+)+|REQUIRED", "", head).strip()
    repeated = first.endswith("...")
    words = first.removesuffix(" ...").split()
    names = [name for name in words[0].split(",")] if words[0].startswith("-") else []
    value = " ".join(words[1:]) if names else words[0]
    return Option(names, value, needs.group(1) if needs else "", excludes.group(1).split() if excludes else [],
                  "REQUIRED" in head, repeated, " ".join(text))


def _entries(lines):
    """(head, description lines) of each entry of a section."""
    entries = []
    for line in lines:
        head, rest = line[:DESCRIPTION_COLUMN], line[DESCRIPTION_COLUMN:]
        if line.startswith("  -") or re.match(r"  [A-Za-z]", line):
            # A head that is too long stands alone on its line.
            separate = re.match(r"  (.*?\S)(?:\s{2,}(.*))?$", line)
            long = len(line) > DESCRIPTION_COLUMN and (line[DESCRIPTION_COLUMN - 1] != " " or head.rstrip().endswith(":"))
            head, rest = (line.strip(), "") if long else (separate.group(1), line[DESCRIPTION_COLUMN:].strip())
            entries.append((head, [rest] if rest else []))
        elif head.strip() == "" and entries:
            entries[-1][1].append(rest.strip())
    return entries


def parse(name, text):
    """The printed help of a command as a Command."""
    lines = text.rstrip("\n").split("\n")
    sections = {"Positionals:": [], "Options:": [], "Former names:": [], "Subcommands:": []}
    usage, current, footer, intro = "", None, [], []
    for line in lines:
        if line in sections:
            current = line
        elif line.startswith("Usage: "):
            usage = line.removeprefix("Usage: ")
        elif not usage:
            intro.append(line)
        elif current and (line == "" or line.startswith("  ")) and not footer:
            sections[current].append(line)
        elif line or footer:
            footer.append(line)
    def options(key):
        return [_option(head, text) for head, text in _entries([line for line in sections[key] if line])]
    commands = [(head, " ".join(text)) for head, text in _entries([line for line in sections["Subcommands:"] if line])]
    return Command(name, " ".join(line for line in intro if line), usage, options("Positionals:"), options("Options:"),
                   options("Former names:"), commands, "\n".join(footer).rstrip())


def read(program):
    """The help of a program and of each of its commands, the program first."""
    name = program.rsplit("/", 1)[-1]
    whole = parse(name, printed(program, "--help"))
    return [whole] + [parse(command, printed(program, command, "--help")) for command, _ in whole.commands]


def scenes(program):
    """(name with size, what it is, sizes) of each scene that has a name."""
    lines = printed(program, "scenes").rstrip("\n").split("\n")
    second, third = lines[0].index("what it is"), lines[0].index("size if none")
    return [(line[:second].strip(), line[second:third].strip(), line[third:].strip()) for line in lines[1:]]
