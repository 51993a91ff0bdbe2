// What is drawn of flights as SVG: the view from above and the strip of heights.
const Flight = {
  arms: ["baseline", "repair"],
  // Lays the series of a scene's trials out for drawing; `data` is what Unpacking gave.
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
  path(trial) { return Array.from({ length: trial.steps }, (_, i) => Flight.point(trial, i)); },
  at(rows, step, scale) {
    return rows ? rows.map((row) => row[Math.min(step, row.length - 1)] / scale) : null;
  },
  // The body's axes in the world, forward, left and up; null where the attitude is not known.
  axes(trial, step) {
    const r = Flight.at(trial.attitude, step, 1000);
    return r && [0, 1, 2].map((i) => [r[i], r[3 + i], r[6 + i]]);
  },
  wind(trial, step) { return Flight.at(trial.wind, step, 100); },
  last(scene) {
    return Math.max(1, ...scene.pairs.flatMap((pair) => Flight.flown(pair).map((arm) => pair[arm].steps - 1)));
  },
  bounds(scene) {
    const low = scene.plan ? [...scene.plan.low] : [Infinity, Infinity, Infinity];
    const high = scene.plan ? [...scene.plan.high] : [-Infinity, -Infinity, -Infinity];
    for (const pair of scene.pairs) {
      for (const arm of Flight.drawn(pair)) {
        pair[arm].track.forEach((axis, i) => {
          for (const v of axis) { low[i] = Math.min(low[i], v / 100); high[i] = Math.max(high[i], v / 100); }
        });
      }
    }
    return { low, high };
  },
  hits(pair) { return Flight.flown(pair).map((arm) => pair[arm].hit?.[1] ?? null).filter((n) => n !== null); },
  // How long an arrow of the wind is drawn: the way of a quarter of a second.
  ARROW_S: 0.25,
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
    const svg = Draw.node(host, "svg", { viewBox: `0 0 ${w} ${h}`, role: "img", "aria-label": title });
    return { svg, w, h };
  },
  // How a flight ended: a tick for success, a cross for a crash, an open square for a timeout.
  end(svg, status, arm, [x, y]) {
    const shape = {
      success: `M${x - 5} ${y}l4 4 7 -9`,
      crash: `M${x - 5} ${y - 5}l10 10m0 -10l-10 10`,
    }[status] ?? `M${x - 4.5} ${y - 4.5}h9v9h-9z`;
    Draw.node(svg, "path", { d: shape, class: "v-cross halo" });
    Draw.node(svg, "path", { d: shape, class: `v-cross ${arm}` });
  },
  // Puts a label at the first of eight places around a point where it hits nothing.
  labeller(svg, w, h, avoid) {
    const taken = avoid.map(([x, y]) => [x - 3, y - 3, x + 3, y + 3]);
    return (text, [x, y], cls = "") => {
      const room = text.length * 6.4 + 4;
      const spots = [[9, 4], [-room / 2, -10], [-room / 2, 20], [9, -8], [9, 18], [-9 - room, 4], [-9 - room, -8], [-9 - room, 18]];
      const box = ([dx, dy]) => [x + dx, y + dy - 12, x + dx + room, y + dy + 4];
      const free = (b) => b[0] > 2 && b[2] < w - 2 && b[1] > 2 && b[3] < h - 2
        && !taken.some((t) => b[0] < t[2] && t[0] < b[2] && b[1] < t[3] && t[1] < b[3]);
      const spot = spots.find((s) => free(box(s))) ?? spots[0];
      taken.push(box(spot));
      Draw.node(svg, "text", { x: x + spot[0], y: y + spot[1], class: `v-text ${cls}` }, text);
    };
  },
  // The marks of time below an axis; `x` turns steps into pixels.
  times(svg, last, dt, x, y) {
    const every = [0.5, 1, 2, 5, 10, 20, 50].find((s) => x(s / dt) - x(0) > 44) ?? 100;
    for (let t = 0; t <= last * dt + 1e-9; t += every) {
      Draw.node(svg, "text", { x: x(t / dt), y, "text-anchor": "middle", class: "v-text soft" }, `${t} s`);
    }
  },
};

