// The view from above and the strip of heights, drawn as SVG.
const Flight = {
  arms: ["baseline", "repair"],
  point(track, step) {
    const i = 3 * Math.min(step, track.length / 3 - 1);
    return [track[i] / 100, track[i + 1] / 100, track[i + 2] / 100];
  },
  steps(track) { return track.length / 3; },
  bounds(scene, pair) {
    const low = scene.plan ? [...scene.plan.low] : [Infinity, Infinity, Infinity];
    const high = scene.plan ? [...scene.plan.high] : [-Infinity, -Infinity, -Infinity];
    for (const arm of Flight.arms) {
      pair[arm].track_cm.forEach((v, i) => {
        low[i % 3] = Math.min(low[i % 3], v / 100);
        high[i % 3] = Math.max(high[i % 3], v / 100);
      });
    }
    return { low, high };
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
};

function drawPlan(host, scene, pair, step, data) {
  const { svg, w, h } = Draw.svg(host, `Flights in ${scene.scene} from above`);
  const { low, high } = Flight.bounds(scene, pair);
  const scale = Math.min((w - 28) / (high[0] - low[0] || 1), (h - 28) / (high[1] - low[1] || 1));
  const middle = [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2];
  const at = ([x, y]) => [w / 2 + (x - middle[0]) * scale, h / 2 - (y - middle[1]) * scale];
  const join = (points) => points.map((p) => at(p).map((v) => v.toFixed(1)).join(",")).join(" ");
  const flown = Flight.arms.flatMap((arm) => {
    const track = pair[arm].track_cm;
    return Array.from({ length: Math.ceil(Flight.steps(track) / 2) }, (_, i) => at(Flight.point(track, 2 * i)));
  });
  const label = Draw.labeller(svg, w, h, flown);
  if (scene.plan) {
    const [x0, y0] = scene.plan.low, [x1, y1] = scene.plan.high;
    Draw.node(svg, "polygon", { points: join([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]), class: "v-ground" });
    for (const p of scene.plan.prisms) Draw.node(svg, "polygon", { points: join(p.corners), class: "v-block" });
    for (const p of scene.plan.pillars) {
      const [cx, cy] = at([p.x, p.y]);
      Draw.node(svg, "circle", { cx, cy, r: p.radius * scale, class: "v-block" });
    }
  }
  for (const arm of Flight.arms) {
    const track = pair[arm].track_cm, n = Flight.steps(track), now = Math.min(step, n - 1);
    const points = Array.from({ length: n }, (_, i) => Flight.point(track, i));
    Draw.node(svg, "polyline", { points: join(points.slice(now)), class: `v-track rest ${arm}` });
    Draw.node(svg, "polyline", { points: join(points.slice(0, now + 1)), class: `v-track ${arm}` });
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
    const [x, y] = at(Flight.point(pair.repair.track_cm, pair.parting_step));
    Draw.node(svg, "rect", { x: x - 4, y: y - 4, width: 8, height: 8, class: "v-mark" });
    label(`part at ${(pair.parting_step * data.dt_s).toFixed(2)} s`, [x, y]);
  }
  for (const arm of Flight.arms) {
    const track = pair[arm].track_cm;
    Draw.end(svg, pair[arm].status, arm, at(Flight.point(track, Infinity)));
    if (step >= Flight.steps(track) - 1) continue;
    const [cx, cy] = at(Flight.point(track, step));
    Draw.node(svg, "circle", { cx, cy, r: 5, class: `v-dot ${arm}` });
  }
  const metres = [0.5, 1, 2, 5, 10].find((m) => m * scale > 40) ?? 20;
  Draw.node(svg, "path", { d: `M12 ${h - 14}v4h${metres * scale}v-4`, class: "v-mark", "fill-opacity": 0 });
  Draw.node(svg, "text", { x: 18, y: h - 16, class: "v-text soft" }, `${metres} m`);
}

function drawHeight(host, scene, pair, step, data) {
  const { svg, w, h } = Draw.svg(host, `Height over time in ${scene.scene}`);
  const { low, high } = Flight.bounds({ plan: null }, pair);
  const bottom = Math.min(0, Math.floor(low[2])), top = Math.max(Math.ceil(high[2]), bottom + 1);
  const last = Math.max(...Flight.arms.map((arm) => Flight.steps(pair[arm].track_cm))) - 1 || 1;
  const left = 34, right = w - 24;  // beside the last step stays room for half of its label
  const x = (i) => left + (i / last) * (right - left), y = (z) => h - 22 - ((z - bottom) / (top - bottom)) * (h - 44);
  for (const z of [bottom, top]) {
    Draw.node(svg, "line", { x1: left, x2: right, y1: y(z), y2: y(z), class: "v-line" });
    Draw.node(svg, "text", { x: 28, y: y(z) + 4, "text-anchor": "end", class: "v-text soft" }, String(z).replace("-", "−"));
  }
  Draw.node(svg, "text", { x: left, y: 13, class: "v-text soft" }, "height, m");
  const every = [0.5, 1, 2, 5].find((s) => (s / data.dt_s / last) * (right - left) > 44) ?? 10;
  for (let t = 0; t <= last * data.dt_s + 1e-9; t += every) {
    Draw.node(svg, "text", { x: x(t / data.dt_s), y: h - 6, "text-anchor": "middle", class: "v-text soft" }, `${t} s`);
  }
  for (const mark of [pair.parting_step, step]) {
    if (mark === null || mark > last) continue;
    Draw.node(svg, "line", { x1: x(mark), x2: x(mark), y1: y(bottom), y2: y(top), class: "v-line", "stroke-dasharray": mark === step ? "" : "2 3" });
  }
  for (const arm of Flight.arms) {
    const track = pair[arm].track_cm;
    const points = Array.from({ length: Flight.steps(track) }, (_, i) => `${x(i).toFixed(1)},${y(track[3 * i + 2] / 100).toFixed(1)}`);
    Draw.node(svg, "polyline", { points: points.join(" "), class: `v-track ${arm}` });
    const now = Math.min(step, points.length - 1);
    Draw.node(svg, "circle", { cx: x(now), cy: y(track[3 * now + 2] / 100), r: 4, class: `v-dot ${arm}` });
  }
}
