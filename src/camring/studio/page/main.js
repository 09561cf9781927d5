// The page's beginning: parts are made, messages find them, frames are painted.

import "./theme.js";
import { makeAnalysis } from "./analysis.js";
import { makeCamPanel } from "./cam.js";
import { makeCommands } from "./commands.js";
import { byId, say } from "./dom.js";
import { makeEnvelope } from "./envelope.js";
import { makeFields } from "./fields.js";
import { makeHeadline } from "./headline.js";
import { answered, ask, connect, drop, log, painted } from "./link.js";
import { makeMargins } from "./margins.js";
import { makePlots } from "./plots.js";
import { makeSection } from "./section.js";
import { known, on, tell } from "./store.js";
import { makeStudy } from "./study.js";

const parts = [
  makeHeadline(), makeMargins(), makeCamPanel(), makeSection(), ...makePlots(), makeEnvelope(),
];
makeFields();
makeCommands();
makeStudy();
makeAnalysis();

const veil = byId("veil");
const AWAY = 700; // ms after which a silent server is reported; a shorter break nobody needs to see
let scheduled = false, stale = false, waitingFor = 0, away = 0, noted = "";

on("loading", (message) => { veil.hidden = false; veil.firstElementChild.textContent = message.sentence; });
on("disconnected", () => {
  away ||= setTimeout(() => {
    veil.hidden = false;
    veil.firstElementChild.textContent =
      "The server does not answer; this page tries again by itself. If it has ended, start it with the same command and open the address that it prints: what was kept is there.";
  }, AWAY);
});
on("connected", (again) => {
  clearTimeout(away);
  away = 0;
  if (!again) return;
  if (known.now) veil.hidden = true;
  say("Connected again.");
});
on("choices", (message) => { known.choices = message; tell("files known"); });
on("files", (message) => { known.choices = { ...known.choices, ...message, type: "choices" }; tell("files known"); });
on("model", (message) => {
  const first = known.model === null;
  const other = first || known.model.file !== message.file || known.model.cam.count !== message.cam.count;
  known.model = message;
  if (other) { known.now = null; known.before = null; known.envelope = { coarse: null, fine: null, before: null }; }
  if (known.envelope.coarse) known.envelope.fine = null;
  known.arrows = null;
  tell("described", { first, other });
  if (first) {
    clearTimeout(waitingFor);
    waitingFor = setTimeout(() => {
      veil.firstElementChild.textContent =
        "Compiling the simulation for this number of pistons and lobes. This is done once and kept; it takes up to a minute.";
    }, 2500);
  }
  if (message.note && message.note !== noted) say(message.note, 12);
  noted = message.note;
});
on("frame", (message) => {
  clearTimeout(waitingFor);
  veil.hidden = true;
  known.now = message;
  known.envelope.stale = true;
  schedule();
});
on("before", (message) => { known.before = message; schedule(); });
on("no before", () => { known.before = null; known.envelope.before = null; schedule(); });
on("envelope", (message) => {
  known.envelope[message.head.grid] = message;
  if (message.head.grid === "coarse") known.envelope.fine = null;
  schedule();
});
on("before envelope", (message) => { known.envelope.before = message; schedule(); });
// Those that come before any numbers of this file are of another's.
on("arrows", (message) => { if (!known.model || !known.now) return; known.arrows = message; tell("slopes"); schedule(); });
on("trouble", (message) => say(message.head.sentence));
on("error", (message) => {
  if (message.of?.op === "commit" && message.of.set) tell("refused", message);
  else say(message.sentence, 10);
});
on("theme", schedule);

/** The first news after a picture is drawn while the browser waits for its next one, what follows in it. */
function schedule() {
  stale = scheduled;
  if (scheduled) return;
  scheduled = true;
  draw();
  requestAnimationFrame(paint);
}

function draw() {
  if (!shown()) return;
  for (const each of parts) {
    try { each.draw(); } catch (error) { console.error(error); }
  }
  known.now.drawn ??= performance.now();
}

/** Whether there is anything to draw, and of this file. */
const shown = () => known.model !== null && known.now !== null && known.now.arrays.limits.length === known.model.limits.length;

function paint() {
  if (stale) draw();
  scheduled = stale = false;
  const frame = known.now;
  if (!shown() || frame.noted) return;
  frame.noted = true;
  // The task after the one that paints: what was drawn is on its way to the screen.
  const channel = new MessageChannel();
  channel.port1.onmessage = () => painted(frame);
  channel.port2.postMessage(null);
}

window.camringStudio = { known, log, answered, ask, drop, parts };
connect();
