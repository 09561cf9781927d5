// Light, dark, or as the system has it; pictures ask here for their colours.

import { known, tell } from "./store.js";

const NEAR = 0.02; // of a limit's own scale
const KEY = "camring-theme";
const system = matchMedia("(prefers-color-scheme: dark)");
let colours = new Map();

export function theme() { return localStorage.getItem(KEY) ?? "auto"; }

export function setTheme(name) {
  localStorage.setItem(KEY, name);
  apply();
}

function apply() {
  const name = theme();
  const dark = name === "dark" || (name === "auto" && system.matches);
  document.documentElement.dataset.theme = dark ? "dark" : "light";
  colours = new Map();
  tell("theme");
}

/** A colour of the style sheet by its name. */
export function colour(name) {
  if (!colours.has(name)) {
    colours.set(name, getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim());
  }
  return colours.get(name);
}

export function fontSize() { return parseFloat(getComputedStyle(document.documentElement).fontSize); }
export const isDark = () => document.documentElement.dataset.theme === "dark";

/** Red, green, blue of the map of an envelope: a share of what is shown, or a limit's `g`. */
export function shade(share) {
  const from = isDark() ? [29, 44, 60] : [238, 243, 249], to = isDark() ? [46, 108, 165] : [122, 166, 214];
  const part = Math.min(1, Math.max(0, share));
  return from.map((each, k) => each + part * (to[k] - each));
}

export function marginColour(g) {
  if (g > 0) return isDark() ? [90, 42, 44] : [243, 207, 205];
  if (-g < NEAR) return isDark() ? [87, 68, 28] : [248, 230, 185];
  return shade(0.15 + 0.55 * Math.min(1, -g / 0.4));
}

// What a design is held against is dashed; in a moving picture, where dashes take most of the time, it is a hairline.
export const beforeDash = () => (known.held ? [] : [6, 3]);
export const beforeWidth = (width) => (known.held ? Math.min(0.8, 0.5 * width) : Math.min(1.5, width));

system.addEventListener("change", apply);
apply();
