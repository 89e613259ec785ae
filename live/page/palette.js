// Colours of the page: those of `spikeloop plot`, and lighter ones of the same hue on a dark page.

import { keep, kept } from "./choices.js";

const LIGHT = {
  groups: ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00"],
  ink: "#222222", soft: "#6b6b6b", grid: "#e6e6e6", axis: "#8c8c8c", fill: "#d9d9d9", plot: "#ffffff",
  wall: "#222222", wallTop: "#c6cacf", goal: "#d5efe6", goalEdge: "#009E73", lamp: "#F0E442", beam: "#E69F00",
  path: "#0072B2", hit: "#D55E00", none: "#ececec",
};
const DARK = {
  groups: ["#4FB0EA", "#F58A3C", "#2BC49A", "#E39BC4", "#9AD4F5", "#F2BC45"],
  ink: "#e8e8e6", soft: "#a0a3a8", grid: "#2d3138", axis: "#7b8088", fill: "#4a4f57", plot: "#16191d",
  wall: "#d0d2d4", wallTop: "#666c75", goal: "#173d33", goalEdge: "#2BC49A", lamp: "#F0E442", beam: "#F2BC45",
  path: "#4FB0EA", hit: "#F58A3C", none: "#2a2e34",
};

// Stops of matplotlib's cividis, the map of `spikeloop plot`.
const CIVIDIS = [
  [0, 34, 78], [0, 48, 111], [53, 69, 108], [87, 93, 109], [112, 113, 115], [138, 134, 120], [165, 156, 116],
  [195, 179, 105], [225, 204, 85], [253, 231, 55],
];

const preferred = matchMedia("(prefers-color-scheme: dark)");
const listeners = [];
let chosen = null;

export const palette = { ...LIGHT, dark: false };

/// `listener` is called when the colours have changed.
export function onTheme(listener) {
  listeners.push(listener);
}

/// Changes between dark and light; the choice stays in this browser.
export function switchTheme() {
  chosen = palette.dark ? "light" : "dark";
  keep("theme", chosen);
  apply();
}

export function startTheme() {
  chosen = kept("theme");
  preferred.addEventListener("change", apply);
  apply();
}

function apply() {
  const dark = chosen ? chosen === "dark" : preferred.matches;
  Object.assign(palette, dark ? DARK : LIGHT, { dark });
  document.documentElement.dataset.theme = dark ? "dark" : "light";
  listeners.forEach((listener) => listener());
}

export function groupColour(number) {
  return palette.groups[number % palette.groups.length];
}

export function rgb(hex) {
  return [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
}

/// The colour with a part of its light: 0 is black.
export function shade(hex, part) {
  return `rgb(${rgb(hex).map((each) => Math.round(part * each)).join(", ")})`;
}

/// 256 colours (little-endian RGBA) of one hue, from transparent to full.
export function alphaTable(hex) {
  const [red, green, blue] = rgb(hex);
  const table = new Uint32Array(256);
  for (let i = 1; i < 256; ++i) {
    const alpha = Math.round(36 + (219 * i) / 255);  // a single spike stays visible
    table[i] = (alpha << 24 | blue << 16 | green << 8 | red) >>> 0;
  }
  return table;
}

/// 256 colours (little-endian RGBA) for values.
export const VALUE_TABLE = Uint32Array.from({ length: 256 }, (_, i) => {
  const place = (i / 255) * (CIVIDIS.length - 1), low = Math.min(CIVIDIS.length - 2, Math.floor(place));
  const [red, green, blue] = CIVIDIS[low].map((from, k) =>
    Math.round(from + (place - low) * (CIVIDIS[low + 1][k] - from)));
  return (255 << 24 | blue << 16 | green << 8 | red) >>> 0;
});
