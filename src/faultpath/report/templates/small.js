// The small pictures: one arm on one path from above, and one plot of signals on one path.
const Small = {
  signs: { success: "✓", crash: "✕", timeout: "□" },
  told(arm, trial) {
    if (!trial) return `${arm}: did not run`;
    const parts = [`${Small.signs[trial.status] ?? "□"} ${trial.ended}`];
    if (trial.status !== "failed") parts.push(`${trial.time_s.toFixed(2)} s`);
    if (trial.hit) parts.push(trial.hit[0]);
    return `${arm}: ${parts.join(", ")}`;
  },

  // Draws one flight on a canvas; cheap enough for eight of them at every frame.
  flight(canvas, scene, trial, arm, step, bounds) {
    const box = canvas.getBoundingClientRect(), ratio = window.devicePixelRatio || 1;
    if (!box.width) return;
    canvas.width = Math.round(box.width * ratio);
    canvas.height = Math.round(box.height * ratio);
    const pen = canvas.getContext("2d"), style = getComputedStyle(document.documentElement);
    const ink = (name) => style.getPropertyValue(`--${name}`).trim();
    pen.scale(ratio, ratio);
    const { low, high } = bounds;
    const scale = Math.min((box.width - 12) / (high[0] - low[0] || 1), (box.height - 12) / (high[1] - low[1] || 1));
    const at = ([x, y]) => [box.width / 2 + (x - (low[0] + high[0]) / 2) * scale, box.height / 2 - (y - (low[1] + high[1]) / 2) * scale];
    const trail = (points) => { pen.beginPath(); points.forEach((p, i) => (i ? pen.lineTo(...at(p)) : pen.moveTo(...at(p)))); };
    if (scene.plan) {
      const hit = trial?.hit?.[1] ?? null;
      const solid = (n) => { pen.fillStyle = ink(n === hit ? "struck" : "rule"); pen.fill(); };
      scene.plan.prisms.forEach((p, n) => { trail(p.corners); pen.closePath(); solid(n); });
      scene.plan.pillars.forEach((p, n) => {
        pen.beginPath(); pen.arc(...at([p.x, p.y]), p.radius * scale, 0, 2 * Math.PI); solid(scene.plan.prisms.length + n);
      });
      pen.beginPath(); pen.arc(...at(scene.plan.goal), 0.5 * scale, 0, 2 * Math.PI);
      pen.strokeStyle = ink("ink"); pen.lineWidth = 1; pen.stroke();
      pen.beginPath(); pen.arc(...at(scene.plan.start), 2.5, 0, 2 * Math.PI); pen.fillStyle = ink("ink"); pen.fill();
    }
    if (!trial?.track) return;
    const path = Flight.path(trial), now = Math.min(step, trial.steps - 1);
    pen.strokeStyle = ink(arm); pen.lineWidth = 1.75; pen.lineJoin = "round";
    pen.setLineDash(arm === "baseline" ? [5, 3] : []);
    pen.globalAlpha = 0.3; trail(path.slice(now)); pen.stroke();
    pen.globalAlpha = 1; trail(path.slice(0, now + 1)); pen.stroke();
    pen.setLineDash([]);
    const here = path[now], wind = Flight.wind(trial, now), axes = Flight.axes(trial, now);
    const stroke = (from, to) => { pen.beginPath(); pen.moveTo(...at(from)); pen.lineTo(...at(to)); pen.stroke(); };
    const along = (direction, length) => here.map((v, i) => v + direction[i] * length);
    if (wind) { pen.strokeStyle = ink("soft"); stroke(here, along(wind, Flight.ARROW_S)); pen.strokeStyle = ink(arm); }
    if (axes) for (const l of [1, -1]) {
      const side = axes[0].map((v, i) => v + l * axes[1][i]);
      stroke(along(side, 0.25), along(side, -0.25));
    }
    const ended = step >= trial.steps - 1, [x, y] = at(here);
    if (ended) { Small.sign(pen, trial.status, [x, y], ink("wash"), ink(arm)); return; }
    pen.beginPath(); pen.arc(x, y, axes ? 2 : 3.5, 0, 2 * Math.PI); pen.fillStyle = ink(arm); pen.fill();
  },
  sign(pen, status, [x, y], halo, colour) {
    const strokes = { success: [[-4, 0], [-1, 3], [4, -4]], crash: [[-4, -4], [4, 4], null, [4, -4], [-4, 4]] }[status]
      ?? [[-4, -4], [4, -4], [4, 4], [-4, 4], [-4, -4]];
    for (const [ink, width] of [[halo, 5], [colour, 2]]) {
      pen.beginPath();
      strokes.forEach((p, i) => { if (p) (i && strokes[i - 1] ? pen.lineTo(x + p[0], y + p[1]) : pen.moveTo(x + p[0], y + p[1])); });
      pen.strokeStyle = ink; pen.lineWidth = width; pen.stroke();
    }
  },

  // The lines of one plot on one path: `[arm, line, values]`, values null where nothing was read.
  lines(pair, plot, data) {
    return Flight.flown(pair).flatMap((arm) => pair[arm].lines
      .filter(([number]) => number === plot)
      .map(([, line, place, low, level]) => ({
        arm, line, values: Array.from(data.series[place], (v) => (v < 0 ? null : low + v * level)),
      })));
  },
  // Where the goal lies on the one axis of a position that is plotted over time.
  goal(scene, plot, data) {
    return data.space === "line" && data.plots[plot].title === "position" ? (scene.plan?.goal[0] ?? null) : null;
  },
  range(scene, plot, data) {
    const goal = Small.goal(scene, plot, data);
    let [low, high] = goal === null ? [Infinity, -Infinity] : [goal, goal];
    for (const pair of scene.pairs) {
      for (const { values } of Small.lines(pair, plot, data)) {
        for (const v of values) if (v !== null) { low = Math.min(low, v); high = Math.max(high, v); }
      }
    }
    if (low > high || (low === 0 && high === 0)) return null;
    if (data.plots[plot].zero) [low, high] = [Math.min(low, 0), Math.max(high, 0)];
    const margin = (high - low || Math.abs(high) || 1) * 0.05;
    return [low - margin, high + margin];
  },
  number(v, span) {
    const digits = Math.min(6, Math.max(0, Math.ceil(1.3 - Math.log10(span))));
    return v.toFixed(digits).replace("-", "−");
  },

  // Plots the lines of a path over the one clock, with the spans in which a fault was in force.
  // Where there are none, or all are zero, nothing is drawn.
  plot(host, title, pair, step, scene, plot, range, data) {
    const lines = Small.lines(pair, plot, data);
    host.hidden = !lines.some(({ values }) => values.some((v) => v));
    if (host.hidden) return;
    const { svg, w, h } = Draw.svg(host, title);
    const last = Flight.last(scene), left = 52, right = w - 16, under = h - 20;
    const x = (i) => left + (i / last) * (right - left), y = (v) => under - ((v - range[0]) / (range[1] - range[0])) * (under - 8);
    for (const arm of Flight.flown(pair)) {
      for (const [from, to] of pair[arm].struck) {
        Draw.node(svg, "rect", { x: x(from), y: 8, width: Math.max(1, x(Math.min(to, last)) - x(from)), height: under - 8, class: "v-window" });
      }
    }
    for (const v of range) {
      Draw.node(svg, "line", { x1: left, x2: right, y1: y(v), y2: y(v), class: "v-line" });
      const inside = Math.min(under - 1, Math.max(16, y(v) + 4));
      Draw.node(svg, "text", { x: left - 5, y: inside, "text-anchor": "end", class: "v-text soft" }, Small.number(v, range[1] - range[0]));
    }
    Draw.times(svg, last, data.dt_s, x, h - 5);
    if (data.plots[plot].zero) Draw.node(svg, "line", { x1: left, x2: right, y1: y(0), y2: y(0), class: "v-line" });
    const goal = Small.goal(scene, plot, data);
    if (goal !== null) {
      Draw.node(svg, "line", { x1: left, x2: right, y1: y(goal), y2: y(goal), class: "v-goal" });
      Draw.node(svg, "text", { x: left + 5, y: y(goal) + (y(goal) < 26 ? 14 : -5), class: "v-text" }, "goal");
    }
    for (const { arm, line, values } of lines) {
      const points = values.flatMap((v, i) => (v === null ? [] : [`${x(i).toFixed(1)},${y(v).toFixed(1)}`]));
      Draw.node(svg, "polyline", { points: points.join(" "), class: `v-signal ${arm} line-${Math.min(line, 3)}` });
    }
    Draw.node(svg, "line", { x1: x(Math.min(step, last)), x2: x(Math.min(step, last)), y1: 8, y2: under, class: "v-now" });
  },
};
