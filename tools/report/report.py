"""Draws the figures of `mvtp report`: success rate, makespan and runtime over the number of robots;
delay over demand and penetration, arrivals by the minute, and the time-space diagram of a movement.

Usage: report.py FIGURES.json DIR, which `mvtp report` does. Writes DIR/NAME.svg and DIR/NAME.png for
each figure, the same bytes for the same numbers. Exits with 3 if matplotlib is missing, with 4 if a
figure cannot be written.
"""

import json
import logging
import os
import sys

# What it has to say of its own files, such as its cache of fonts, does not concern the figures.
logging.getLogger("matplotlib").setLevel(logging.ERROR)

try:
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot
    from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter
except ImportError:
    sys.exit(3)

from time_space import draw_time_space

# Okabe and Ito's colours, told apart by all eyes, with markers and dashes that also tell in grey.
STYLES = {
    "escot-star": ("#D55E00", "*", "-"),
    "escot": ("#0072B2", "o", "-"),
    "pbcr": ("#E69F00", "s", "--"),
    "eccr": ("#009E73", "^", "-."),
    "cl-cbs": ("#CC79A7", "D", ":"),
    "sha": ("#333333", "v", (0, (4, 1, 1, 1, 1, 1))),
}
SPARE_STYLES = [
    ("#56B4E9", "P", "--"),
    ("#B8A800", "X", "-."),
    ("#7F7F7F", "<", ":"),
    ("#000000", ">", "-"),
]
NAMES = {
    "escot-star": "ESCoT*",
    "escot": "ESCoT",
    "pbcr": "PBCR",
    "eccr": "ECCR",
    "cl-cbs": "CL-CBS",
    "sha": "SHA*",
}


def styles_of(figure):
    """A style for each algorithm, in the order in which they come."""
    algorithms = []
    for panel in figure["panels"]:
        for line in panel["lines"]:
            if line["algorithm"] not in algorithms:
                algorithms.append(line["algorithm"])
    order = list(STYLES)
    algorithms.sort(key=lambda a: (order.index(a) if a in order else len(order), a))
    styles = {}
    spares = 0
    for algorithm in algorithms:
        if algorithm in STYLES:
            styles[algorithm] = STYLES[algorithm]
        else:
            styles[algorithm] = SPARE_STYLES[spares % len(SPARE_STYLES)]
            spares += 1
    return styles


def draw_line(axes, line, key, style, rank):
    """One algorithm's line in one panel; gaps where it has no value.

    Lines that coincide stay visible: the dashed ones come later, on top, with smaller markers.
    """
    colour, marker, dash = style
    values = [float("nan") if v is None else v for v in line[key]]
    axes.plot(
        line["robots"],
        values,
        color=colour,
        marker=marker,
        linestyle=dash,
        markersize=max(7.5 - 0.7 * rank, 4) + (2.5 if marker == "*" else 0),
        markeredgecolor="white",
        markeredgewidth=0.5,
        linewidth=1.4,
        zorder=10 + rank,
        clip_on=False,
        label=NAMES.get(line["algorithm"], line["algorithm"]),
    )


def format_seconds(value, _):
    return f"{value:g}"


def whole_numbers(most):
    return MaxNLocator(integer=True, nbins=most, steps=[1, 2, 5, 10])


def mark_time_limit(axes, time_limit, text):
    axes.axhline(time_limit, color="#888888", linewidth=0.8, linestyle=(0, (1, 2)))
    axes.annotate(
        text,
        (1, time_limit),
        xycoords=("axes fraction", "data"),
        xytext=(0, 3),
        textcoords="offset points",
        ha="right",
        fontsize=7,
        color="#666666",
    )


def set_up_axes(grid, figure, time_limit):
    """Titles, units and scales: units at the left edge, robots at the bottom."""
    rows = ("Success rate [%]", "Makespan [steps]", "Runtime [s]")
    for row, label in enumerate(rows):
        grid[row][0].set_ylabel(label)
        for column, panel in enumerate(figure["panels"]):
            axes = grid[row][column]
            axes.grid(True, color="#DDDDDD", linewidth=0.6)
            axes.set_axisbelow(True)
            for side in ("top", "right"):
                axes.spines[side].set_visible(False)
            axes.xaxis.set_major_locator(whole_numbers(7))
            axes.margins(x=0.04)
            if row == 0:
                axes.set_title(panel["map"].replace(" x ", " × "), fontsize=10)
                axes.set_ylim(0, 103)
                axes.set_yticks(range(0, 101, 25))
            if row == 1:
                axes.set_ylim(bottom=0)
                axes.yaxis.set_major_locator(whole_numbers(6))
            if row == 2:
                axes.set_yscale("log")
                axes.yaxis.set_major_locator(LogLocator(base=10, numticks=12))
                axes.yaxis.set_major_formatter(FuncFormatter(format_seconds))
                axes.yaxis.set_minor_formatter(NullFormatter())
                axes.set_xlabel("Robots")
                if time_limit is not None:
                    mark_time_limit(axes, time_limit, "time limit" if column == 0 else "")
            if row != 2:
                axes.tick_params(labelbottom=False)


