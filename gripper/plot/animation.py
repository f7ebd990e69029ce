"""A motion as a film: the finger over the object, to scale, and the force as it goes."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from numpy.typing import NDArray

from gripper.plot.curve import curve
from gripper.plot.draw import Key, draw, frame
from gripper.plot.layout import Legend, Row, arrange
from gripper.plot.panel import Panel
from gripper.plot.sketch import Axis, union
from gripper.plot.style import INCH, INK, Picture, styled
from gripper.plot.units import parameter_unit
from gripper.result import Result
from gripper.scene import Scene

if TYPE_CHECKING:
    from PIL import Image as Images

Pixels = NDArray[np.uint8]
Progress = Callable[[int, int], None]
WIDTH = 0.12
"""Width on which a film is laid out, in m: its type is legible at two thirds of that."""
_HOLD = 0.8
"""How long the last pose stays, in s."""
_FASTEST, _SLOWEST = 25.0, 4.0
"""Frames a second."""
_SAMPLED = 8
"""Frames from which the colours of a GIF are chosen."""


def animate(
    result: Result,
    path: str | os.PathLike[str],
    *,
    seconds: float = 5.0,
    pixels: int = 720,
    mirror: Axis | None = None,
    progress: Progress | None = None,
) -> Path:
    """Write a motion as a film, a frame a pose: .gif always, .mp4 where ffmpeg is found.

    Parameters
    ----------
    result
        A motion; at most 25 of its poses a second are shown, evenly chosen. One without an answer shows no finger.
    path
        The file to write; its ending decides the kind.
    seconds
        How long it lasts, about.
    pixels
        Its width.
    mirror
        An axis of the object's symmetry beyond which a second finger is drawn, as ``gripper.plot.filmstrip``.
    progress
        Called with the number of frames done and to do.

    Returns
    -------
    The path.

    Raises
    ------
    ValueError
        A scene without motion, an ending that is neither, .mp4 without ffmpeg, no pose with an answer, or a time or
        size that is not positive.
    """
    path = Path(path)
    check_film(result.scene, path, seconds, pixels)
    write = _write_gif if path.suffix.lower() == ".gif" else _write_mp4
    chosen = _chosen(len(result.poses), seconds)
    rate = round(min(max(len(chosen) / seconds, _SLOWEST), _FASTEST))
    with styled():
        film = _Film(result, chosen, mirror, pixels)
        draft = path.with_name(f".{path.stem}.{os.getpid()}{path.suffix}")
        try:
            write(draft, film, rate, progress or (lambda done, total: None))
            draft.replace(path)
        finally:
            draft.unlink(missing_ok=True)
    return path


def check_film(scene: Scene, path: Path, seconds: float, pixels: int) -> None:
    """Check what :func:`animate` is given, before anything is solved; it raises the same errors."""
    ending = path.suffix.lower()
    if ending not in (".gif", ".mp4"):
        raise ValueError(f"path must end in .gif or .mp4; got {str(path)!r}")
    if ending == ".mp4" and shutil.which("ffmpeg") is None:
        raise ValueError(f"path must end in .gif, for ffmpeg, which writes .mp4, is not on the PATH; got {str(path)!r}")
    if scene.motion is None:
        raise ValueError("result must hold a motion, of several poses, for a film; got one pose without motion")
    if not seconds > 0:
        raise ValueError(f"seconds must be a positive number, in s; got {seconds!r}")
    if not pixels >= 100:
        raise ValueError(f"pixels must be at least 100; got {pixels!r}")


def _chosen(poses: int, seconds: float) -> list[int]:
    most = max(2, int(seconds * _FASTEST))
    return sorted({round(i) for i in np.linspace(0, poses - 1, min(poses, most)).tolist()})


class _Film:
    """A figure that shows one pose after the other: what moves is drawn over what stays, so that nothing trembles."""

    def __init__(self, result: Result, chosen: list[int], mirror: Axis | None, pixels: int) -> None:
        self.result, self.chosen = result, chosen
        self.unit = parameter_unit(result.scene)
        self.panels = {i: Panel.of(result, i, mirror=mirror) for i in chosen}
        answered = [panel for panel in self.panels.values() if panel.fingers]
        if not answered:
            raise ValueError("result must hold at least one pose that has an answer; got none")
        self.key = Key.of([panel.fingers for panel in answered])
        self.window = union([panel.extent(self.key) for panel in answered])
        self._lay_out(pixels)
        self.canvas = _canvas(self.figure)
        self.canvas.draw()
        self.stays = self.canvas.copy_from_bbox(self.figure.bbox)

    def _lay_out(self, pixels: int) -> None:
        inches = WIDTH / INCH
        left, bottom, right, top = self.window
        aspect = (top - bottom) / (right - left)
        self.figure = Picture(figsize=(inches, inches), dpi=pixels / inches)
        self.scene, self.curve = (self.figure.add_axes((0.1, 0.1, 0.8, 0.4), label=name) for name in ("scene", "curve"))
        frame(self.scene, self.window, self.key)
        self.scene.set_title("free")
        curve(self.result, ax=self.curve)
        rows = [Row([self.scene], aspect), Row([self.curve], inches=1.2)]
        arrange(self.figure, rows, self.result.title, Legend(self.figure, self.key, 0.94 * inches))
        height = 2 * round(self.figure.get_figheight() * self.figure.dpi / 2)  # MP4 wants even numbers of pixels
        self.figure.set_size_inches((pixels // 2 * 2 + 0.01) / self.figure.dpi, (height + 0.01) / self.figure.dpi)
        start = self.unit.factor * (self.result.poses[0].parameter or 0.0)
        self.cursor = self.curve.axvline(start, color=INK, linewidth=1.0, animated=True)
        self.scene.title.set_animated(True)

    def rendered(self, i: int) -> Pixels:
        """Give the picture of pose i: (height, width, 3)."""
        panel = self.panels[i]
        moves = [artist for each in panel.fingers for artist in draw(self.scene, each, self.key)]
        self.scene.set_title(panel.caption(self.key), parse_math=False)
        self.cursor.set_xdata([self.unit.factor * (panel.pose.parameter or 0.0)] * 2)
        self.canvas.restore_region(self.stays)
        for artist in sorted(moves, key=lambda each: each.get_zorder()):
            self.scene.draw_artist(artist)
        self.scene.draw_artist(self.scene.title)
        self.curve.draw_artist(self.cursor)
        for artist in moves:
            artist.remove()
        return np.array(self.canvas.buffer_rgba())[..., :3]

    def frames(self, progress: Progress) -> Iterator[Pixels]:
        """Give the picture of every chosen pose."""
        for done, i in enumerate(self.chosen, start=1):
            yield self.rendered(i)
            progress(done, len(self.chosen))


def _canvas(figure: Picture) -> Any:
    """Give a canvas, whose methods carry no types."""
    return FigureCanvasAgg(figure)


def _write_mp4(path: Path, film: _Film, rate: int, progress: Progress) -> None:
    height, width, _ = film.rendered(film.chosen[0]).shape
    given = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", str(rate), "-i", "-"]
    wanted = ["-pix_fmt", "yuv420p", "-crf", "18", str(path)]
    command = ["ffmpeg", "-y", "-loglevel", "error", *given, *wanted]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as encoder:
        assert encoder.stdin is not None
        with suppress(BrokenPipeError):  # ffmpeg gave up, and says below why
            for picture in film.frames(progress):
                encoder.stdin.write(picture.tobytes())
            for _ in range(round(_HOLD * rate)):
                encoder.stdin.write(picture.tobytes())
        _, said = encoder.communicate()
    if encoder.returncode:
        raise OSError(f"ffmpeg could not write {path.name}: {said.decode(errors='replace').strip()}")


def _write_gif(path: Path, film: _Film, rate: int, progress: Progress) -> None:
    """Write all frames in one set of colours, without dithering, which would tremble and not compress."""
    from PIL import Image

    steps = max(1, len(film.chosen) // _SAMPLED)
    colours = _colours([film.rendered(i) for i in film.chosen[::steps]])
    reduced = (
        Image.fromarray(picture).quantize(palette=colours, dither=Image.Dither.NONE)
        for picture in film.frames(progress)
    )
    lasting = [round(1e3 / rate)] * len(film.chosen)
    lasting[-1] += round(1e3 * _HOLD)
    first = next(reduced)
    with path.open("wb") as file:
        first.save(file, "GIF", save_all=True, append_images=reduced, duration=lasting, loop=0, optimize=False)


def _colours(samples: list[Pixels]) -> Images.Image:
    """Choose 256 colours that suit all these, white itself among them."""
    from PIL import Image

    chosen = Image.fromarray(np.concatenate(samples)).quantize(256, method=Image.Quantize.MAXCOVERAGE)
    colours = np.array(chosen.getpalette()).reshape(-1, 3)
    colours[colours.sum(axis=1).argmax()] = 255
    chosen.putpalette(colours.ravel().tolist())
    return chosen
