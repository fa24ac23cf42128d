#!/usr/bin/env python3
"""Writes what is generated in the documents: docs/generate.py BIN_DIR [--check]

BIN_DIR holds springtower and springtower-viewer: build/release/bin, build/ci/bin. From their help, `springtower scenes`,
`springtower settings`, core/tuning.def, docs/data (recorded by docs/measure.py) and bench/data/peers it writes the marked parts of
pages, docs/tuning.md, docs/claims.md, the manual pages of docs/man and the completions of docs/completion. --check writes nothing
and names what differs from what it would write; exit code 1 then.
"""
import difflib
import pathlib
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from generator import completion, man, markdown, recorded, reference  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"
DATA = DOCS / "data"
PEERS = ROOT / "bench" / "data" / "peers"


def measurements(peers_stacks):
    """Tables of docs/performance.md, of what docs/measure.py has recorded so far."""
    tables = {"runs": recorded.runs, "rows": recorded.rows, "motion": recorded.motion, "game": recorded.motion, "game_parts": recorded.game_parts,
              "towers": recorded.towers, "roofline": recorded.roofline, "factors": recorded.factors,
              "stacks": lambda rows: recorded.stacks(rows, peers_stacks), "falls": recorded.falls, "starts": recorded.starts}
    parts = {}
    for name, table in tables.items():
        file = DATA / ("kernels.csv" if name in ("roofline", "factors") else f"{name}.csv")
        if file.exists():
            rows = recorded.read_csv(file)
            parts[name] = table(rows) + "\n\n" + recorded.condition(rows)
    return parts


def charted(peers_falls):
    """Tables of docs/accuracy.md, of the chart that docs/measure.py has recorded."""
    if not (DATA / "accuracy.csv").exists():
        return {}
    rows = recorded.read_csv(DATA / "accuracy.csv")
    here = recorded.condition(rows)
    tables = {"chart-methods": recorded.chart_methods(rows), "chart-fastest": recorded.chart_fastest(rows), "chart-pull": recorded.chart_pull(rows),
              "chart-falls": recorded.chart_falls(rows, peers_falls), "chart-engines": recorded.chart_engines(rows)}
    return {name: text + "\n\n" + here for name, text in tables.items()}


def random_scenes():
    """Tables of docs/random-scenes.md."""
    return {"random": recorded.random_scenes(recorded.read_csv(DATA / "random.csv")),
            "bounds": recorded.random_bounds((ROOT / "tests" / "random" / "bounds.cpp").read_text())}


def marked_parts(commands, viewer, scenes, settings):
    """{page: {name of the part: text}}."""
    peers_at_rest = [row for row in recorded.read_csv(PEERS / "records.csv") if row["scene"] == "uniform" and row["rows"] == "18"
                     and row["engine"] in ("Box3D", "Jolt")]
    peers_stacks = recorded.read_csv(PEERS / "stacks.csv")
    peers_falls = recorded.read_csv(PEERS / "falls.csv")
    return {
        "README.md": {"claims": recorded.claims_line(recorded.read_json(DATA / "validation.json")),
                      "headline": recorded.headline(*(recorded.read_csv(DATA / f"{name}.csv") for name in ("runs", "motion", "stacks", "accuracy")),
                                                    peers_at_rest, peers_stacks, peers_falls),
                      "random": recorded.random_line(recorded.read_csv(DATA / "random.csv"), short=True)},
        "docs/limits.md": {"random": recorded.random_line(recorded.read_csv(DATA / "random.csv"), short=False)},
        "docs/command-line.md": {"options": reference.command_options(commands + viewer)},
        "docs/scenes.md": {"scenes": reference.scene_names(scenes), "settings": reference.settings(settings)},
        "docs/validation.md": {"claims": recorded.claims_summary(recorded.read_json(DATA / "validation.json"))},
        "docs/performance.md": measurements(peers_stacks),
        "docs/random-scenes.md": random_scenes(),
        "docs/sensitivity.md": {"constants": recorded.constants(recorded.read_csv(DATA / "constants.csv"))},
        "docs/accuracy.md": {"peers-at-rest": recorded.peers_at_rest(peers_at_rest),
                             "peers-stacks": recorded.peers_stacks(peers_stacks),
                             "peers-falls": recorded.peers_falls(peers_falls),
                             **charted(peers_falls)},
    }


def files(folder):
    """{path from the root: text} of all that is generated."""
    program, viewer_program = (str(pathlib.Path(folder, name)) for name in ("springtower", "springtower-viewer"))
    commands, viewer, scenes, settings, constants = reference.read(program, viewer_program)
    moves = recorded.what_rests_on_moves(recorded.read_csv(DATA / "constants.csv"))
    written = {
        "docs/tuning.md": reference.tuning(constants, (ROOT / "core" / "tuning.def").read_text(), moves),
        "docs/claims.md": recorded.claims_page(recorded.read_json(DATA / "validation.json")),
    }
    for page, parts in marked_parts(commands, viewer, scenes, settings).items():
        written[page] = markdown.replace_parts(page, (ROOT / page).read_text(), parts)
    written |= man.pages(commands, viewer[0])
    written |= completion.scripts(completion.words(program, viewer_program, commands, viewer[0], scenes))
    return written


def main():
    arguments = [argument for argument in sys.argv[1:] if argument != "--check"]
    if len(arguments) != 1 or arguments[0].startswith("-"):
        sys.exit(__doc__)
    differing = 0
    for name, text in files(arguments[0]).items():
        path = ROOT / name
        present = path.read_text() if path.exists() else ""
        if present == text:
            continue
        differing += 1
        if "--check" in sys.argv[1:]:
            print(f"{name}: expected what docs/generate.py writes, got something else (- here, + generated)")
            print("\n".join(list(difflib.unified_diff(present.split("\n"), text.split("\n"), lineterm="", n=0))[2:12]))
        else:
            path.parent.mkdir(exist_ok=True)
            path.write_text(text)
            print(f"{name} written")
    if differing and "--check" in sys.argv[1:]:
        sys.exit(f"{differing} files differ; run docs/generate.py {arguments[0]} and commit them")


if __name__ == "__main__":
    main()
