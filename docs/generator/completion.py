"""Completions of options and names for bash, zsh and fish."""
import dataclasses
import re

from . import help_text

MADE = "# Made by docs/generate.py from the help of the programs."


@dataclasses.dataclass
class Words:
    """What may follow. options: {command: [Option]}, '' for the program itself; choices: {(command, option): names}; scenes: names."""
    program: str
    viewer: str
    texts: dict
    options: dict
    choices: dict
    scenes: list


# Options whose values are names, and the arguments that make the program list them.
LISTED = [
    ("run", "--method", ["run", "tower:1", "--method", "?"]),
    ("run", "--inertia", ["run", "tower:1", "--inertia", "?"]),
    ("verdict", "--method", ["run", "tower:1", "--method", "?"]),
    ("verdict", "--inertia", ["run", "tower:1", "--inertia", "?"]),
    ("profile", "--scenes", ["profile", "--scenes", "?"]),
    ("profile", "--methods", ["profile", "--methods", "?"]),
    ("profile", "--inertia", ["run", "tower:1", "--inertia", "?"]),
    ("chart", "--scenes", ["chart", "--scenes", "?"]),
    ("chart", "--methods", ["chart", "--methods", "?"]),
    ("validate", "--only", ["validate", "--out", "nowhere", "--only", "?"]),
]
LISTED_OF_VIEWER = [("--method", ["--method", "?"]), ("--overlay", ["--overlay", "?"])]


def words(program, viewer_program, commands, viewer, scenes):
    """Reads all names from the programs."""
    whole = commands[0].name
    options = {command.name: command.options + command.former for command in commands} | {viewer.name: viewer.options}
    choices = {(command, option): help_text.allowed(program, *arguments) for command, option, arguments in LISTED}
    choices |= {(viewer.name, option): help_text.allowed(viewer_program, *arguments) for option, arguments in LISTED_OF_VIEWER}
    texts = {command.name: command.text for command in commands[1:]}
    return Words(whole, viewer.name, texts, options, choices, [re.sub(r":.*", ":", name) for name, _, _ in scenes])


def takes_folder(option):
    return option.value == "DIR"


def takes_file(option):
    return option.value.startswith("FILE")


def _names(options):
    return [name for option in options for name in option.names]


def _bash_values(words, command, pattern=None):
    """Lines of a case over the option before the word."""
    lines = []
    for option in words.options[command]:
        if not option.value:
            continue
        label = "|".join(option.names)
        names = next((words.choices[(command, name)] for name in option.names if (command, name) in words.choices), None)
        if names:
            action = f'_springtower_listed "{" ".join(names)}"'
        elif option.value == "SCENE":
            action = "_springtower_scene"
        elif takes_folder(option):
            action = 'mapfile -t COMPREPLY < <(compgen -d -- "$current")'
        elif takes_file(option):
            action = 'mapfile -t COMPREPLY < <(compgen -f -- "$current")'
        else:
            action = "COMPREPLY=()"
        lines.append(f"        {label}) {action}; return ;;")
    return lines


def bash(words):
    """One script for both programs; needs bash 4 and nothing else."""
    lines = [MADE, "# bash: source it, or install it as bash-completion's springtower.", ""]
    lines += [
        "# Names of a list, the last of it to be completed.",
        "_springtower_listed() {",
        '  local before=""',
        '  [[ $current == *,* ]] && before=${current%,*},',
        '  mapfile -t COMPREPLY < <(compgen -P "$before" -W "$1" -- "${current##*,}")',
        "}",
        "",
        "# A scene by its name, or a file. A colon ends a word of bash, so what comes before it is left out of the answer.",
        "_springtower_scene() {",
        "  local before=\"\"",
        '  [[ $current == *:* ]] && before=${current%"${current##*:}"}',
        f'  mapfile -t COMPREPLY < <(compgen -W "{" ".join(words.scenes)}" -- "$current" || :; compgen -f -X "!*.toml" -- "$current" || :; compgen -d -S / -- "$current" || :)',
        '  [[ -z $before ]] || COMPREPLY=("${COMPREPLY[@]#"$before"}")',
        "  compopt -o nospace 2>/dev/null || true",
        "}",
        "",
        "# The word before the cursor with the colons that bash has split off.",
        "_springtower_words() {",
        "  current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]}",
        "  local at=$COMP_CWORD",
        "  if [[ $current == : ]]; then",
        "    current=$previous: previous=${COMP_WORDS[at - 2]}",
        "  elif [[ $previous == : ]]; then",
        "    current=${COMP_WORDS[at - 2]}:$current previous=${COMP_WORDS[at - 3]}",
        "  fi",
        "}",
        "",
        "_springtower() {",
        "  local current previous command",
        "  _springtower_words",
        "  command=${COMP_WORDS[1]}",
        "  if ((COMP_CWORD == 1)); then",
        f'    mapfile -t COMPREPLY < <(compgen -W "{" ".join([*words.texts, *_names(words.options[words.program])])}" -- "$current")',
        "    return",
        "  fi",
        "  case $command in",
    ]
    positional = {"run": "_springtower_scene", "statics": "_springtower_scene",
                  "verdict": 'mapfile -t COMPREPLY < <(compgen -f -- "$current")'}
    for command in words.texts:
        lines += [f"    {command})", "      case $previous in", *_bash_values(words, command), "      esac",
                  "      if [[ $current == -* ]]; then",
                  f'        mapfile -t COMPREPLY < <(compgen -W "{" ".join(_names(words.options[command]))}" -- "$current")']
        if command in positional:
            lines += ["      else", f"        {positional[command]}"]
        lines += ["      fi", "      ;;"]
    lines += ["  esac", "}", "", "_springtower_viewer() {", "  local current previous", "  _springtower_words", "      case $previous in",
              *_bash_values(words, words.viewer), "      esac",
              f'  mapfile -t COMPREPLY < <(compgen -W "{" ".join(_names(words.options[words.viewer]))}" -- "$current")', "}", "",
              f"complete -F _springtower {words.program}", f"complete -F _springtower_viewer {words.viewer}", ""]
    return "\n".join(lines)


