// The connection to the server: words in JSON, numbers in binary; the newest position wins.

import { known, tell } from "./store.js";

const page = Math.random().toString(36).slice(2);
const sent = new Map(); // number of a position -> when the pointer was there, when it was sent
/** Of the last positions, ms, for measurements: number, pointed, painted; then sent, answered, drawn, and what the server took. */
export const log = [];
const LONGEST_LOG = 4000;

let socket = null;
let number = 0;
let acknowledged = 0, reached = 0; // newest number of this page that the words hold, that a picture's numbers hold
let waiting = []; // what was asked for while the server was away, in its order
let attempts = 0;
const MOST_WAITING = 500;

export function connect() {
  const address = `ws://${location.host}/live`;
  socket = new WebSocket(address);
  socket.binaryType = "arraybuffer";
  socket.onopen = () => {
    if (attempts > 0) acknowledged = reached = number; // what was not answered never will be
    tell("connected", attempts > 0);
    attempts = 0;
    const late = waiting;
    waiting = [];
    late.forEach(send);
  };
  socket.onclose = () => {
    tell("disconnected");
    attempts += 1;
    setTimeout(connect, Math.min(300 * attempts, 3000));
  };
  socket.onmessage = (event) => {
    if (typeof event.data === "string") {
      const message = JSON.parse(event.data);
      if (isMine(message.of)) acknowledged = Math.max(acknowledged, message.of.number);
      tell(message.type, message);
    } else {
      const message = unpacked(event.data);
      message.at = performance.now();
      if (message.head.type === "frame") reached = Math.max(reached, acknowledged, isMine(message.head) ? message.head.number : 0);
      tell(message.head.type, message);
    }
  };
}

function unpacked(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  const arrays = {};
  let start = 4 + length;
  for (const [name, size] of head.arrays) {
    arrays[name] = new Float32Array(buffer, start, size);
    start += 4 * size;
  }
  return { head, arrays };
}

function send(message) {
  if (socket?.readyState === WebSocket.OPEN) { socket.send(JSON.stringify(message)); return true; }
  return false;
}

/** As if the connection had broken, for tests: the page must come back by itself. */
export const drop = () => socket.close();

/** Asks for something by its name. All but positions that is asked for while the server is away is sent when it is back. */
export function ask(op, words = {}) {
  number += 1;
  const message = { op, number, page, ...words };
  if (!send(message) && op !== "move" && waiting.length < MOST_WAITING) waiting.push(message);
  return number;
}

/** A position of the hand; `pointed` is when the pointer was there. Its number comes back. */
export function move(words, pointed) {
  const mine = ask("move", words);
  const now = performance.now();
  sent.set(mine, [pointed ?? now, now]);
  if (sent.size > 500) sent.delete(sent.keys().next().value);
  return mine;
}

export const isMine = (head) => head?.page === page;

/** Whether the motor in words holds what was asked for under a number, or why it was refused. */
export const isAcknowledged = (asked) => asked <= acknowledged;

/** Where the hand has put something: that until the server's numbers hold it, then what they say. */
export function standing() {
  let mine = null, asked = 0;
  return {
    put(value, number) { mine = value; asked = number; },
    or: (theirs) => (asked > reached ? mine : theirs),
  };
}

/** Notes that the picture of a position is painted; `frame` says when it came and was drawn. */
export function painted({ head, at, drawn }) {
  if (!isMine(head) || !sent.has(head.number)) return;
  const [pointed, left] = sent.get(head.number);
  log.push([head.number, pointed, performance.now(), left, at, drawn, head.took]);
  if (log.length > LONGEST_LOG) log.splice(0, log.length - LONGEST_LOG);
  for (const each of sent.keys()) if (each <= head.number) sent.delete(each);
}

export const answered = () => log.length;
