"""trajectory.png: the arena seen from above and the robot's path through it."""

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch, Polygon, Rectangle
from matplotlib.transforms import offset_copy

from . import style
from .run_folder import RunFolderError

MOST_SEGMENTS = 20_000
JUMP_M = 0.5  # longer than a way between two rows: another episode begins
GOAL = {"facecolor": "#d5efe6", "edgecolor": style.GREEN, "linestyle": (0, (4, 2))}
LANE = {"facecolor": "#e9e9e9", "edgecolor": "none"}
LAMP = {"linestyle": "none", "marker": "*", "markersize": 15, "markerfacecolor": style.YELLOW,
        "markeredgecolor": style.INK, "markeredgewidth": 1.0}
COLLISION = {"linestyle": "none", "marker": "X", "markersize": 8, "markerfacecolor": style.VERMILLION,
             "markeredgecolor": "white", "markeredgewidth": 0.8}


def draw(run, path):
    """Writes the picture; returns a list of sentences about what is missing.

    Raises RunFolderError when there is no trajectory at all.
    """
    track = run.trajectory()
    if len(track["t_s"]) == 0:
        raise RunFolderError(f"'{run.path / 'trajectory.csv'}' has no line below its header: the "
                             "robot never moved on")
    missing = []
    world = _optional(run.world, missing)
    summary = _optional(run.summary, missing)
    with style.styled():
        figure = style.new_figure(8.0, _figure_height(world or {}))
        axes = figure.subplots()
        draw_world(axes, world or {})
        lines = _draw_path(axes, track)
        collided = _draw_collisions(axes, track)
        length = 0.07 * _extent(track, world or {})
        _draw_pose(axes, track, 0, "o", "white", length)
        _draw_pose(axes, track, -1, "s", style.INK, length)
        _finish_axes(axes, track, world or {})
        axes.set_title(_title(track, summary or {}), pad=10)
        bar = figure.colorbar(lines, ax=axes, shrink=0.85, pad=0.02, aspect=35)
        bar.set_label("time (s)")
        bar.outline.set_visible(False)
        _legend(figure, axes, world or {}, collided)
        style.save(figure, path)
    return missing


def _figure_height(world):
    """In inches: 7.4 for a square arena, less or more for others."""
    arena = world.get("arena")
    if not arena:
        return 7.4
    aspect = (arena["max_y_m"] - arena["min_y_m"]) / (arena["max_x_m"] - arena["min_x_m"])
    return float(np.clip(2.4 + 5.0 * aspect, 3.5, 12.0))


def _optional(read, missing):
    try:
        return read()
    except RunFolderError as error:
        missing.append(str(error))
        return None


def draw_world(axes, world):
    """Walls, obstacles, lanes, goals and lamps of RunFolder.world(), into matplotlib axes in metres."""
    arena = world.get("arena")
    if arena:
        axes.add_patch(Rectangle((arena["min_x_m"], arena["min_y_m"]),
                                 arena["max_x_m"] - arena["min_x_m"],
                                 arena["max_y_m"] - arena["min_y_m"],
                                 facecolor="none", edgecolor=style.INK, linewidth=2.5, zorder=1))
    for obstacle in world.get("obstacles", []):
        axes.add_patch(_footprint(obstacle, facecolor=style.FILL, edgecolor=style.SOFT, zorder=2))
    for lane in world.get("lanes", []):
        axes.add_patch(_footprint(lane, **LANE, zorder=0.5))
    for goal in world.get("goals", []):
        axes.add_patch(_footprint(goal, **GOAL, zorder=1.5))
    for lamp in world.get("lamps", []):
        axes.plot(lamp["x_m"], lamp["y_m"], zorder=5.8, **LAMP)


def _footprint(obstacle, **look):
    look["linewidth"] = 1.0
    x, y = obstacle["x_m"], obstacle["y_m"]
    if obstacle["shape"] == "cylinder":
        return Circle((x, y), obstacle["radius_m"], **look)
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (obstacle["half_x_m"],
                                                                obstacle["half_y_m"])
    theta = obstacle.get("theta_rad", 0.0)
    turn = np.array([(np.cos(theta), np.sin(theta)), (-np.sin(theta), np.cos(theta))])
    return Polygon(corners @ turn + (x, y), closed=True, **look)


