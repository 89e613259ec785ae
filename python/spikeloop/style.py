"""The look of every picture: one size of type, few colours, all told apart by the colour-blind."""

import os

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import ListedColormap, to_rgb
from matplotlib.figure import Figure

from .whole_file import create

# Okabe & Ito's palette, which stays distinct with every kind of colour vision.
BLUE = "#0072B2"
VERMILLION = "#D55E00"
GREEN = "#009E73"
PURPLE = "#CC79A7"
SKY = "#56B4E9"
ORANGE = "#E69F00"
YELLOW = "#F0E442"
GROUPS = (BLUE, VERMILLION, GREEN, PURPLE, SKY, ORANGE)
INK = "#222222"
SOFT = "#6b6b6b"
FILL = "#d9d9d9"
NO_VALUE = "#ececec"
VALUE_MAP = "cividis"
DPI = 160
PRINT_DPI = 300  # of the parts of a PDF or SVG that are images

SETTINGS = {
    "font.family": "DejaVu Sans",
    "font.size": 11,
    "axes.titlesize": 12,
    "axes.labelsize": 11,
    "xtick.labelsize": 10,
    "ytick.labelsize": 10,
    "legend.fontsize": 10,
    "legend.frameon": False,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.8,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "xtick.direction": "out",
    "ytick.direction": "out",
    "lines.linewidth": 1.2,
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
    "pdf.fonttype": 42,  # TrueType: text that journals accept and editors can change
}


def styled():
    """A context in which figures have the common look."""
    return matplotlib.rc_context(SETTINGS)


def new_figure(width_in, height_in):
    """A figure that needs no display and leaves no global state."""
    figure = Figure(figsize=(width_in, height_in), dpi=DPI, layout="constrained")
    figure.get_layout_engine().set(w_pad=0.12, h_pad=0.08)
    FigureCanvasAgg(figure)
    return figure


def save(figure, path):
    """Writes the file. `figure` is from new_figure() and is not drawn again."""
    dpi = DPI if str(path).endswith(".png") else PRINT_DPI
    figure.set_dpi(dpi)
    # savefig() draws a figure that has a layout twice, the first time only to place its parts.
    figure.get_layout_engine().execute(figure)
    figure.set_layout_engine(None)
    with create(path) as file:
        figure.savefig(file, dpi=dpi, format=os.path.splitext(path)[1][1:])


def legend_beside(axes, handles=None):
    """A legend to the right of the axes, where it covers nothing."""
    axes.legend(handles=handles, loc="center left", bbox_to_anchor=(1.0, 0.5), borderaxespad=0.3,
                handlelength=1.2, handletextpad=0.5)


def group_colours(count):
    """As many colours; they repeat after six."""
    return [GROUPS[i % len(GROUPS)] for i in range(count)]


def rgb(colour):
    """Red, green and blue from 0 to 1."""
    return to_rgb(colour)


def value_map():
    """Colours of a signal's values; places without a value are light grey."""
    colours = matplotlib.colormaps[VALUE_MAP].copy()
    colours.set_bad(NO_VALUE)
    return colours


def time_map():
    """Colours of time, without the end that is too pale to see on white."""
    return ListedColormap(matplotlib.colormaps["viridis"](np.linspace(0.0, 0.92, 256)))
