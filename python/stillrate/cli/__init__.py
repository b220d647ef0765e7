"""The command line: one command a file, imported when it is called.

To add a command, write a module with a function ``command`` (its signature is the command's, its docstring the help)
and add a line to `COMMANDS`; likewise for the kinds of calibration and `CALIBRATIONS`.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence

from cyclopts import App, CycloptsError, Parameter

COMMANDS = {
    "allan": "Show the Allan deviation of a log and the noise figures in it.",
    "compare": "Run all methods on your own logs: gains beside their price.",
    "demo": "Clean a simulated log by several methods and show why to trust the result.",
    "export-c": "Write a configuration as C and Rust source for firmware, with a self-test.",
    "filter": "Clean a gyro log: same rows and columns, the rates filtered.",
    "fleet": "Clean a folder of logs on all cores or on a cluster; continue where it stopped.",
    "live": "Clean samples as they come, from stdin, UDP or a serial port.",
    "platform": "Compare filters in the loop of a stabilised platform, with pictures.",
    "reproduce": "Compute published figures again and print them beside ours.",
    "simulate": "Write a simulated gyro log of which the truth is known.",
    "tune": "Measure a gyro's noise in a log and write settings for filter.",
}
"""Name -> one line of help; the module is ``stillrate.cli.NAME`` (dashes become underscores)."""

CALIBRATIONS = {
    "gimbal": "Find every coefficient of a gimballed head from its commands and accelerometers.",
    "rate-table": "Fit the error of a gyro over its rate from a turntable log.",
    "reference-bias": "Find the bias of a gyro from reference attitudes in the log.",
}
"""Kind -> one line of help; the module is ``stillrate.cli.calibrate_KIND``."""


def build(words: Sequence[str] = ()) -> App:
    """Build the command line; the help of the command that `words` begin with is its docstring, the others' one line."""
    from stillrate import __version__

    app = App(
        name="stillrate",
        help="Make a gyro signal still without making it late.",
        version=f"stillrate {__version__}",
        version_flags=["--version"],
        help_format="plaintext",
        # A switch is off unless it is given: it needs no opposite and no default in the help.
        default_parameter=Parameter(negative="", show_default=_shown),
    )
    chosen = tuple(words[:2])
    _add(app, COMMANDS, "", chosen=chosen[0] if chosen else None)
    calibrate = App(name="calibrate", help="Calibrate a gyro, a gyro on a rate table, or a gimballed head.")
    _add(
        calibrate,
        CALIBRATIONS,
        "calibrate_",
        chosen=chosen[1] if len(chosen) > 1 and chosen[0] == "calibrate" else None,
    )
    app.command(calibrate)
    app.register_install_completion_command()
    return app


def _add(app: App, commands: Mapping[str, str], prefix: str, *, chosen: str | None) -> None:
    for name, summary in commands.items():
        module = f"stillrate.cli.{prefix}{name.replace('-', '_')}"
        app.command(f"{module}:command", name=name, help=_told(module) if name == chosen else summary)


def _shown(default: object) -> str | None:
    return None if default is None or default is False else str(default)


def _told(module: str) -> str:
    """Return what a command's docstring says before its parameters, a paragraph a line: the terminal breaks them."""
    import inspect
    from importlib import import_module

    told = (inspect.getdoc(import_module(module).command) or "").partition("\nParameters\n---")[0]
    return "\n\n".join(" ".join(paragraph.split()) for paragraph in told.split("\n\n") if paragraph.strip())


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Returns
    -------
    int
        0: done; 1: the data cannot be used; 2: wrong usage.
    """
    from stillrate.cli.problems import UsageError, one_line
    from stillrate.errors import ConfigError, LogError

    words = list(sys.argv[1:] if arguments is None else arguments)
    try:
        result = build(words)(
            words,
            exit_on_error=False,
            print_error=False,
            result_action="return_value",
        )
    except (UsageError, ConfigError, CycloptsError, FileExistsError) as error:
        print(f"stillrate: {one_line(error)}", file=sys.stderr)
        return 2
    except (LogError, OSError, MemoryError, EOFError) as error:
        print(f"stillrate: {one_line(error)}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("stillrate: stopped", file=sys.stderr)
        return 130
    return result if isinstance(result, int) else 0


def run() -> None:
    """Run the command line and leave with its exit code."""
    sys.exit(main())
