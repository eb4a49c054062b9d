#!/usr/bin/env python3
"""Writes the pages of docs/reference that the program itself can tell: commands.md and settings.md.

Usage: scripts/generate_reference.py [--program FILE] [--config FILE] [--check]

--program FILE  the program (build/release/bin/lodeline)
--config FILE   a config.yaml with the defaults, in place of that of the program
--check         write nothing; end with exit code 1 where a page is not up to date

Commands come from `lodeline --help` and `lodeline COMMAND --help`, without the examples. Settings, their
defaults and their meaning come from `lodeline settings`.
"""

import argparse
import re
import subprocess
import sys
import textwrap
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGES = ROOT / "docs" / "reference"


def help_of(program, *words):
    return subprocess.run([program, *words, "--help"], check=True, capture_output=True, text=True).stdout.rstrip()


def subcommands(text, is_program=False):
    """Name and description of the commands that a help text lists: below `Commands:`, for the program below all titles."""
    commands, is_list = [], False
    for line in text.splitlines():
        if line.endswith(":") and not line.startswith(" "):
            is_list = is_program or line == "Commands:"
        row = re.match(r"^  ([a-z][a-z-]*)\s{2,}(\S.*)$", line)
        if is_list and row:
            commands.append((row.group(1), row.group(2)))
        elif is_list and commands and re.match(r"^ {20,}\S", line):
            commands[-1] = (commands[-1][0], commands[-1][1] + " " + line.strip())
    return commands


EXAMPLES = re.compile(r"^Examples?\b[^\n]*:\n(?:  .*\n?)+|^`lodeline help COMMAND` explains .*\n?", re.MULTILINE)
EVERYWHERE = {"--help", "--verbose", "--quiet"}
OPTION = re.compile(r"^  -\S.*(?:\n {8,}\S.*)*\n?", re.MULTILINE)
TITLE = re.compile(r"^(?:Arguments|Options|Settings|Recording|Place and time|Results|Screen):(?:\n|$)")
ARGUMENT = re.compile(r"^  [A-Z]+ {2,}\S.*(?:\n {8,}\S.*)*\n?", re.MULTILINE)


def named(option):
    """The long name of an option, such as --rig."""
    return re.search(r"--[a-z-]+", option).group()


def without_purpose_and_examples(text):
    return EXAMPLES.sub("", text.partition("\n\n")[2] + "\n").rstrip().removeprefix("Usage: ").replace(" [OPTIONS]", "", 1)


def places_of_options(leaves, texts):
    """For each option that several help texts have in the same words: the place that explains it, as a link.

    Three texts or more: the section of many commands. Two: the first command whose text does not refer to the other one.
    """
    owners = {}
    for (words, _), text in zip(leaves, texts):
        for option in OPTION.findall(text):
            owners.setdefault(option.rstrip(), []).append((words, text))
    places = {}
    for option, found in owners.items():
        if len(found) >= 3:
            places[option] = (None, "[Common options](#options-of-many-commands)")
        elif len(found) == 2:
            (first, text), (second, _) = found
            words = second if f"`lodeline {' '.join(second)}`" in " ".join(text.split()) else first
            places[option] = (words, f"Options of [{' '.join(words)}](#lodeline-{'-'.join(words)})")
    return places


def common_arguments(texts):
    """The arguments that three help texts or more have in the same words; of each name the most frequent one."""
    found = [argument.rstrip() for text in texts for argument in ARGUMENT.findall(text)]
    common = {}
    for argument in dict.fromkeys(found):
        name = argument.split()[0]
        if found.count(argument) >= 3 and found.count(argument) > found.count(common.get(name)):
            common[name] = argument
    return list(common.values())


def without_shown(text, shown, arguments):
    """A help text without the options of `shown`, the arguments, and the titles of groups.

    `shown` has for each option the link to the place that explains it. Also returned: a sentence with the names for each place.
    """
    names = {}
    for option in OPTION.findall(text):
        if option.rstrip() in shown and named(option) not in EVERYWHERE:
            names.setdefault(shown[option.rstrip()], []).append(f"`{named(option)}`")
    paragraphs = []
    for paragraph in text.split("\n\n"):
        rest = OPTION.sub(lambda option: "" if option.group().rstrip() in shown else option.group(), paragraph)
        rest = ARGUMENT.sub(lambda row: "" if row.group().rstrip() in arguments else row.group(), rest).rstrip()
        rest = TITLE.sub("", rest)
        if rest:
            paragraphs.append(rest)
    return "\n\n".join(paragraphs), [f"{place}: {', '.join(options)}." for place, options in names.items()]