function drawPlan(host, scene, pair, step, data) {
  const { svg, w, h } = Draw.svg(host, `Flights in ${scene.scene} from above`);
  const { low, high } = Flight.bounds(scene);
  const scale = Math.min((w - 28) / (high[0] - low[0] || 1), (h - 28) / (high[1] - low[1] || 1));
  const middle = [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2];
  const at = ([x, y]) => [w / 2 + (x - middle[0]) * scale, h / 2 - (y - middle[1]) * scale];
  const join = (points) => points.map((p) => at(p).map((v) => v.toFixed(1)).join(",")).join(" ");
  const arms = Flight.drawn(pair), paths = Object.fromEntries(arms.map((arm) => [arm, Flight.path(pair[arm])]));
  const label = Draw.labeller(svg, w, h, arms.flatMap((arm) => paths[arm].filter((_, i) => i % 2 === 0).map(at)));
  if (scene.plan) {
    const [x0, y0] = scene.plan.low, [x1, y1] = scene.plan.high, hits = Flight.hits(pair);
    Draw.node(svg, "polygon", { points: join([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]), class: "v-ground" });
    const look = (n) => (hits.includes(n) ? "v-block v-hit" : "v-block");
    scene.plan.prisms.forEach((p, n) => Draw.node(svg, "polygon", { points: join(p.corners), class: look(n) }));
    scene.plan.pillars.forEach((p, n) => {
      const [cx, cy] = at([p.x, p.y]);
      Draw.node(svg, "circle", { cx, cy, r: p.radius * scale, class: look(scene.plan.prisms.length + n) });
    });
  }
  for (const arm of arms) {
    const now = Math.min(step, pair[arm].steps - 1);
    Draw.node(svg, "polyline", { points: join(paths[arm].slice(now)), class: `v-track rest ${arm}` });
    Draw.node(svg, "polyline", { points: join(paths[arm].slice(0, now + 1)), class: `v-track ${arm}` });
  }
  if (scene.plan) {
    const [sx, sy] = at(scene.plan.start), [gx, gy] = at(scene.plan.goal);
    Draw.node(svg, "circle", { cx: gx, cy: gy, r: 0.5 * scale, class: "v-mark", "fill-opacity": 0 });
    Draw.node(svg, "path", { d: `M${gx - 4} ${gy}h8M${gx} ${gy - 4}v8`, class: "v-mark" });
    Draw.node(svg, "circle", { cx: sx, cy: sy, r: 4, class: "v-solid" });
    label("start", [sx, sy]);
    label("goal", [gx, gy - 0.5 * scale]);
  }
  if (pair.parting_step !== null) {
    const [x, y] = at(Flight.point(pair.repair, pair.parting_step));
    Draw.node(svg, "rect", { x: x - 4, y: y - 4, width: 8, height: 8, class: "v-mark" });
    label(`part at ${(pair.parting_step * data.dt_s).toFixed(2)} s`, [x, y]);
  }
  for (const arm of arms) {
    Draw.end(svg, pair[arm].status, arm, at(Flight.point(pair[arm], Infinity)));
    drawVehicle(svg, pair[arm], arm, step, at);
  }
  const metres = [0.5, 1, 2, 5, 10, 20, 50, 100].find((m) => m * scale > 40) ?? 200;
  Draw.node(svg, "path", { d: `M12 ${h - 14}v4h${metres * scale}v-4`, class: "v-mark", "fill-opacity": 0 });
  Draw.node(svg, "text", { x: 18, y: h - 16, class: "v-text soft" }, `${metres} m`);
}

// A dot, with its arms where the attitude is known, and the arrow of the wind where that is.
function drawVehicle(svg, trial, arm, step, at) {
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
}

function drawHeight(host, scene, pair, step, data) {
  const { svg, w, h } = Draw.svg(host, `Height over time in ${scene.scene}`);
  const { low, high } = Flight.bounds({ plan: null, pairs: [pair] });
  const bottom = Math.min(0, Math.floor(low[2])), top = Math.max(Math.ceil(high[2]), bottom + 1);
  const last = Flight.last(scene);
  const left = 34, right = w - 24;  // beside the last step stays room for half of its label
  const x = (i) => left + (i / last) * (right - left), y = (z) => h - 22 - ((z - bottom) / (top - bottom)) * (h - 44);
  for (const z of [bottom, top]) {
    Draw.node(svg, "line", { x1: left, x2: right, y1: y(z), y2: y(z), class: "v-line" });
    Draw.node(svg, "text", { x: 28, y: y(z) + 4, "text-anchor": "end", class: "v-text soft" }, String(z).replace("-", "−"));
  }
  Draw.node(svg, "text", { x: left, y: 13, class: "v-text soft" }, "height, m");
  Draw.times(svg, last, data.dt_s, x, h - 6);
  for (const mark of [pair.parting_step, step]) {
    if (mark === null || mark > last) continue;
    Draw.node(svg, "line", { x1: x(mark), x2: x(mark), y1: y(bottom), y2: y(top), class: "v-line", "stroke-dasharray": mark === step ? "" : "2 3" });
  }
  for (const arm of Flight.drawn(pair)) {
    const heights = pair[arm].track[2];
    const points = Array.from(heights, (v, i) => `${x(i).toFixed(1)},${y(v / 100).toFixed(1)}`);
    Draw.node(svg, "polyline", { points: points.join(" "), class: `v-track ${arm}` });
    const now = Math.min(step, points.length - 1);
    Draw.node(svg, "circle", { cx: x(now), cy: y(heights[now] / 100), r: 4, class: `v-dot ${arm}` });
  }
}