def _draw_path(axes, track):
    stride = max(1, len(track["t_s"]) // MOST_SEGMENTS)
    points = np.column_stack((track["x_m"], track["y_m"]))[::stride]
    times = track["t_s"][::stride]
    jumps = np.hypot(*np.diff(np.column_stack((track["x_m"], track["y_m"])), axis=0).T) > JUMP_M
    jumped = np.searchsorted(np.flatnonzero(jumps), np.arange(0, len(track["t_s"]), stride))
    points[1:][np.diff(jumped) > 0] = np.nan
    segments = np.stack((points[:-1], points[1:]), axis=1)
    lines = LineCollection(segments, cmap=style.time_map(), linewidth=2.2, capstyle="round",
                           zorder=3)
    lines.set_array(0.5 * (times[:-1] + times[1:]))
    lines.set_clim(track["t_s"][0], max(track["t_s"][-1], track["t_s"][0] + 1e-3))
    axes.add_collection(lines)
    return lines


def _draw_collisions(axes, track):
    """Marks the rows in which the count of collisions rose; False when it never did."""
    rows = np.flatnonzero(np.diff(np.nan_to_num(track["collisions"]), prepend=0.0) > 0)
    x, y = track["x_m"][rows], track["y_m"][rows]
    axes.plot(x, y, zorder=6, **COLLISION)  # smaller than the mark of the end, which it may lie on
    return len(rows) > 0


def _draw_pose(axes, track, row, marker, fill, length):
    x, y, theta = (track[name][row] for name in ("x_m", "y_m", "theta_rad"))
    tip = (x + length * np.cos(theta), y + length * np.sin(theta))
    axes.annotate("", tip, (x, y), zorder=5, annotation_clip=False,
                  arrowprops={"arrowstyle": "-|>", "color": style.INK, "linewidth": 1.6,
                              "shrinkA": 0, "shrinkB": 0, "mutation_scale": 14})
    axes.plot(x, y, marker, markersize=9, markerfacecolor=fill, markeredgecolor=style.INK,
              markeredgewidth=1.6, zorder=5.5)


def _extent(track, world):
    """Of the arena, or of the path where no arena is known, in metres."""
    arena = world.get("arena")
    if arena:
        return max(arena["max_x_m"] - arena["min_x_m"], arena["max_y_m"] - arena["min_y_m"])
    return max(np.ptp(track["x_m"]), np.ptp(track["y_m"]), 1.0)


def _finish_axes(axes, track, world):
    axes.set_aspect("equal")
    arena = world.get("arena")
    if arena:
        margin = 0.03 * _extent(track, world)
        axes.set_xlim(arena["min_x_m"] - margin, arena["max_x_m"] + margin)
        axes.set_ylim(arena["min_y_m"] - margin, arena["max_y_m"] + margin)
        for spine in axes.spines.values():
            spine.set_visible(False)
    else:
        half = 0.62 * _extent(track, world)  # a square, as an arena would be
        for limit, column in ((axes.set_xlim, "x_m"), (axes.set_ylim, "y_m")):
            middle = 0.5 * (track[column].min() + track[column].max())
            limit(middle - half, middle + half)
    axes.set_xlabel("x (m)")
    axes.set_ylabel("y (m)")


def _title(track, summary):
    steps = np.hypot(np.diff(track["x_m"]), np.diff(track["y_m"]))
    distance = summary.get("distance_m", float(steps.sum()))
    collisions = summary.get("collisions", track["collisions"][-1])
    parts = [f"{distance:.1f} m driven in {track['t_s'][-1] - track['t_s'][0]:.0f} s"]
    if "coverage" in summary:
        parts.append(f"{100 * summary['coverage']:.0f} % of the free area covered")
    if not np.isnan(collisions):
        parts.append(f"{int(collisions)} collision{'' if collisions == 1 else 's'}")
    return "  ·  ".join(parts)


def _legend(figure, axes, world, collided):
    def point(marker, fill, edge, size):
        return Line2D([], [], linestyle="none", marker=marker, markersize=size,
                      markerfacecolor=fill, markeredgecolor=edge, markeredgewidth=1.4)

    entries = [(point("o", "white", style.INK, 8), "start"),
               (point("s", style.INK, style.INK, 8), "end")]
    if world.get("obstacles"):
        entries.append((Patch(facecolor=style.FILL, edgecolor=style.SOFT), "obstacle"))
    if world.get("lanes"):
        entries.append((Patch(**LANE), "lane"))
    if world.get("goals"):
        entries.append((Patch(**GOAL), "goal"))
    if world.get("lamps"):
        entries.append((Line2D([], [], **LAMP), "lamp"))
    if collided:
        entries.append((Line2D([], [], **COLLISION), "collision"))
    below = offset_copy(axes.transAxes, fig=figure, y=-0.62, units="inches")
    axes.legend([entry[0] for entry in entries], [entry[1] for entry in entries],
                loc="upper center", bbox_to_anchor=(0.5, 0.0), bbox_transform=below,
                ncol=len(entries), columnspacing=2.0, handletextpad=0.5)
