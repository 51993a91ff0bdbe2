// A small three-dimensional view on a canvas: a perspective camera that turns about the scene.
class Scene3D {
  constructor(canvas) {
    this.canvas = canvas;
    this.yaw = -0.38; this.pitch = 0.6; this.zoom = 1;
    this.content = null;
    this.held = null;
    canvas.addEventListener("pointerdown", (e) => { this.held = [e.clientX, e.clientY]; canvas.setPointerCapture(e.pointerId); });
    canvas.addEventListener("pointermove", (e) => {
      if (!this.held) return;
      this.turn((e.clientX - this.held[0]) * 0.008, (e.clientY - this.held[1]) * 0.008);
      this.held = [e.clientX, e.clientY];
    });
    for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, () => { this.held = null; });
    canvas.addEventListener("keydown", (e) => this.key(e));
  }

  key(event) {
    const turns = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.08], ArrowDown: [0, 0.08] };
    const zooms = { "+": 1.15, "=": 1.15, "-": 1 / 1.15 };
    if (turns[event.key]) this.turn(...turns[event.key]);
    else if (zooms[event.key]) { this.zoom = Math.min(4, Math.max(0.4, this.zoom * zooms[event.key])); this.draw(); }
    else return;
    event.preventDefault();
  }

  turn(yaw, pitch) {
    this.yaw += yaw;
    this.pitch = Math.min(1.5, Math.max(0.05, this.pitch + pitch));
    this.draw();
  }

  show(content) { this.content = content; this.draw(); }

  frame() {
    const { low, high } = Flight.bounds(this.content.scene);
    const centre = low.map((v, i) => (v + high[i]) / 2);
    const radius = Math.hypot(...low.map((v, i) => high[i] - v)) / 2 || 1;
    const [cy, sy, cp, sp] = [Math.cos(this.yaw), Math.sin(this.yaw), Math.cos(this.pitch), Math.sin(this.pitch)];
    const distance = 4 * radius;
    const camera = (p) => {
      const d = p.map((v, i) => v - centre[i]);
      const x = cy * d[0] - sy * d[1], deep = sy * d[0] + cy * d[1];
      const up = cp * d[2] + sp * deep, away = cp * deep - sp * d[2];
      const k = distance / (distance + away);
      return [x * k, -up * k, away];
    };
    // The whole volume stays in the picture however it is turned.
    const corners = Array.from({ length: 8 }, (_, i) => camera(low.map((v, j) => (i >> j) & 1 ? high[j] : v)));
    const [x0, x1, y0, y1] = [0, 1].flatMap((j) => [Math.min(...corners.map((c) => c[j])), Math.max(...corners.map((c) => c[j]))]);
    const scale = Math.min((this.w - 28) / (x1 - x0), (this.h - 28) / (y1 - y0)) * this.zoom;
    const project = (p) => {
      const [x, y, away] = camera(p);
      return [this.w / 2 + (x - (x0 + x1) / 2) * scale, this.h / 2 + (y - (y0 + y1) / 2) * scale, away];
    };
    return { low, high, project };
  }

  draw() {
    const box = this.canvas.getBoundingClientRect();
    if (!this.content || !box.width) return;
    const ratio = window.devicePixelRatio || 1;
    [this.w, this.h] = [box.width, box.height];
    this.canvas.width = Math.round(box.width * ratio);
    this.canvas.height = Math.round(box.height * ratio);
    this.pen = this.canvas.getContext("2d");
    this.pen.scale(ratio, ratio);
    const style = getComputedStyle(document.documentElement);
    this.ink = (name) => style.getPropertyValue(`--${name}`).trim();
    this.canvas.dataset.view = `${this.yaw.toFixed(3)} ${this.pitch.toFixed(3)} ${this.zoom.toFixed(3)}`;
    const view = this.frame();
    this.ground(view);
    if (this.content.scene.plan) this.solids(view);
    if (this.content.scene.plan) this.ends(view);
    this.flights(view);
  }

  ground({ low, high, project }) {
    const floor = Math.min(0, low[2]);
    this.line([[low[0], low[1], floor], [high[0], low[1], floor], [high[0], high[1], floor], [low[0], high[1], floor], [low[0], low[1], floor]].map(project), this.ink("soft"), 1);
    for (let x = Math.ceil(low[0]); x < high[0]; x += 1) this.line([[x, low[1], floor], [x, high[1], floor]].map(project), this.ink("rule"), 0.6);
    for (let y = Math.ceil(low[1]); y < high[1]; y += 1) this.line([[low[0], y, floor], [high[0], y, floor]].map(project), this.ink("rule"), 0.6);
  }

  solids({ project }) {
    const { prisms, pillars } = this.content.scene.plan, hits = Flight.hits(this.content.pair);
    const round = (p) => Array.from({ length: 14 }, (_, i) => [p.x + p.radius * Math.cos((i * Math.PI) / 7), p.y + p.radius * Math.sin((i * Math.PI) / 7)]);
    const faces = [];
    for (const [number, p] of [...prisms, ...pillars.map((q) => ({ ...q, corners: round(q), smooth: true }))].entries()) {
      const n = p.corners.length, look = { edge: !p.smooth, hit: hits.includes(number) };
      const ring = (z) => p.corners.map(([x, y]) => project([x, y, z]));
      const [under, over] = [ring(p.bottom), ring(p.top)];
      faces.push({ points: over, ...look, edge: true });
      for (let i = 0; i < n; i += 1) {
        const j = (i + 1) % n;
        faces.push({ points: [under[i], under[j], over[j], over[i]], ...look });
      }
    }
    for (const face of faces) face.depth = face.points.reduce((sum, p) => sum + p[2], 0) / face.points.length;
    faces.sort((a, b) => b.depth - a.depth);
    for (const { points, edge, hit } of faces) {
      const ink = this.ink(hit ? "struck" : "soft");
      this.pen.beginPath();
      points.forEach(([x, y], i) => (i ? this.pen.lineTo(x, y) : this.pen.moveTo(x, y)));
      this.pen.closePath();
      this.pen.globalAlpha = 0.13; this.pen.fillStyle = ink; this.pen.fill();
      this.pen.globalAlpha = edge ? 0.55 : 0.12; this.pen.strokeStyle = ink; this.pen.lineWidth = 0.8; this.pen.stroke();
      this.pen.globalAlpha = 1;
    }
  }

  // Start and goal; the ring has the radius within which the goal counts as reached.
  ends({ project }) {
    const { start, goal } = this.content.scene.plan;
    const ring = Array.from({ length: 25 }, (_, i) => project([goal[0] + 0.5 * Math.cos((i * Math.PI) / 12), goal[1] + 0.5 * Math.sin((i * Math.PI) / 12), goal[2]]));
    const [from, to] = [project(start), project(goal)];
    this.line(ring, this.ink("ink"), 1.5);
    this.dot(from, 4, this.ink("ink"));
    this.word("start", from, from[0] < to[0] ? -9 : 9);
    this.word("goal", to, (from[0] < to[0] ? 1 : -1) * (9 + Math.max(...ring.map((p) => Math.abs(p[0] - to[0])))));
  }

  flights({ low, project }) {
    const { pair, step } = this.content;
    const floor = Math.min(0, low[2]);
    for (const arm of Flight.drawn(pair)) {
      const trial = pair[arm], now = Math.min(step, trial.steps - 1);
      const points = Flight.path(trial).map(project), last = points[points.length - 1];
      this.pen.setLineDash(arm === "baseline" ? [6, 3] : []);
      this.pen.globalAlpha = 0.3; this.line(points.slice(now), this.ink(arm), 2);
      this.pen.globalAlpha = 1; this.line(points.slice(0, now + 1), this.ink(arm), 2);
      this.pen.setLineDash([]);
      const here = Flight.point(trial, step);
      this.line([here, [here[0], here[1], floor]].map(project), this.ink(arm), 0.8);
      this.end(trial.status, last, this.ink(arm));
      this.vehicle(trial, arm, now, points[now], project);
    }
    if (pair.parting_step !== null) {
      const [x, y] = project(Flight.point(pair.repair, pair.parting_step));
      this.pen.fillStyle = this.ink("paper"); this.pen.strokeStyle = this.ink("ink"); this.pen.lineWidth = 1.5;
      this.pen.fillRect(x - 4, y - 4, 8, 8); this.pen.strokeRect(x - 4, y - 4, 8, 8);
    }
  }

  // The body with its four arms and its upward axis, and the arrow of the wind, where known.
  vehicle(trial, arm, now, spot, project) {
    const here = Flight.point(trial, now), axes = Flight.axes(trial, now), wind = Flight.wind(trial, now);
    const to = (direction, length) => project(here.map((v, i) => v + direction[i] * length));
    if (wind) {
      const tip = to(wind, Flight.ARROW_S), turn = Math.atan2(tip[1] - spot[1], tip[0] - spot[0]);
      const head = (bend) => [tip[0] + 8 * Math.cos(turn + bend), tip[1] + 8 * Math.sin(turn + bend)];
      this.line([spot, tip], this.ink("soft"), 1.5);
      this.line([head(2.6), tip, head(-2.6)], this.ink("soft"), 1.5);
    }
    if (axes) {
      for (const l of [1, -1]) {
        const side = axes[0].map((v, i) => v + l * axes[1][i]);
        this.line([to(side, 0.22), to(side, -0.22)], this.ink(arm), 2.5);
      }
      this.line([spot, to(axes[2], 0.35)], this.ink(arm), 1.5);
    } else if (now < trial.steps - 1) this.dot(spot, 5, this.ink(arm));
  }

  line(points, colour, width) {
    this.pen.beginPath();
    points.forEach(([x, y], i) => (i ? this.pen.lineTo(x, y) : this.pen.moveTo(x, y)));
    this.pen.strokeStyle = colour; this.pen.lineWidth = width; this.pen.stroke();
  }

  dot([x, y], r, colour) {
    this.pen.beginPath(); this.pen.arc(x, y, r, 0, 2 * Math.PI);
    this.pen.fillStyle = colour; this.pen.fill();
    this.pen.strokeStyle = this.ink("paper"); this.pen.lineWidth = 1.5; this.pen.stroke();
  }

  end(status, [x, y], colour) {
    const strokes = {
      success: [[[-5, 0], [-1, 4], [6, -5]]],
      crash: [[[-5, -5], [5, 5]], [[5, -5], [-5, 5]]],
    }[status] ?? [[[-5, -5], [5, -5], [5, 5], [-5, 5], [-5, -5]]];
    for (const [ink, width] of [[this.ink("paper"), 5.5], [colour, 2.25]]) {
      for (const stroke of strokes) this.line(stroke.map(([dx, dy]) => [x + dx, y + dy]), ink, width);
    }
  }

  // Writes beside a point: to its right where `aside` is positive, else to its left.
  word(text, [x, y], aside) {
    this.pen.font = `12px ${getComputedStyle(document.body).fontFamily}`;
    this.pen.textAlign = aside > 0 ? "left" : "right";
    this.pen.lineWidth = 3; this.pen.strokeStyle = this.ink("wash"); this.pen.strokeText(text, x + aside, y + 4);
    this.pen.fillStyle = this.ink("ink"); this.pen.fillText(text, x + aside, y + 4);
  }
}
