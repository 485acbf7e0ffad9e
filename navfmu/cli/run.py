"""``navfmu run``: one experiment."""

from __future__ import annotations

from typing import Any

import click

from navfmu.cli.options import load, system_options, tell


@click.command("run")
@system_options
@click.option("--step", metavar="TIME", help="Communication step size: seconds, or a text such as '10 ms'.")
@click.option("--algorithm", default="gauss_seidel", show_default=True, metavar="A", help="gauss_seidel or jacobi.")
@click.option("--engine", default="compiled", show_default=True, metavar="E", help="compiled or reference.")
@click.option("--record", "signals", multiple=True, metavar="SIGNAL",
              help="Signal, array, bundle or pattern to record; may be repeated or a list with commas.")  # fmt: skip
@click.option("--record-period", metavar="TIME", help="Time between recorded values.")
@click.option("--out", metavar="FILE", help="Write the recording to FILE.parquet or FILE.csv.")
@click.option("--stmd", metavar="FILE.stmd", help="Write what was run and what came of it as SSP Traceability has it.")
@click.option("--report", metavar="DIR", help="Write the recording and a report with pictures into this folder.")
def command(
    system: str, out: str | None, report: str | None, stmd: str | None, expect: str | None, **given: Any
) -> None:
    """Run SYSTEM: an .ssp, an .ssd, a folder, an .fmu, or a shipped system by its name."""
    from navfmu.system import result
    from navfmu.system.results_folder import check_results
    from navfmu.terminal.progress import Progress

    target = None if out is None else result.check_target(out)
    folder = None if report is None else check_results(report, "a run", "report.html", "recording.parquet")
    task = None if stmd is None else result.check_file(stmd, ".stmd")
    loaded, given = load(system, given)
    if folder is not None:
        from navfmu.system.run_report import to_record, write_report

        named, given["record"] = given["record"], to_record(given["record"], loaded)
    experiment = loaded.experiment(**given)
    if expect is not None:
        experiment.expect(expect)
    with Progress(loaded.name) as progress:
        frame = experiment.run(progress)
    tell(frame.attrs["notes"])
    if target is not None:
        result.write(frame, target)
    report = None  # written before anything is printed: whoever reads that may close the pipe
    if folder is not None:
        report = write_report(frame, experiment, folder, loaded.signals(named) if named else ())
    if task is not None:
        from navfmu.system.traceability import write_task

        results = [file for file in (target, report and report.with_name("recording.parquet"), report) if file]
        write_task(frame, experiment, results, task)
    from navfmu.cli.summary import summarise

    summarise(frame, loaded, out)
    if task is not None:
        click.echo(f"traceability: {task}")
    if report is not None:
        click.echo(f"report: {report}")
