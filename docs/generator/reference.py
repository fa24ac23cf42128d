"""Parts that come from the programs: commands with their options, scenes, settings, the engine's constants."""
import json
import re

from . import help_text
from .markdown import cell, table
from .recorded import NOT_REACHED


def command_options(commands):
    """Every command with its options and examples, for docs/command-line.md."""
    parts = []
    for command in commands:
        if command.commands:
            continue
        title = command.name if command.name.startswith("springtower") else f"springtower {command.name}"
        usage = command.usage
        part = [f"### {title}", "", command.text[0].upper() + command.text[1:].rstrip(".") + ".", "", f"`{usage}`", ""]
        rows = [(f"`{option.value}`", cell(option.text)) for option in command.positionals]
        for option in command.options:
            if "--help" in option.names or "--help-all" in option.names:
                continue
            text = cell(option.text)
            if option.required:
                text += "; required"
            if option.needs:
                text += f"; only with `{option.needs}`"
            rows.append((" ".join(f"`{name}`" for name in option.names) + (f" `{option.value}`" if option.value else ""), text))
        if rows:
            part += [table(["option", "what it does"], rows), ""]
        if command.footer:
            part += ["```", command.footer, "```", ""]
        parts.append("\n".join(part).rstrip())
    return "\n\n".join(parts)


def scene_names(rows):
    """The scenes that have a name, for docs/scenes.md."""
    return table(["scene", "what it is", "size if none is given; sizes allowed"],
                 [(f"`{name}`", cell(what), cell(sizes)) for name, what, sizes in rows])


def settings(rows):
    """What a scene may set, for docs/scenes.md."""
    def value(number):
        return "by scene" if number is None else f"{number:g}"
    return table(["key", "default", "allowed", "unit", "what"],
                 [(f"`{row['key']}`", value(row["default"]), f"{row['least']:g} to {row['most']:g}", cell(row["unit"]),
                   cell(row["what"])) for row in rows])


def reasons(definition):
    """The comment before each row of core/tuning.def: {name: text}."""
    found, comment = {}, []
    for line in definition.split("\n"):
        row = re.match(r"TUNING(?:_SIZE)?\([^,]+, (\w+),", line)
        if line.startswith("//"):
            comment.append(line[2:].strip())
        else:
            if row and comment:
                found[row.group(1)] = " ".join(comment)
            comment = []
    return found


# Groups of constants that the scenes of docs/sensitivity.md do not use, or that no end state depends on.
NOT_EXERCISED = ("measuring", "threads and memory")


def tuning(rows, definition, moves):
    """The whole page docs/tuning.md. moves: of recorded.what_rests_on_moves."""
    why = reasons(definition)
    bare = [row for row in rows if row["evidence"] == "none"]
    def is_measured(row):
        return row["name"] in moves and row["group"] not in NOT_EXERCISED
    def evidence(row):
        return moves[row["name"]] if row in bare and is_measured(row) else row["evidence"]
    measured = sum(is_measured(row) and moves[row["name"]] != NOT_REACHED for row in bare)
    not_reached = sum(is_measured(row) and moves[row["name"]] == NOT_REACHED for row in bare)
    page = [
        "# Constants of the engine", "",
        "Made by `docs/generate.py` from `springtower settings --all --json` and the comments of [`core/tuning.def`](../core/tuning.def).", "",
        "These are the numbers that are choices, rather than physics or layout, and that no scene sets: thresholds, limits, safety factors. "
        "h is the height of the scene's lowest block, g is gravity. "
        f"Of {len(rows)} constants, {len(rows) - len(bare)} rest on a derivation, a measurement or a reason. For {measured} "
        "stands what changes where they are half or twice as large: which figures of the 46 scenes of [sensitivity.md](sensitivity.md), beyond "
        "the scatter that is explained there, or end states alone. Constants of statics are judged by eleven answers of `springtower statics`. "
        f"For {not_reached} half and twice change no bit of them: they decide in scenes that are not among these, or never. "
        f"For {len(bare) - measured - not_reached}, of measuring, threads and sizes of arrays, which these scenes do not show, nothing is on record ('none'). "
        "To try others: the preset `tune` ([CONTRIBUTING.md](../CONTRIBUTING.md)).",
    ]
    groups = []
    for row in rows:
        if row["group"] not in groups:
            groups.append(row["group"])
    for group in groups:
        members = [row for row in rows if row["group"] == group]
        page += ["", f"## {group[0].upper()}{group[1:]}", "", table(
            ["constant", "value", "unit", "what for", "rests on"],
            [(f"`{row['name']}`", f"{row['value']:g}", cell(row["unit"]), cell(row["purpose"]), cell(evidence(row))) for row in members])]
        for row in members:
            if row["name"] in why:
                page += ["", f"`{row['name']}`: {cell(why[row['name']])}"]
    return "\n".join(page) + "\n"


def read(program, viewer):
    """All that this module needs from the programs."""
    listed = json.loads(help_text.printed(program, "settings", "--all", "--json"))
    return help_text.read(program), help_text.read(viewer), help_text.scenes(program), listed["settings"], listed["tuning"]
