"""Robustness: many scenes, judged by what shares no code with the solver; solved, refused with a reason, or wrong."""

from __future__ import annotations

import csv
import math
import signal
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any, Literal

from gripper.result import Result
from gripper.study import oracles
from gripper.study.cases import Case, maps, random
from gripper.trace import trace

LONGEST = 60.0
"""CPU seconds after which a scene counts as refused."""
_STEP = 0.01
_POSES = (0.0, 0.3, 0.65, 1.0 - _STEP, 1.0 - _STEP / 2, 1.0)
_HALVED = (0.0, 0.15, 0.3, 0.475, 0.65, 0.82, 1.0)
_DESCENTS = 2  # every other random scene is descended to as well, where a coarse chain can
Verdict = Literal["solved", "refused", "wrong"]
Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class Judged:
    """One scene and its verdict.

    Parameters
    ----------
    family, name
        Which scene.
    built
        Whether it was built to have an equilibrium.
    verdict, why
        solved, refused or wrong; the reason or the objection.
    force
        On the object at the end, over EI / L^2 at the clamp; None where refused.
    seconds
        CPU time with its judges.
    """

    family: str
    name: str
    built: bool
    verdict: Verdict
    why: str
    force: float | None
    seconds: float

    @property
    def key(self) -> str:
        """As `Case.key`."""
        return f"{self.family}: {self.name}"


class TooLongError(Exception):
    """A scene took longer than LONGEST."""


def judge(case: Case, *, descend: bool = False) -> Judged:
    """Solve a scene and ask every judge."""
    began = time.process_time()
    try:
        with _limited(LONGEST):
            result = trace(case.moving(_POSES))
            verdict, why = _verdict(case, result, descend)
        force = _force(case, result) if verdict == "solved" else None
    except TooLongError:
        verdict, why, force = "refused", f"no answer in {LONGEST:g} s of CPU", None
    except Exception as error:  # a scene within the rules must end in a result: anything else is wrong, and told
        verdict, why, force = "wrong", f"raised {type(error).__name__}: {error}", None
    return Judged(case.family, case.name, case.built, verdict, why, force, time.process_time() - began)


def _verdict(case: Case, result: Result, descend: bool) -> tuple[Verdict, str]:
    last = result.poses[-1]
    if last.status == "failed":
        return "refused", last.reason or ""
    objections: list[str | None] = [
        oracles.overlap(case, pose, q) for pose, q in zip(result.poses, _POSES, strict=True)
    ]
    objections.append(oracles.undecided(case, result))
    if not any(1.0 - _STEP <= event.parameter for event in result.events):
        objections.append(oracles.energy_slope(result.poses[-3:], _STEP))
    halved = trace(case.moving(_HALVED)).poses[-1]
    objections.append(oracles.other_steps(last, halved))
    if descend:
        objections.append(oracles.descent(case, result))
    told = [objection for objection in objections if objection]
    if told:
        return "wrong", "; ".join(dict.fromkeys(told))
    if halved.status == "failed":
        return "refused", f"with other steps: {halved.reason}"
    return "solved", ""


def _force(case: Case, result: Result) -> float | None:
    """The force by EI / L^2: what neither E nor L may change."""
    force, kept = result.poses[-1].force_on_object, result.poses[-1].kept
    return None if force is None or kept is None else math.hypot(*force) / kept.setting.sections.force_scale


@contextmanager
def _limited(seconds: float) -> Iterator[None]:
    """Raise TooLongError after this much CPU time, where the system can."""
    if not hasattr(signal, "setitimer"):
        yield
        return

    def stop(*_: Any) -> None:
        raise TooLongError

    before = signal.signal(signal.SIGVTALRM, stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        signal.signal(signal.SIGVTALRM, before)


def scenes(count: int, seed: int = 0, *, quick: bool = False) -> list[Case]:
    """The maps, every sixth scene of them where it must be quick, and this many random scenes."""
    lines = list(maps())
    return [*(lines[::6] if quick else lines), *random(count, seed)]


def study(cases: Iterable[Case], record: Path, progress: Progress | None = None) -> list[Judged]:
    """Judge scenes, one line of a CSV file each; those that are in the file already are not solved again.

    Parameters
    ----------
    cases
        The scenes.
    record
        The file; a run that was interrupted goes on where it stopped.
    progress
        Called after each scene with the number done and their total.
    """
    wanted, known = list(cases), {judged.key: judged for judged in read(record)}
    names = [field.name for field in fields(Judged)]
    if not record.exists():
        record.write_text(",".join(names) + "\n")
    found = []
    with record.open("a", newline="") as file:
        writer = csv.DictWriter(file, names, lineterminator="\n")
        for done, case in enumerate(wanted, start=1):
            if case.key not in known:
                random_scene = case.family == "random"
                known[case.key] = judge(case, descend=random_scene and int(case.name.split("/")[1]) % _DESCENTS == 0)
                writer.writerow(asdict(known[case.key]))
                file.flush()
            found.append(known[case.key])
            if progress is not None:
                progress(done, len(wanted))
    return found


def read(record: Path) -> list[Judged]:
    """The scenes of a record; none where there is no file."""
    if not record.exists():
        return []
    with record.open(newline="") as file:
        return [
            Judged(
                family=row["family"],
                name=row["name"],
                built=row["built"] == "True",
                verdict=row["verdict"],  # type: ignore[arg-type]  # as it was written
                why=row["why"],
                force=float(row["force"]) if row["force"] else None,
                seconds=float(row["seconds"]),
            )
            for row in csv.DictReader(file)
        ]


def unlike(found: Iterable[Judged]) -> float:
    """Largest relative difference of the dimensionless forces of the scenes that differ in E and L alone."""
    forces = [judged.force for judged in found if judged.family == "scale" and judged.force]
    return (max(forces) - min(forces)) / max(forces) if forces else 0.0


def summary(found: list[Judged]) -> str:
    """A Markdown table a family, the totals, and what so many scenes without a wrong one prove."""
    lines = ["| map | scenes | solved | refused | wrong |", "|---|---|---|---|---|"]
    for family in dict.fromkeys(judged.family for judged in found):
        counts = Counter(judged.verdict for judged in found if judged.family == family)
        lines.append(f"| {family} | {counts.total()} | {counts['solved']} | {counts['refused']} | {counts['wrong']} |")
    built = [judged for judged in found if judged.built]
    solved = sum(judged.verdict == "solved" for judged in built)
    wrong = sum(judged.verdict == "wrong" for judged in found)
    text = [f"{solved} of {len(built)} scenes built to have an equilibrium are solved"]
    if built:
        text[0] += f" ({100 * solved / len(built):.2f} %)"
    bound = 1 - 0.05 ** (1 / len(found)) if found else 1.0
    text.append(
        f"wrong: none in {len(found)}: below {100 * bound:.2g} % of such scenes, with 95 % confidence"
        if not wrong
        else f"wrong: {wrong} of {len(found)}"
    )
    text.append(f"E from 1 to 1e15 Pa and L from 1e-9 to 1e3 m change the dimensionless force by {unlike(found):.0e}")
    reasons = Counter(f"{judged.verdict}: {judged.why}"[:110] for judged in found if judged.verdict != "solved")
    return "\n".join([*lines, "", *text, *(f"{n} x {why}" for why, n in reasons.most_common())])