def share_scales(grid):
    """The same runtimes, and the same robots in a column, stand at the same height or place."""
    limits = [axes.get_ylim() for axes in grid[2]]
    low, high = min(l for l, _ in limits), max(h for _, h in limits)
    for axes in grid[2]:
        axes.set_ylim(low, 1.5 * high)
    for column in range(len(grid[0])):
        limits = [row[column].get_xlim() for row in grid]
        for row in grid:
            row[column].set_xlim(min(l for l, _ in limits), max(h for _, h in limits))


def draw(figure, time_limit):
    columns = len(figure["panels"])
    canvas, grid = pyplot.subplots(
        3, columns, squeeze=False, figsize=(max(2.5 * columns + 0.8, 4.2), 7.0)
    )
    styles = styles_of(figure)
    for column, panel in enumerate(figure["panels"]):
        for line in panel["lines"]:
            rank = list(styles).index(line["algorithm"])
            for row, key in enumerate(("success", "makespan", "runtime")):
                draw_line(grid[row][column], line, key, styles[line["algorithm"]], rank)
    set_up_axes(grid, figure, time_limit)
    share_scales(grid)

    handles = {}
    for axes in grid[0]:
        for handle, name in zip(*axes.get_legend_handles_labels()):
            handles.setdefault(name, handle)
    order = [NAMES.get(a, a) for a in styles]
    per_row = max(1, min(len(order), 2 * columns + 1))
    legend_rows = -(-len(order) // per_row)
    canvas.tight_layout(rect=(0, 0, 1, 1 - 0.035 * legend_rows - 0.01), h_pad=1.2, w_pad=1.0)
    canvas.align_ylabels()
    canvas.legend(
        [handles[name] for name in order],
        order,
        loc="upper center",
        ncol=per_row,
        frameon=False,
        handlelength=3.2,
        columnspacing=1.6,
    )
    return canvas


def draw_sweep(figure):
    """Lines with bands of one standard deviation; a panel for each scenario or demand."""
    panels = figure["panels"]
    columns = min(len(panels), 3)
    rows = -(-len(panels) // columns)
    canvas, grid = pyplot.subplots(
        rows, columns, squeeze=False, figsize=(max(3.4 * columns + 0.6, 5.0), 3.0 * rows + 0.8)
    )
    labels = list(dict.fromkeys(line["label"] for panel in panels for line in panel["lines"]))
    cycle = list(STYLES.values()) + SPARE_STYLES
    styles = {label: cycle[i % len(cycle)] for i, label in enumerate(labels)}
    handles = {}
    for axes, panel in zip(grid.flat, panels):
        axes.set_title(panel["title"], fontsize=9)
        axes.grid(True, color="#DDDDDD", linewidth=0.6)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
        values = [y for line in panel["lines"] for y in line["y"] if y > 0]
        if figure["y"].startswith("Mean delay") and values and max(values) > 20 * min(values):
            axes.set_yscale("log")
            axes.yaxis.set_major_formatter(FuncFormatter(format_seconds))
        for line in panel["lines"]:
            colour, marker, dash = styles[line["label"]]
            low = [y - sd for y, sd in zip(line["y"], line["sd"])]
            high = [y + sd for y, sd in zip(line["y"], line["sd"])]
            axes.fill_between(line["x"], low, high, color=colour, alpha=0.15, linewidth=0)
            (handles[line["label"]],) = axes.plot(
                line["x"], line["y"], color=colour, linestyle=dash, linewidth=1.4,
                marker=marker if len(line["x"]) < 20 else None, markersize=5,
                markeredgecolor="white", markeredgewidth=0.5,
            )
        if axes.get_yscale() == "linear":
            axes.set_ylim(bottom=0)
        axes.set_xlabel(figure["x"])
    for axes in list(grid.flat)[len(panels):]:
        axes.set_visible(False)
    for row in grid:
        row[0].set_ylabel(figure["y"])
    per_row = max(2, 2 * columns)
    legend_rows = -(-len(labels) // per_row)
    canvas.tight_layout(rect=(0, 0, 1, 1 - (0.25 * legend_rows + 0.1) / canvas.get_figheight()))
    canvas.legend(
        [handles[label] for label in labels], labels, loc="upper center", ncol=per_row,
        frameon=False, handlelength=3.0, fontsize=8,
    )
    return canvas


def save(canvas, path):
    """Beside and then renamed, so that nobody sees half a figure; without date and version."""
    for kind, metadata in (
        ("svg", {"Date": None, "Creator": "mvtp"}),
        ("png", {"Software": "mvtp"}),
    ):
        beside = f"{path}.{kind}.part"
        try:
            canvas.savefig(beside, format=kind, dpi=200, metadata=metadata)
            os.replace(beside, f"{path}.{kind}")
        except OSError:
            if os.path.exists(beside):
                os.unlink(beside)
            sys.exit(4)


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        document = json.load(file)
    matplotlib.rcParams.update(
        {"svg.hashsalt": "mvtp", "font.size": 9, "axes.linewidth": 0.8, "font.family": "DejaVu Sans"}
    )
    for figure in document["figures"]:
        if "movement" in figure:
            canvas = draw_time_space(figure)
        elif "x" in figure:
            canvas = draw_sweep(figure)
        else:
            canvas = draw(figure, document["time_limit"])
        save(canvas, os.path.join(sys.argv[2], figure["name"]))
        pyplot.close(canvas)


if __name__ == "__main__":
    main()