def _quoted(text):
    return "'" + text.replace("'", "'\\''") + "'"


def fish(words):
    """One script a program."""
    def line(program, condition, option, names):
        text = f"complete -c {program}{condition}"
        for name in option.names:
            text += f" -l {name[2:]}" if name.startswith("--") else f" -s {name[1:]}"
        if option.value:
            text += " -r -F" if takes_file(option) or takes_folder(option) or option.value == "SCENE" else " -x"
            if names:
                text += f" -a {_quoted(' '.join(names))}"
        return text + f" -d {_quoted(option.text[:72])}"

    def of(program, command, condition):
        lines = []
        for option in words.options[command]:
            names = next((words.choices[(command, name)] for name in option.names if (command, name) in words.choices), None)
            if option.value == "SCENE":
                names = words.scenes
            lines.append(line(program, condition, option, names))
        return lines
    main = [MADE, f"complete -c {words.program} -f"]
    for command, text in words.texts.items():
        main.append(f"complete -c {words.program} -n __fish_use_subcommand -a {command} -d {_quoted(text)}")
    main += of(words.program, words.program, " -n __fish_use_subcommand")
    for command in words.texts:
        condition = f" -n '__fish_seen_subcommand_from {command}'"
        if command in ("run", "statics"):
            main.append(f"complete -c {words.program}{condition} -F -a {_quoted(' '.join(words.scenes))}")
        elif command == "verdict":
            main.append(f"complete -c {words.program}{condition} -F")
        main += of(words.program, command, condition)
    viewer = [MADE, f"complete -c {words.viewer} -f", *of(words.viewer, words.viewer, "")]
    return "\n".join(main) + "\n", "\n".join(viewer) + "\n"


def zsh(words):
    """One function for both programs."""
    def value(command, option):
        names = next((words.choices[(command, name)] for name in option.names if (command, name) in words.choices), None)
        if names:
            return f":{option.value}:_sequence compadd - {' '.join(names)}" if "," in option.value else f":{option.value}:({' '.join(names)})"
        if option.value == "SCENE":
            return ":scene:_springtower_scenes"
        if takes_folder(option):
            return ":folder:_files -/"
        return f":{option.value.replace(':', ' ')}:" + ("_files" if takes_file(option) else "")

    def arguments(command, indent):
        lines = []
        for option in words.options[command]:
            text = re.sub(r"[\[\]:]", " ", option.text[:72])
            for name in option.names:
                entry = f"{name}[{text}]" + (value(command, option) if option.value else "")
                lines.append(f"{indent}{_quoted(('*' if option.repeated else '') + entry)} \\")
        return lines
    lines = [f"#compdef {words.program} {words.viewer}", MADE, "", "_springtower_scenes() {",
             f"  compadd -S '' - {' '.join(words.scenes)}", "  _files -g '*.toml'", "}", "", "_springtower() {",
             f"  if [[ $service == {words.viewer} ]]; then", "    _arguments \\", *arguments(words.viewer, "      "), "      && return",
             "    return 1", "  fi", "  if ((CURRENT == 2)); then", "    local -a commands=("]
    lines += [f"      {_quoted(command + ':' + text)}" for command, text in words.texts.items()]
    lines += ["    )", "    _describe command commands", "    return", "  fi", "  local command=$words[2]", "  shift words", "  ((CURRENT--))",
              "  case $command in"]
    for command in words.texts:
        lines += [f"    {command})", "      _arguments \\", *arguments(command, "        ")]
        lines.append("        '1:scene:_springtower_scenes'" if command in ("run", "statics")
                     else "        '1:file:_files'" if command == "verdict" else "        && return")
        lines.append("      ;;")
    lines += ["  esac", "}", "", '_springtower "$@"', ""]
    return "\n".join(lines)


def scripts(words):
    """{path: text} of all completions."""
    main, viewer = fish(words)
    return {"docs/completion/springtower.bash": bash(words), "docs/completion/_springtower": zsh(words),
            "docs/completion/springtower.fish": main, "docs/completion/springtower-viewer.fish": viewer}
