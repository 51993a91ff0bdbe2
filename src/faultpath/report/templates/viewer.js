// Every trial again: a scene on one clock, a column a condition; scene, condition and time are in the address.
if (document.getElementById("viewer-data")) {
  const VERSIONS = ["baseline", "repair"], SIGNS = { success: "✓", crash: "✕" };
  const get = (id) => document.getElementById(`viewer-${id}`);
  const make = (tag, text = "", attributes = {}) => {
    const node = document.createElement(tag);
    node.textContent = text;
    for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
    return node;
  };
  const draw = (parent, tag, attributes, text = "") => {
    const node = document.createElementNS("http://www.w3.org/2000/svg", tag);
    for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
    node.textContent = text;
    return parent.appendChild(node);
  };
  const picture = (host, title) => {
    const w = Math.max(host.clientWidth, 80), h = Math.max(host.clientHeight, 60);
    host.replaceChildren();
    return { svg: draw(host, "svg", { viewBox: `0 0 ${w} ${h}`, role: "img", "aria-label": title }), w, h };
  };

  // What `viewer.py` packed; series are second differences, summed up twice.
  const unpacked = async (packed) => {
    const bytes = Uint8Array.from(atob(packed), (c) => c.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    const data = await new Response(stream).json();
    data.series = data.series.map((steps) => {
      let step = 0, value = 0;
      return steps.map((change) => (value += step += change));
    });
    return data;
  };

  const begin = (data) => {
    const spatial = ["space", "picture"].includes(data.space), { series, dt_s: dt } = data;
    const several = new Set(data.scenes.map((s) => s.seed)).size > 1;
    const state = { scene: data.picked[0] ?? 0, condition: data.condition, step: 0, plot: data.plot, playing: 0, last: 1, box: null, range: null };
    const current = () => data.scenes[state.scene];
    const trials = (pair) => VERSIONS.filter((variant) => pair[variant]).map((variant) => ({ variant, ...pair[variant] }));
    const track = ({ track: at }) => (at === null ? [] : series[at].map((x, i) => [x / 100, series[at + 1][i] / 100]));
    // What a system renders: at each step a line through points, broken where the pen is lifted.
    const drawn = ({ drawn: at }, step) => {
      const points = [];
      for (let n = 0; at && n < at[1]; n += 2) {
        const row = Math.min(step, series[at[0]].length - 1);
        points.push([series[at[0] + n][row], series[at[0] + n + 1][row]].map((v) => (v === 1e9 ? null : v / 100)));
      }
      return points;
    };
    const ends = (values, low = Infinity, high = -Infinity) => {
      for (const v of values) if (v !== null) { low = Math.min(low, v); high = Math.max(high, v); }
      return [low, high];
    };
    const told = ({ variant, status, ended, time_s: time }) =>
      `${variant}: ${SIGNS[status] ?? "□"} ${ended}${status === "failed" ? "" : `, ${time.toFixed(2)} s`}`;

    // Both trials of a pair from above: baseline dashed, what is still to come pale.
    const drawPlan = (host, title, pair) => {
      const { svg, w, h } = picture(host, title), plan = data.plans[current().scene], [[x0, x1], [y0, y1]] = state.box;
      const edge = plan && data.space !== "picture" ? 12 : 60; // without walls, signs and the scale need room
      const scale = Math.min((w - edge) / (x1 - x0 || 1), (h - edge) / (y1 - y0 || 1));
      const at = ([x, y]) => [w / 2 + (x - (x0 + x1) / 2) * scale, h / 2 - (y - (y0 + y1) / 2) * scale];
      const join = (points) => points.map((p) => at(p).map((v) => v.toFixed(1)).join(",")).join(" ");
      const disc = (where, r, cls) => { const [cx, cy] = at(where); draw(svg, "circle", { cx, cy, r, class: cls }); };
      if (plan) {
        const [a, b] = [plan.low, plan.high];
        draw(svg, "polygon", { points: join([[a[0], a[1]], [b[0], a[1]], [b[0], b[1]], [a[0], b[1]]]), class: "v-ground" });
        for (const { corners } of plan.prisms) draw(svg, "polygon", { points: join(corners), class: "v-block" });
        for (const { x, y, radius } of plan.pillars) disc([x, y], radius * scale, "v-block");
        disc(plan.goal, Math.max(5, 0.5 * scale), "v-mark");
        disc(plan.start, 3, "v-solid");
      }
      for (const trial of trials(pair)) {
        const line = drawn(trial, state.step), gap = (n) => !line[n] || line[n].includes(null);
        const d = line.map((p, n) => (gap(n) ? "" : `${gap(n - 1) ? "M" : "L"}${at(p).map((v) => v.toFixed(1))}`)).join("");
        if (d) draw(svg, "path", { d, class: `v-track ${trial.variant}` });
        if (data.space === "picture" || trial.track === null) continue;
        const points = track(trial), now = Math.min(state.step, points.length - 1), [x, y] = at(points[points.length - 1]);
        draw(svg, "polyline", { points: join(points.slice(now)), class: `v-track rest ${trial.variant}` });
        draw(svg, "polyline", { points: join(points.slice(0, now + 1)), class: `v-track ${trial.variant}` });
        const sign = { success: `M${x - 5} ${y}l4 4 7 -9`, crash: `M${x - 5} ${y - 5}l10 10m0 -10l-10 10` }[trial.status];
        for (const cls of ["halo", trial.variant]) draw(svg, "path", { d: sign ?? `M${x - 4.5} ${y - 4.5}h9v9h-9z`, class: `v-end ${cls}` });
        if (now < points.length - 1) disc(points[now], 4.5, `v-dot ${trial.variant}`);
      }
      const metres = [0.5, 1, 2, 5, 10, 20, 50, 100].find((m) => m * scale > 30) ?? 200;
      draw(svg, "path", { d: `M8 ${h - 10}v4h${metres * scale}v-4`, class: "v-mark" });
      draw(svg, "text", { x: 12, y: h - 10, class: "v-text" }, `${metres} m`);
    };

    const linesOf = (pair) => trials(pair).flatMap(({ variant, lines }) => lines
      .filter(([plot]) => plot === state.plot)
      .map(([, line, place, low, level]) => ({ variant, line, values: series[place].map((v) => (v < 0 ? null : low + v * level)) })));
    // Where the goal lies on the one axis of a position that is plotted over time.
    const goal = () => (data.space === "line" && data.plots[state.plot].title === "position" ? data.plans[current().scene]?.goal[0] ?? null : null);
    const drawPlot = (host, title, pair) => {
      const lines = state.range ? linesOf(pair) : [];
      host.hidden = !lines.some(({ values }) => values.some((v) => v));
      if (host.hidden) return;
      const { svg, w, h } = picture(host, title), left = 52, right = w - 24, under = h - 20, [low, high] = state.range;
      const x = (i) => left + (Math.min(i, state.last) / state.last) * (right - left);
      const y = (v) => under - ((v - low) / (high - low)) * (under - 8);
      const level = (v, cls) => draw(svg, "line", { x1: left, x2: right, y1: y(v), y2: y(v), class: cls });
      for (const [from, to] of trials(pair).flatMap(({ faulted }) => faulted)) {
        draw(svg, "rect", { x: x(from), y: 8, width: Math.max(1, x(to) - x(from)), height: under - 8, class: "v-window" });
      }
      const digits = Math.min(6, Math.max(0, Math.ceil(1.3 - Math.log10(high - low))));
      for (const [step] of pair.parting?.marks ?? []) draw(svg, "line", { x1: x(step), x2: x(step), y1: 8, y2: under, class: "v-parting" });
      for (const v of state.range) {
        level(v, "v-line");
        draw(svg, "text", { x: left - 5, y: Math.min(under - 1, Math.max(16, y(v) + 4)), "text-anchor": "end", class: "v-text" }, v.toFixed(digits).replace("-", "−"));
      }
      const sizes = [0.5, ...[...Array(9).keys()].flatMap((power) => [1, 2, 5].map((n) => n * 10 ** power))];
      const wide = 32 + 6 * String(Math.floor(state.last * dt)).length;
      const every = sizes.find((s) => x(s / dt) - x(0) > wide) ?? state.last * dt;
      for (let t = 0; t <= state.last * dt + 1e-9; t += every) {
        draw(svg, "text", { x: x(t / dt), y: h - 5, "text-anchor": "middle", class: "v-text" }, `${t} s`);
      }
      if (data.plots[state.plot].zero) level(0, "v-line");
      if (goal() !== null) {
        level(goal(), "v-goal");
        draw(svg, "text", { x: left + 5, y: y(goal()) + (y(goal()) < 26 ? 14 : -5), class: "v-text" }, "goal");
      }
      for (const { variant, line, values } of lines) {
        const points = values.flatMap((v, i) => (v === null ? [] : [`${x(i).toFixed(1)},${y(v).toFixed(1)}`]));
        draw(svg, "polyline", { points: points.join(" "), class: `v-signal ${variant} line-${Math.min(line, 3)}` });
      }
      draw(svg, "line", { x1: x(state.step), x2: x(state.step), y1: 8, y2: under, class: "v-now" });
    };

    const nameOf = (place) => {
      const { scene, title, seed } = data.scenes[place], name = title.includes(scene) ? title : scene + (title && `, ${title}`);
      return several ? `${name}, seed ${seed}` : name;
    };
    const group = (label, places) => {
      const made = make("optgroup", "", { label });
      for (const place of places) made.append(make("option", nameOf(place), { value: place }));
      return made;
    };
    // The list has all scenes, or those in which one variant alone succeeds on one condition.
    const every = [...data.scenes.keys()], most = 30;
    const apart = data.conditions.flatMap(({ name, title }) => ["repair", "baseline"].map((variant) => {
      const places = every.filter((place) => data.scenes[place].pairs.some((p) => p.condition === name && p.kind === `${variant}-only`));
      return { label: `${title}: only the ${variant} succeeds`, places };
    })).filter(({ places }) => places.length);
    const noun = several ? "trials" : "scenes", part = every.length < data.ran;
    const all = { label: `all ${noun}`, places: every };
    const labels = [all, ...apart].map(({ label, places }) => `${label} (${places.length}${part ? " recorded" : ""})`);
    if (part) labels[0] = `${every.length} of ${data.ran} ${noun} recorded`;
    get("show").replaceChildren(...labels.map((label, n) => make("option", label, { value: n })));
    // A menu of hundreds is no menu: it has the first scenes whose names have every word that is looked for.
    const offer = (n, find = get("find").value) => {
      get("find").value = find;
      const words = find.toLowerCase().split(/\s+/).filter(Boolean), { places } = [all, ...apart][n];
      const match = places.filter((place) => words.every((word) => nameOf(place).toLowerCase().includes(word)));
      const listed = match.slice(0, most), more = match.length - listed.length, first = n === 0 && !words.length ? data.picked : [];
      if (match.length && !match.includes(state.scene)) state.scene = match[0];
      if (![...first, ...listed].includes(state.scene)) listed.push(state.scene);
      const rest = match.length ? more && `${more} more: type to find one` : "no scene has these words";
      get("show").value = String(n);
      get("scene").replaceChildren(...(first.length ? [group("Shown first", first)] : []), group(match.length ? "All" : "Shown", listed), ...(rest ? [make("option", rest, { disabled: "" })] : []));
      get("scene").value = String(state.scene);
    };
    get("found").hidden = every.length <= most;
    offer(0);
    const columns = data.conditions.map(({ name: condition, title }) => {
      const column = make("div", "", { class: "column", "data-condition": condition });
      const plan = make("div", "", { class: "plan" }), plot = make("div", "", { class: "signal" });
      const said = make("div", "", { class: "told" });
      const heading = make("h3"), choose = make("button", title, { type: "button" });
      choose.addEventListener("click", () => { state.condition = condition; mark(); tell(); });
      heading.append(choose);
      column.append(heading, ...(spatial ? [plan] : []), said, plot);
      return { condition, title, column, plan, said, plot };
    });
    get("across").replaceChildren(...columns.map((c) => c.column));

    // Where the two trials of the chosen condition part: said, and marked on the bar.
    const mark = () => {
      const pair = current().pairs.find((p) => p.condition === state.condition);
      const marks = pair?.parting?.marks ?? [], steps = [...new Set(marks.map(([step]) => step))];
      for (const { condition, column } of columns) column.classList.toggle("chosen", condition === state.condition);
      get("parting").hidden = !pair?.parting;
      get("said").textContent = pair?.parting ? `${columns.find((c) => c.condition === state.condition).title}. ${pair.parting.said}` : "";
      get("ticks").replaceChildren(...steps.map((step) => make("option", "", { value: step })));
      get("marks").replaceChildren(...steps.map((step) => {
        const words = marks.filter(([at]) => at === step).map(([, what]) => what).join(", ");
        const button = make("button", `${(step * dt).toFixed(2)} s: ${words}`, { type: "button" });
        button.addEventListener("click", () => { stop(); show(step); tell(); });
        return button;
      }));
    };
    const redraw = () => {
      for (const { condition, title, plan, said, plot } of columns) {
        const pair = current().pairs.find((each) => each.condition === condition);
        if (!pair) continue;
        plan.hidden = state.box[0][0] > state.box[0][1];
        if (spatial && !plan.hidden) drawPlan(plan, `${title}${data.plans[current().scene] ? ", from above" : ""}. ${said.textContent}`, pair);
        drawPlot(plot, `${data.plots[state.plot]?.title}, ${title}`, pair);
      }
      get("clock").textContent = `${(state.step * dt).toFixed(2)} s`;
      get("time").value = String(state.step);
    };
    // The range of a plot over all conditions of the scene; null where it has nothing to show.
    const rangeOf = (plot) => {
      state.plot = plot;
      let [low, high] = ends(current().pairs.flatMap((pair) => linesOf(pair).flatMap(({ values }) => values)));
      if (low > high || (low === 0 && high === 0)) return null;
      const also = data.plots[plot].zero ? 0 : goal();
      if (also !== null) [low, high] = [Math.min(low, also), Math.max(high, also)];
      const margin = (high - low || Math.abs(high) || 1) * 0.05;
      return [low - margin, high + margin];
    };
    // Offers what was recorded of the scene; a choice that it has not got is another one there.
    const chooseSignal = (wanted) => {
      const has = [...data.plots.keys()].filter(rangeOf);
      get("signals").hidden = !has.length;
      state.plot = has.includes(wanted) || !has.length ? wanted : has[0];
      state.range = has.length ? rangeOf(state.plot) : null;
      if (!has.length) return;
      const label = ({ title, unit }) => (unit && unit !== "1" ? `${title} (${unit})` : title);
      get("signal").replaceChildren(...has.map((place) => make("option", label(data.plots[place]), { value: place })));
      get("signal").value = String(state.plot);
      const { lines } = data.plots[state.plot];
      get("lines").replaceChildren(...lines.map((line, n) => make("li", line, { class: `line-${Math.min(n, 3)}` })));
      get("lines").hidden = lines.length < 2;
    };
    const reset = (step) => {
      const scene = current(), every = scene.pairs.flatMap(trials), plan = data.plans[scene.scene];
      const length = (each) => (each.track === null ? Math.ceil(each.time_s / dt - 1e-6) + 1 : series[each.track].length);
      state.last = Math.max(1, ends(every.map(length))[1] - 1);
      state.step = Math.min(Math.max(0, step ?? state.last), state.last);
      const pictures = every.flatMap((each) => Array.from({ length: state.last }, (_, step) => drawn(each, step)).flat());
      const points = [...(data.space === "picture" ? pictures : every.flatMap(track)), ...(plan ? [plan.low, plan.high] : [])];
      state.box = [0, 1].map((axis) => ends(points.map((point) => point[axis])));
      get("time").max = String(state.last);
      get("scene").value = String(state.scene);
      get("why").textContent = scene.why;
      chooseSignal(state.plot);
      for (const { condition, column, said } of columns) {
        const pair = scene.pairs.find((each) => each.condition === condition);
        column.hidden = !pair;
        if (pair) said.replaceChildren(...trials(pair).map((each) => make("p", told(each), { class: each.variant })), make("p", pair.void ? `Void: ${pair.void}.` : ""));
      }
      mark();
      redraw();
    };

    // The address says what is shown, and shows what it says.
    const tell = () => {
      const { scene, seed } = current();
      const parts = { scene, seed, condition: state.condition, t: (state.step * dt).toFixed(2) };
      history.replaceState(null, "", `#${Object.entries(parts).map(([key, value]) => `${key}=${encodeURIComponent(value)}`).join("&")}`);
    };
    const listen = () => {
      const asked = Object.fromEntries(new URLSearchParams(location.hash.slice(1)));
      const place = data.scenes.findIndex((s) => s.scene === asked.scene && String(s.seed) === (asked.seed ?? String(s.seed)));
      if (place < 0) return false;
      stop();
      state.scene = place;
      offer(0, "");
      if (data.conditions.some((p) => p.name === asked.condition)) state.condition = asked.condition;
      reset(Number.isFinite(Number(asked.t ?? NaN)) ? Math.round(Number(asked.t) / dt) : undefined);
      document.getElementById("viewer").scrollIntoView({ block: "start" });
      get("play").focus({ preventScroll: true });
      return true;
    };

    const stop = () => { cancelAnimationFrame(state.playing); state.playing = 0; get("play").textContent = "Play"; };
    const show = (step) => { state.step = Math.min(Math.max(0, step), state.last); redraw(); };
    const play = () => {
      if (state.step >= state.last) show(0);
      let before = null, exact = state.step;
      const frame = (now) => {
        if (before !== null) exact += (now - before) / 1000 / dt;
        before = now;
        if (Math.floor(exact) !== state.step) show(Math.floor(exact));
        if (exact >= state.last) { stop(); tell(); } else state.playing = requestAnimationFrame(frame);
      };
      get("play").textContent = "Pause";
      state.playing = requestAnimationFrame(frame);
    };

    get("scene").addEventListener("change", (e) => { stop(); state.scene = Number(e.target.value); reset(); tell(); });
    get("show").addEventListener("change", (e) => { stop(); offer(Number(e.target.value)); reset(); tell(); });
    get("find").addEventListener("input", () => { stop(); offer(Number(get("show").value)); reset(); tell(); });
    get("signal").addEventListener("change", (e) => { chooseSignal(Number(e.target.value)); redraw(); });
    get("time").addEventListener("input", (e) => { stop(); show(Number(e.target.value)); tell(); });
    get("play").addEventListener("click", () => { if (state.playing) { stop(); tell(); } else play(); });
    addEventListener("hashchange", listen);
    for (const sized of ["resize", "beforeprint"]) addEventListener(sized, redraw);
    document.getElementById("viewer").hidden = false;
    if (!listen()) reset();
    document.getElementById("viewer").dataset.ready = "";
  };

  const failed = (error) => { get("failed").hidden = false; get("failed").append(` (${error.message})`); };
  unpacked(JSON.parse(document.getElementById("viewer-data").textContent).packed).then(begin).catch(failed);
}