def commands_page(program):
    leaves = []
    for name, summary in subcommands(help_of(program), is_program=True):
        inner = subcommands(help_of(program, name))
        leaves += [((name, word), text) for word, text in inner] or [((name,), summary)]
    page = ["# Commands", "",
            "*The script `scripts/generate_reference.py` writes this page from the help texts of the program.*", "",
            "`lodeline help` lists the commands. `lodeline help COMMAND` prints the text of one, with examples. Nearly all",
            "commands have `--verbose` and `--quiet`. [Exit codes](exit-codes.md) are the same for all."]
    texts = [without_purpose_and_examples(help_of(program, *words)) for words, _ in leaves]
    places = places_of_options(leaves, texts)
    shared = [option for option, (owner, _) in places.items() if owner is None]
    arguments = common_arguments(texts)
    page += ["", "## Options of many commands", "", "```text", *"\n".join(arguments + shared).splitlines(), "```"]
    for (words, summary), text in zip(leaves, texts):
        elsewhere = {option: place for option, (owner, place) in places.items() if owner != words}
        rest, sentences = without_shown(text, elsewhere, arguments)
        page += ["", f"## lodeline {' '.join(words)}", "", f"{summary}.", "", "```text",
                 *(line.rstrip() for line in rest.splitlines()), "```"]
        for sentence in sentences:
            page += ["", *textwrap.wrap(sentence, 118, break_on_hyphens=False)]
    return "\n".join(page) + "\n"


def config_of(program):
    return subprocess.run([program, "settings"], check=True, capture_output=True, text=True).stdout


def settings_of(config):
    """Name, default and the program's own words for each setting, in order."""
    settings, path, words = [], [], []
    for line in config.splitlines():
        stripped = line.strip()
        if stripped.startswith("#"):
            words.append(stripped[1:].strip())
        elif stripped:
            depth = (len(line) - len(line.lstrip())) // 2
            key, _, value = stripped.partition(":")
            path = path[:depth] + [key]
            if value.strip():
                settings.append((".".join(path), value.strip(), " ".join(words)))
            words = []
    return settings


def settings_page(config):
    rows = [f"| `{name}` | `{default}` | {words.replace('|', '/')} |" for name, default, words in settings_of(config)]
    page = ["# Settings", "",
            "*The script `scripts/generate_reference.py` writes this page from the settings of the program.*", "",
            "The defaults serve all recordings. Change a setting on the command line, `--set source.duration_s=60`, or in a",
            "YAML file, `-c config.yaml`. The command line goes over the file. The end of a name is the unit. A `sigma` is",
            "one standard deviation.", "",
            "| setting | default | meaning |", "| --- | --- | --- |", *rows, "", "## Expert settings", "",
            "`lodeline settings --expert` also prints the settings that only experiments need. `expert.` may be left out of",
            "a name: `--set window.keyframes=10`. They count an IMU as calibrated where `axes_sigma` is below 0.002."]
    return "\n".join(page) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(ROOT / "build" / "release" / "bin" / "lodeline"))
    parser.add_argument("--config")
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    if not Path(arguments.program).exists():
        sys.exit(f"{arguments.program}: no such program; `make build` makes it, --program names another")
    config = Path(arguments.config).read_text(encoding="utf-8") if arguments.config else config_of(arguments.program)
    stale = False
    for name, text in (("commands.md", commands_page(arguments.program)), ("settings.md", settings_page(config))):
        file = PAGES / name
        if file.exists() and file.read_text(encoding="utf-8") == text:
            continue
        stale = True
        if arguments.check:
            print(f"{file.relative_to(ROOT)}: not up to date; run scripts/generate_reference.py", file=sys.stderr)
        else:
            file.write_text(text, encoding="utf-8")
            print(f"written: {file.relative_to(ROOT)}")
    return 1 if stale and arguments.check else 0


if __name__ == "__main__":
    sys.exit(main())
