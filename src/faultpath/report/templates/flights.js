// Trials as `viewer_packing.py` packed them, and how they are drawn: from above, and over time.
const Unpacking = {
  async read(packed) {
    const bytes = Uint8Array.from(atob(packed), (c) => c.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    const plain = new Uint8Array(await new Response(stream).arrayBuffer());
    const end = 4 + new DataView(plain.buffer).getUint32(0, true);
    const data = JSON.parse(new TextDecoder().decode(plain.subarray(4, end)));
    data.series = Unpacking.series(plain.subarray(end), data.lengths);
    return data;
  },
  // Sums second differences up twice, in whole numbers of 32 bits.
  series(planes, lengths) {
    const n = planes.length / 4, values = new Int32Array(n);
    for (let i = 0; i < n; i += 1) {
      values[i] = planes[i] | (planes[n + i] << 8) | (planes[2 * n + i] << 16) | (planes[3 * n + i] << 24);
    }
    let from = 0;
    return lengths.map((length) => {
      const part = values.subarray(from, (from += length));
      let step = 0, value = 0;
      for (let i = 0; i < length; i += 1) {
        step = (step + part[i]) | 0;
        value = (value + step) | 0;
        part[i] = value;
      }
      return part;
    });
  },
};

const Flight = {
  arms: ["baseline", "repair"],
  ARROW_S: 0.25,  // an arrow of the wind is its way in this time
  // Lays the series of a scene's trials out for drawing.
  open(scene, data) {
    if (scene.opened) return scene;
    const rows = (place, count) => (place === null ? null : data.series.slice(place, place + count));
    for (const pair of scene.pairs) {
      for (const arm of Flight.flown(pair)) {
        const trial = pair[arm];
        trial.track = rows(trial.track, 3);
        trial.attitude = rows(trial.attitude, 9);
        trial.wind = rows(trial.wind, 3);
        trial.steps = trial.track ? trial.track[0].length : Math.ceil(trial.time_s / data.dt_s - 1e-6) + 1;
      }
    }
    scene.plan = data.plans[scene.scene] ?? null;
    scene.opened = true;
    return scene;
  },
  flown(pair) { return Flight.arms.filter((arm) => pair[arm]); },
  drawn(pair) { return Flight.arms.filter((arm) => pair[arm]?.track); },
  point(trial, step) {
    const i = Math.min(step, trial.steps - 1);
    return trial.track.map((axis) => axis[i] / 100);
  },
  at(rows, step, scale) { return rows ? rows.map((row) => row[Math.min(step, row.length - 1)] / scale) : null; },
  // The body's axes in the world, forward, left and up; null where the attitude is not known.
  axes(trial, step) {
    const r = Flight.at(trial.attitude, step, 1000);
    return r && [0, 1, 2].map((i) => [r[i], r[3 + i], r[6 + i]]);
  },
  wind(trial, step) { return Flight.at(trial.wind, step, 100); },
  last(scene) {
    return Math.max(1, ...scene.pairs.flatMap((pair) => Flight.flown(pair).map((arm) => pair[arm].steps - 1)));
  },
  bounds(plan, pairs) {
    const low = plan ? [...plan.low] : [Infinity, Infinity, Infinity];
    const high = plan ? [...plan.high] : [-Infinity, -Infinity, -Infinity];
    for (const pair of pairs) {
      for (const arm of Flight.drawn(pair)) {
        pair[arm].track.forEach((axis, i) => {
          for (const v of axis) { low[i] = Math.min(low[i], v / 100); high[i] = Math.max(high[i], v / 100); }
        });
      }
    }
    return { low, high };
  },
  signs: { success: "✓", crash: "✕", timeout: "□" },
  told(arm, trial) {
    if (!trial) return `${arm}: did not run`;
    const parts = [`${Flight.signs[trial.status] ?? "□"} ${trial.ended}`];
    if (trial.status !== "failed") parts.push(`${trial.time_s.toFixed(2)} s`);
    if (trial.hit) parts.push(`hit ${trial.hit[0]}`);
    return `${arm}: ${parts.join(", ")}`;
  },
};

const Draw = {
  node(parent, tag, attributes, text) {
    const node = document.createElementNS("http://www.w3.org/2000/svg", tag);
    for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
    if (text !== undefined) node.textContent = text;
    parent.append(node);
    return node;
  },
  svg(host, title) {
    const w = Math.max(host.clientWidth, 80), h = Math.max(host.clientHeight, 60);
    host.replaceChildren();
    return { svg: Draw.node(host, "svg", { viewBox: `0 0 ${w} ${h}`, role: "img", "aria-label": title }), w, h };
  },

  // The trials of a pair from above; a `large` picture has labels, a scale and where the two part.
  plan(host, title, scene, pair, step, data, large) {
    const { svg, w, h } = Draw.svg(host, title);
    const { low, high } = Flight.bounds(scene.plan, scene.pairs), edge = large ? 28 : 12;
    const scale = Math.min((w - edge) / (high[0] - low[0] || 1), (h - edge) / (high[1] - low[1] || 1));
    const at = ([x, y]) => [w / 2 + (x - (low[0] + high[0]) / 2) * scale, h / 2 - (y - (low[1] + high[1]) / 2) * scale];
    const join = (points) => points.map((p) => at(p).map((v) => v.toFixed(1)).join(",")).join(" ");
    const label = (text, [x, y]) => {
      const side = x > w - 110 ? { x: x - 9, "text-anchor": "end" } : { x: x + 9 };
      if (large) Draw.node(svg, "text", { ...side, y: Math.max(14, y - 8), class: "v-text" }, text);
    };
    if (scene.plan) {
      const { plan } = scene, [x0, y0] = plan.low, [x1, y1] = plan.high;
      const hits = Flight.flown(pair).map((arm) => pair[arm].hit?.[1] ?? null);
      const look = (n) => (hits.includes(n) ? "v-block v-hit" : "v-block");
      Draw.node(svg, "polygon", { points: join([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]), class: "v-ground" });
      plan.prisms.forEach((p, n) => Draw.node(svg, "polygon", { points: join(p.corners), class: look(n) }));
      plan.pillars.forEach((p, n) => {
        const [cx, cy] = at([p.x, p.y]);
        Draw.node(svg, "circle", { cx, cy, r: p.radius * scale, class: look(plan.prisms.length + n) });
      });
      const [sx, sy] = at(plan.start), [gx, gy] = at(plan.goal);
      Draw.node(svg, "circle", { cx: gx, cy: gy, r: 0.5 * scale, class: "v-mark", "fill-opacity": 0 });
      Draw.node(svg, "circle", { cx: sx, cy: sy, r: large ? 4 : 2.5, class: "v-solid" });
      label("start", [sx, sy]);
      label("goal", [gx, gy - 0.5 * scale]);
    }
    for (const arm of Flight.drawn(pair)) {
      const path = Array.from({ length: pair[arm].steps }, (_, i) => Flight.point(pair[arm], i));
      const now = Math.min(step, path.length - 1);
      Draw.node(svg, "polyline", { points: join(path.slice(now)), class: `v-track rest ${arm}` });
      Draw.node(svg, "polyline", { points: join(path.slice(0, now + 1)), class: `v-track ${arm}` });
      Draw.end(svg, pair[arm].status, arm, at(path[path.length - 1]));
      Draw.vehicle(svg, pair[arm], arm, step, at);
    }
    if (!large) return;
    if (pair.parting_step !== null) {
      const [x, y] = at(Flight.point(pair.repair, pair.parting_step));
      Draw.node(svg, "rect", { x: x - 4, y: y - 4, width: 8, height: 8, class: "v-mark" });
      label(`part at ${(pair.parting_step * data.dt_s).toFixed(2)} s`, [x, y]);
    }
    const metres = [0.5, 1, 2, 5, 10, 20, 50, 100].find((m) => m * scale > 40) ?? 200;
    Draw.node(svg, "path", { d: `M12 ${h - 14}v4h${metres * scale}v-4`, class: "v-mark", "fill-opacity": 0 });
    Draw.node(svg, "text", { x: 18, y: h - 16, class: "v-text soft" }, `${metres} m`);
  },
  // How a trial ended: a tick for success, a cross for a crash, an open square for a timeout.
  end(svg, status, arm, [x, y]) {
    const shape = {
      success: `M${x - 5} ${y}l4 4 7 -9`,
      crash: `M${x - 5} ${y - 5}l10 10m0 -10l-10 10`,
    }[status] ?? `M${x - 4.5} ${y - 4.5}h9v9h-9z`;
    Draw.node(svg, "path", { d: shape, class: "v-cross halo" });
    Draw.node(svg, "path", { d: shape, class: `v-cross ${arm}` });
  },
  // A dot, with its arms where the attitude is known, and the arrow of the wind where that is.
  vehicle(svg, trial, arm, step, at) {
    const here = Flight.point(trial, step), [cx, cy] = at(here);
    const wind = Flight.wind(trial, step), axes = Flight.axes(trial, step);
    const along = (direction, length) => at(here.map((v, i) => v + direction[i] * length));
    if (wind) {
      const [x, y] = along(wind, Flight.ARROW_S), turn = Math.atan2(y - cy, x - cx);
      const head = [2.6, -2.6].map((bend) => `M${x} ${y}l${7 * Math.cos(turn + bend)} ${7 * Math.sin(turn + bend)}`);
      Draw.node(svg, "path", { d: `M${cx} ${cy}L${x} ${y}${head.join("")}`, class: "v-wind" });
    }
    if (step >= trial.steps - 1) return;
    if (axes) {
      const tips = [[1, 1], [1, -1], [-1, -1], [-1, 1]].map(([f, l]) => along(axes[0].map((v, i) => f * v + l * axes[1][i]), 0.22));
      Draw.node(svg, "path", { d: `M${tips[0]}L${tips[2]}M${tips[1]}L${tips[3]}M${[cx, cy]}L${along(axes[0], 0.45)}`, class: `v-body ${arm}` });
    }
    Draw.node(svg, "circle", { cx, cy, r: axes ? 3 : 5, class: `v-dot ${arm}` });
  },

  // Lines `{ arm, line, values }` over the clock of a scene, values null where nothing was read.
  lines(host, title, lines, range, { last, dt, step, spans = [], level = null, name = "" }) {
    const { svg, w, h } = Draw.svg(host, title);
    const left = 52, right = w - 24, under = h - 20;
    const x = (i) => left + (Math.min(i, last) / last) * (right - left);
    const y = (v) => under - ((v - range[0]) / (range[1] - range[0])) * (under - 8);
    for (const [from, to] of spans) {
      Draw.node(svg, "rect", { x: x(from), y: 8, width: Math.max(1, x(to) - x(from)), height: under - 8, class: "v-window" });
    }
    const digits = Math.min(6, Math.max(0, Math.ceil(1.3 - Math.log10(range[1] - range[0]))));
    for (const v of range) {
      Draw.node(svg, "line", { x1: left, x2: right, y1: y(v), y2: y(v), class: "v-line" });
      const inside = Math.min(under - 1, Math.max(16, y(v) + 4));
      Draw.node(svg, "text", { x: left - 5, y: inside, "text-anchor": "end", class: "v-text soft" }, v.toFixed(digits).replace("-", "−"));
    }
    const every = [0.5, 1, 2, 5, 10, 20, 50].find((s) => x(s / dt) - x(0) > 44) ?? 100;
    for (let t = 0; t <= last * dt + 1e-9; t += every) {
      Draw.node(svg, "text", { x: x(t / dt), y: h - 5, "text-anchor": "middle", class: "v-text soft" }, `${t} s`);
    }
    if (level !== null) {
      Draw.node(svg, "line", { x1: left, x2: right, y1: y(level), y2: y(level), class: name ? "v-goal" : "v-line" });
      Draw.node(svg, "text", { x: left + 5, y: y(level) + (y(level) < 26 ? 14 : -5), class: "v-text" }, name);
    }
    for (const { arm, line, values } of lines) {
      const points = values.flatMap((v, i) => (v === null ? [] : [`${x(i).toFixed(1)},${y(v).toFixed(1)}`]));
      Draw.node(svg, "polyline", { points: points.join(" "), class: `v-signal ${arm} line-${Math.min(line, 3)}` });
    }
    Draw.node(svg, "line", { x1: x(step), x2: x(step), y1: 8, y2: under, class: "v-now" });
  },
};

// The signals of a scene, and the axis that all paths share.
const Signals = {
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
    const goal = Signals.goal(scene, plot, data);
    let [low, high] = goal === null ? [Infinity, -Infinity] : [goal, goal];
    for (const { values } of scene.pairs.flatMap((pair) => Signals.lines(pair, plot, data))) {
      for (const v of values) if (v !== null) { low = Math.min(low, v); high = Math.max(high, v); }
    }
    if (low > high || (low === 0 && high === 0)) return null;
    if (data.plots[plot].zero) [low, high] = [Math.min(low, 0), Math.max(high, 0)];
    const margin = (high - low || Math.abs(high) || 1) * 0.05;
    return [low - margin, high + margin];
  },
};
