"""The time-space diagram of a movement, for report.py: a panel for each run, below each other with
one time axis, so that the same vehicles are at the same place in all of them."""

from matplotlib import pyplot
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

# Okabe and Ito's colours: (name in the legend, colour, width, dashes).
DRIVERS = {
    "controlled": ("under control", "#0072B2", 1.1, "-"),
    "sumo": ("automated, driven by SUMO", "#56B4E9", 1.1, (0, (3, 1.2))),
    "human": ("human-driven", "#E69F00", 1.1, "-"),
}
OTHERS = ("other movements, same lane", "#B5B5B5", 0.6, "-")
LIGHTS = {"g": "#009E73", "y": "#F0C000", "r": "#D00000", "u": "#D00000", "s": "#009E73"}
LIGHT_NAMES = {"#009E73": "green", "#F0C000": "yellow", "#D00000": "red"}
ZONE = "#EAF2F8"
JUNCTION = "#D9D9D9"


def draw_road(axes, figure, panel):
    """What does not change over time: bands and lines across the panel."""
    for low, high in panel["zones"]:
        axes.axhspan(low, high, color=ZONE, linewidth=0, zorder=0)
        for edge in (low, high):
            axes.axhline(edge, color="#0072B2", linewidth=0.6, linestyle=(0, (4, 3)), zorder=1)
    for low, high in figure["junctions"]:
        axes.axhspan(low, high, color=JUNCTION, linewidth=0, zorder=1)
    for station in figure["stop_lines"]:
        axes.axhline(station, color="black", linewidth=0.8, zorder=2)


def draw_lines(axes, lines, style, order):
    if not lines:
        return
    _, colour, width, dashes = style
    points = [list(zip(line["x"], line["y"])) for line in lines]
    axes.add_collection(
        LineCollection(points, colors=colour, linewidths=width, linestyles=[dashes], zorder=order)
    )


def draw_signals(axes, panel):
    """A bar along each stop line with a light. @return the colours shown."""
    colours = []
    for signal in panel["signals"]:
        for shown in signal["shown"]:
            colour = LIGHTS.get(shown["light"])
            if colour is None:
                continue
            low, high = shown["time"]
            axes.plot([low, high], [signal["y"]] * 2, color=colour, linewidth=3.2,
                      solid_capstyle="butt", zorder=20)
            colours.append(colour)
    return colours


def legend_of(figure, colours):
    """What there is to see, and nothing else."""
    handles = []
    panels = figure["panels"]
    for driver, (name, colour, width, dashes) in DRIVERS.items():
        if any(line["driver"] == driver for panel in panels for line in panel["lines"]):
            handles.append(Line2D([], [], color=colour, linewidth=width, linestyle=dashes, label=name))
    if any(panel["others"] for panel in panels):
        name, colour, width, dashes = OTHERS
        handles.append(Line2D([], [], color=colour, linewidth=width, linestyle=dashes, label=name))
    if any(panel["zones"] for panel in panels):
        handles.append(Patch(facecolor=ZONE, edgecolor="#0072B2", linewidth=0.6,
                             linestyle=(0, (4, 3)), label="control zone"))
    if figure["junctions"]:
        handles.append(Patch(facecolor=JUNCTION, label="junction"))
    if figure["stop_lines"]:
        handles.append(Line2D([], [], color="black", linewidth=0.8, label="stop line"))
    for colour, name in LIGHT_NAMES.items():
        if colour in colours:
            handles.append(Line2D([], [], color=colour, linewidth=3.2, label=name))
    return handles


def draw_time_space(figure):
    panels = figure["panels"]
    canvas, grid = pyplot.subplots(
        len(panels), 1, squeeze=False, sharex=True, figsize=(7.2, 2.7 * len(panels) + 0.9)
    )
    colours = set()
    for (axes,), panel in zip(grid, panels):
        draw_road(axes, figure, panel)
        draw_lines(axes, panel["others"], OTHERS, 5)
        for driver, style in DRIVERS.items():
            draw_lines(axes, [l for l in panel["lines"] if l["driver"] == driver], style, 10)
        colours.update(draw_signals(axes, panel))
        axes.set_xlim(*figure["time"])
        axes.set_ylim(0, figure["length"])
        axes.set_title(panel["title"], fontsize=9, loc="left")
        axes.set_ylabel("Distance [m]")
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    grid[-1][0].set_xlabel("Time [s]")
    handles = legend_of(figure, colours)
    per_row = 4
    rows = -(-len(handles) // per_row)
    height = canvas.get_figheight()
    canvas.tight_layout(rect=(0, 0, 1, 1 - (0.19 * rows + 0.32) / height))
    canvas.text(0.5, 1 - 0.08 / height, "Movement " + figure["movement"].replace(">", " → "),
                fontsize=10, ha="center", va="top")
    canvas.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, 1 - 0.24 / height),
                  ncol=min(per_row, len(handles)), frameon=False, fontsize=8, handlelength=2.4)
    return canvas
