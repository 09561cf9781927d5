"use strict";
// The page reads without this script; it adds reading values off the curves,
// choosing an operating point, turning the machine and picking designs.
(function () {
  document.documentElement.classList.add("scripted");
  const each = (selector, act, root) => (root || document).querySelectorAll(selector).forEach(act);
  const made = (name, attributes) => {
    const node = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const key in attributes) node.setAttribute(key, attributes[key]);
    return node;
  };
  // As many decimals as the drawn curve can vouch for: a 5000th of the axis.
  const shown = (value, axis) => {
    const digits = axis.log ? 0 : Math.floor(-Math.log10(axis.span / 5000));
    const text = axis.log ? value.toPrecision(3) : value.toFixed(Math.min(Math.max(digits, 0), 9));
    return text.replace("-", "−");
  };

  // Operating points: one at a time on the screen, all of them on paper.
  const buttons = Array.from(document.querySelectorAll(".operating-points button"));
  function choose(point) {
    buttons.forEach((b) => b.setAttribute("aria-pressed", String(b.dataset.operatingPoint === point)));
    each(".operating-point", (block) => { block.hidden = block.dataset.operatingPoint !== point; });
    document.dispatchEvent(new CustomEvent("operating-point", { detail: point }));
  }
  buttons.forEach((b) => b.addEventListener("click", () => choose(b.dataset.operatingPoint)));

  // Reading a chart: the curves' own paths are the data.
  function axis(text) {
    const [start, end, low, high, kind] = text.split(" ").map((v, k) => (k < 4 ? Number(v) : v));
    const log = kind === "log";
    return {
      start, end, log, span: high - low,
      value(paper) {
        const part = (paper - start) / (end - start);
        return log ? low * Math.pow(high / low, part) : low + part * (high - low);
      },
    };
  }
  function curve(path) {
    return path.getAttribute("d").split("M").filter(Boolean).map((piece) =>
      piece.split("L").map((pair) => pair.split(" ").map(Number)));
  }
  function heightAt(pieces, x) {
    for (const piece of pieces) {
      let low = 0, high = piece.length - 1;
      if (x < piece[0][0] || x > piece[high][0]) continue;
      while (high - low > 1) {
        const middle = (low + high) >> 1;
        if (piece[middle][0] <= x) low = middle; else high = middle;
      }
      const [a, b] = piece[low], [c, d] = piece[high];
      return c > a ? b + (d - b) * (x - a) / (c - a) : d;
    }
    return NaN;
  }
  each("svg.readable", (svg) => {
    const box = document.createElement("div");
    box.className = "readout";
    box.setAttribute("role", "status");
    svg.parentNode.appendChild(box);
    const across = axis(svg.dataset.x), up = axis(svg.dataset.y);
    let curves = null, place = null;
    const line = made("line", { class: "cursor", visibility: "hidden" });
    const spots = made("g", {});
    svg.append(line, spots);
    function hide() {
      place = null;
      line.setAttribute("visibility", "hidden");
      spots.replaceChildren();
      box.replaceChildren();
    }
    function show(x) {
      curves = curves || Array.from(svg.querySelectorAll("path.curve")).map((path) => (
        { label: path.dataset.label, colour: path.getAttribute("stroke"), pieces: curve(path) }));
      place = Math.min(Math.max(x, across.start), across.end);
      const rows = [[svg.dataset.xLabel, shown(across.value(place), across), svg.dataset.xUnit]];
      spots.replaceChildren();
      for (const one of curves) {
        const y = heightAt(one.pieces, place);
        if (!isFinite(y)) continue;
        spots.append(made("circle", { class: "spot", cx: place, cy: y, r: 3.5, stroke: one.colour }));
        rows.push([one.label, shown(up.value(y), up), svg.dataset.yUnit]);
      }
      for (const [key, value] of [["x1", place], ["x2", place], ["y1", up.end], ["y2", up.start]])
        line.setAttribute(key, value);
      line.setAttribute("visibility", "visible");
      box.replaceChildren(...rows.map(([label, value, unit]) => {
        const row = document.createElement("div");
        row.textContent = `${label}: ${value} ${unit}`;
        return row;
      }));
      const scale = svg.getBoundingClientRect().width / svg.viewBox.baseVal.width;
      const right = place * scale + 12 + box.offsetWidth > svg.getBoundingClientRect().width;
      box.style.left = `${Math.max(0, right ? place * scale - 12 - box.offsetWidth : place * scale + 12)}px`;
    }
    svg.addEventListener("pointermove", (event) => {
      const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(
        svg.getScreenCTM().inverse());
      if (point.x < across.start - 4 || point.x > across.end + 4) hide(); else show(point.x);
    });
    svg.addEventListener("pointerleave", hide);
    svg.addEventListener("blur", hide);
    svg.addEventListener("keydown", (event) => {
      const step = (across.end - across.start) / (event.shiftKey ? 20 : 200);
      const now = place === null ? (across.start + across.end) / 2 : place;
      const moves = { ArrowLeft: now - step, ArrowRight: now + step, Home: across.start, End: across.end };
      if (event.key === "Escape") hide();
      else if (event.key in moves) { show(moves[event.key]); event.preventDefault(); }
    });
  });

  // Cells to read: with the pointer, or with the arrow keys once the picture has the focus.
  each("svg.chart:has(.cell)", (svg) => {
    const box = document.createElement("div");
    box.className = "readout";
    box.setAttribute("role", "status");
    svg.parentNode.appendChild(box);
    svg.setAttribute("tabindex", "0");
    const cells = Array.from(svg.querySelectorAll(".cell[data-words]"), (node) => {
      const at = node.querySelector("rect").getBBox();
      return { node, x: at.x + at.width / 2, y: at.y + at.height / 2 };
    });
    let now = null;
    function show(cell) {
      if (now) now.node.classList.remove("read");
      now = cell;
      box.replaceChildren(...(cell ? cell.node.dataset.words.split("\n") : []).map((text) => {
        const row = document.createElement("div");
        row.textContent = text;
        return row;
      }));
      if (!cell) return;
      cell.node.classList.add("read");
      const seen = svg.getBoundingClientRect(), scale = seen.width / svg.viewBox.baseVal.width;
      const left = cell.x * scale + 24, right = left + box.offsetWidth > seen.width;
      box.style.left = `${Math.max(0, right ? left - 48 - box.offsetWidth : left)}px`;
    }
    // The nearest cell on one side; steps across count little against the way asked for.
    function beside(dx, dy) {
      let best = null, least = Infinity;
      for (const cell of cells) {
        const x = cell.x - now.x, y = cell.y - now.y, along = x * dx + y * dy;
        const off = Math.abs(x * dy) + Math.abs(y * dx), far = along + 10 * off;
        if (along > 1 && far < least) { best = cell; least = far; }
      }
      return best || now;
    }
    svg.addEventListener("pointermove", (event) => {
      const node = event.target.closest(".cell[data-words]");
      show(node ? cells.find((cell) => cell.node === node) : null);
    });
    svg.addEventListener("pointerleave", () => show(null));
    svg.addEventListener("blur", () => show(null));
    svg.addEventListener("keydown", (event) => {
      const ways = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
      if (event.key === "Escape") show(null);
      else if (event.key in ways) {
        show(now ? beside(...ways[event.key]) : cells[0] || null);
        event.preventDefault();
      }
    });
  });

  // Designs to choose.
  const chosen = document.getElementById("pareto-chosen");
  each("svg .design", (spot) => {
    function pick() {
      each("svg .design.picked", (old) => old.classList.remove("picked"));
      spot.classList.add("picked");
      const table = document.createElement("table");
      table.className = "narrow";
      for (const [name, value] of JSON.parse(spot.dataset.rows)) {
        const row = table.insertRow();
        const head = document.createElement("th");
        head.scope = "row";
        head.textContent = name;
        row.append(head);
        const cell = row.insertCell();
        cell.className = "n";
        cell.textContent = value;
      }
      chosen.replaceChildren(table);
    }
    spot.addEventListener("click", pick);
    spot.addEventListener("keydown", (event) => {
      if (event.key === "Enter" || event.key === " ") { pick(); event.preventDefault(); }
    });
  });

  // The machine: the drawing stands at angle zero; these tables turn it.
  function fill(stops, share) {
    const s = Math.min(Math.max(share, 0), 1);
    for (let k = 1; k < stops.length; k++) {
      if (s > stops[k][0]) continue;
      const [a, start] = stops[k - 1], [b, end] = stops[k], part = (s - a) / (b - a);
      return `rgb(${start.map((c, i) => Math.round(c + part * (end[i] - c))).join(",")})`;
    }
    return "";
  }
  function turned(svg) {
    const t = JSON.parse(svg.dataset.machine), n = t.radius.length;
    const units = Array.from(svg.querySelectorAll(".unit")).map((unit) => ({
      unit, chamber: unit.querySelector(".chamber"), slide: unit.querySelector(".slide"),
      force: unit.querySelector(".force") }));
    const at = (values, turns) => {
      const place = (((turns * t.repeats) % 1) + 1) % 1 * n, k = Math.floor(place) % n;
      return values[k] + (place - Math.floor(place)) * (values[(k + 1) % n] - values[k]);
    };
    const small = 0.5 / (n * t.repeats);
    return (degrees) => {
      units.forEach((one, k) => {
        const turns = degrees / 360 + k / t.pistons, radius = at(t.radius, turns);
        const slope = (at(t.radius, turns + small) - at(t.radius, turns - small)) /
          (4 * Math.PI * small);
        const lean = Math.atan2(slope, radius), force = at(t.force, turns) / 1000;
        one.unit.setAttribute("transform", `rotate(${(-360 * turns).toFixed(3)})`);
        one.slide.setAttribute("transform", `translate(${radius.toFixed(2)} 0)`);
        one.chamber.setAttribute("width", Math.max(radius - t.skirt - t.floor, 0).toFixed(2));
        one.chamber.setAttribute("fill", fill(t.stops, at(t.pressure, turns) / 1000));
        const near = t.roller + 3, far = t.roller + 5 + t.arrow * Math.max(force, 0);
        for (const [key, length, turn] of [["x1", far, Math.cos], ["y1", far, Math.sin],
          ["x2", near, Math.cos], ["y2", near, Math.sin]])
          one.force.setAttribute(key, (length * turn(lean)).toFixed(2));
        one.force.setAttribute("visibility", force > 0.02 ? "visible" : "hidden");
      });
      return at(t.torque, degrees / 360);
    };
  }
  each(".machine", (machine) => {
    const labels = JSON.parse(machine.dataset.labels);
    const slider = machine.querySelector("input"), output = machine.querySelector("output");
    const play = machine.querySelector(".play");
    let sections = null, last = null, angle = 0;
    function show() {
      sections = sections || Array.from(machine.querySelectorAll("svg.section")).map(turned);
      const torques = sections.map((turn) => turn(angle));
      const parts = torques.map((torque, k) =>
        (labels.length > 1 ? labels[k] + " " : "torque ") + torque.toFixed(0) + " N·m");
      output.textContent = `${angle.toFixed(1)} deg · ${parts.join(" · ")}`;
      slider.value = angle;
    }
    function stop() { last = null; play.textContent = "▶ Turn"; }
    function step(now) {
      if (last === null) return;
      // One lobe passes in four seconds, whatever the speed of the real shaft.
      angle = (angle + (now - last) * 0.09 / Number(machine.dataset.lobes)) % 360;
      last = now;
      show();
      requestAnimationFrame(step);
    }
    play.addEventListener("click", () => {
      if (last !== null) { stop(); return; }
      play.textContent = "❚❚ Stop";
      last = performance.now();
      requestAnimationFrame(step);
    });
    slider.addEventListener("input", () => { stop(); angle = Number(slider.value); show(); });
    document.addEventListener("operating-point", () => { if (last !== null) stop(); });
    show();
  });

  if (buttons.length) choose(buttons[0].dataset.operatingPoint);
})();
