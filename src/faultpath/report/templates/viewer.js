// The controls of the viewer: scene, path and time, kept in the address; every change draws anew.
if (document.getElementById("viewer-data")) {
  const get = (id) => document.getElementById(`viewer-${id}`);
  const make = (tag, text = "", attributes = {}) => {
    const node = document.createElement(tag);
    node.textContent = text;
    for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
    return node;
  };
  const words = {
    both: "On the path shown both succeed.", "repair-only": "On the path shown only the repair succeeds.",
    "baseline-only": "On the path shown only the baseline succeeds.", neither: "On the path shown neither succeeds.",
    "left-out": "Left out of the effects: a pair of this scene is void on another path or seed.",
  };

  const begin = (data) => {
    const spatial = data.space === "space";
    const several = new Set(data.scenes.map((s) => s.seed)).size > 1;
    const state = { scene: data.picked[0] ?? 0, path: data.path, step: 0, plot: 0, playing: 0 };
    // Along one axis the flight itself is a plot, and comes first.
    if (!spatial) state.plot = Math.max(0, data.plots.findIndex(({ title }) => title === "position"));
    const current = () => Flight.open(data.scenes[state.scene], data);
    const pairOf = (path) => current().pairs.find((p) => p.path === path);
    const pair = () => pairOf(state.path) ?? current().pairs[0];
    const last = () => Flight.last(current());

    const name = (s) => {
      const title = s.title.includes(s.scene) ? s.title : s.scene + (s.title ? `, ${s.title}` : "");
      return several ? `${title}, seed ${s.seed}` : title;
    };
    const group = (label, places) => {
      const made = make("optgroup", "", { label });
      made.append(...places.map((place) => make("option", name(data.scenes[place]), { value: place })));
      return made;
    };
    const all = data.scenes.map((_, place) => place);
    get("scene").replaceChildren(...(data.picked.length ? [group("Shown first", data.picked)] : []), group("All", all));

    // One column a path: both arms from above, how they ended, and the plot of the signal.
    const columns = data.paths.map(({ name: path, title }) => {
      const column = make("div", "", { class: "column", "data-path": path });
      const plan = make("div", "", { class: "plan small" }), plot = make("div", "", { class: "signal" });
      const told = Flight.arms.map((arm) => make("p", "", { class: `told ${arm}` }));
      column.append(make("h3", title), ...(spatial ? [plan] : []), ...told, plot);
      return { path, title, column, plan, told, plot };
    });
    get("across").replaceChildren(...columns.map((c) => c.column));

    let range = null;
    const redraw = () => {
      const scene = current(), shown = pair(), clock = { last: last(), dt: data.dt_s, step: state.step };
      if (spatial) {
        Draw.plan(get("plan"), `Tracks in ${scene.scene} from above`, scene, shown, state.step, data, true);
        const heights = Flight.drawn(shown).map((arm) => ({ arm, line: 0, values: Array.from(shown[arm].track[2], (v) => v / 100) }));
        const { low, high } = Flight.bounds(null, [shown]), floor = Math.min(0, Math.floor(low[2]));
        Draw.lines(get("height"), `Height over time in ${scene.scene}`, heights, [floor, Math.max(Math.ceil(high[2]), floor + 1)], clock);
      }
      for (const { path, title, plan, told, plot } of columns) {
        const here = pairOf(path);
        if (!here) continue;
        if (spatial) Draw.plan(plan, `${title}, from above. ${told.map((p) => p.textContent).join(". ")}`, scene, here, state.step, data, false);
        const lines = range ? Signals.lines(here, state.plot, data) : [];
        plot.hidden = !lines.some(({ values }) => values.some((v) => v));
        if (plot.hidden) continue;
        const goal = Signals.goal(scene, state.plot, data), { title: of, zero } = data.plots[state.plot];
        const spans = Flight.flown(here).flatMap((arm) => here[arm].struck);
        const level = goal === null ? { level: zero ? 0 : null } : { level: goal, name: "goal" };
        Draw.lines(plot, `${of}, ${title}`, lines, range, { ...clock, spans, ...level });
      }
      const wind = Flight.drawn(shown).map((arm) => Flight.wind(shown[arm], state.step))[0];
      get("wind").textContent = wind ? `Wind at the vehicle: ${Math.hypot(...wind).toFixed(1)} m/s, drawn as the way of ${Flight.ARROW_S} s.` : "";
      get("clock").textContent = `${(state.step * data.dt_s).toFixed(2)} s`;
      get("time").value = String(state.step);
    };

    const ends = (shown) => {
      const term = (label, value, cls = "") => {
        const box = make("div");
        box.append(make("dt", label, { class: cls }), make("dd", value));
        return box;
      };
      const arms = Flight.arms.map((arm) => {
        const end = shown[arm], far = end?.distance_m;
        const told = Flight.told(arm, end).slice(arm.length + 2) + (far === null || far === undefined ? "" : `, ${far.toFixed(2)} m from the goal`);
        return term(`${arm}: ${data[arm]} (${{ baseline: "dashed", repair: "solid" }[arm]})`, told, arm);
      });
      const parting = shown.parting_step === null
        ? `never more than ${data.parting_m} m`
        : `□ more than ${data.parting_m} m from ${(shown.parting_step * data.dt_s).toFixed(2)} s on`;
      get("ends").replaceChildren(...arms, ...(spatial ? [term("apart", parting)] : []));
    };

    // Offers what was recorded of a scene; a choice that it has not got is another one there.
    const signals = (scene) => {
      const has = data.plots.map((_, place) => place).filter((place) => Signals.range(scene, place, data));
      get("signals").hidden = !has.length;
      range = null;
      if (!has.length) return;
      if (!has.includes(state.plot)) state.plot = has[0];
      const label = ({ title, unit }) => (unit && unit !== "1" ? `${title} (${unit})` : title);
      get("signal").replaceChildren(...has.map((place) => make("option", label(data.plots[place]), { value: place })));
      get("signal").value = String(state.plot);
      range = Signals.range(scene, state.plot, data);
      const { lines } = data.plots[state.plot];
      get("lines").replaceChildren(...lines.map((line, n) => make("li", line, { class: `line-${Math.min(n, 3)}` })));
      get("lines").hidden = lines.length < 2;
    };

    const reset = (step) => {
      const scene = current(), shown = pair();
      state.path = shown.path;
      state.step = Math.min(Math.max(0, step ?? last()), last());
      get("time").max = String(last());
      get("scene").value = String(state.scene);
      get("name").textContent = `${scene.scene}, ${data.paths.find((p) => p.name === shown.path).title}`;
      get("why").textContent = shown.void ? `Void on the path shown: ${shown.void}.` : `${scene.why} ${words[shown.kind] ?? ""}`.trim();
      for (const button of get("paths").querySelectorAll("button")) {
        button.setAttribute("aria-pressed", String(button.dataset.path === shown.path));
        button.disabled = !pairOf(button.dataset.path);
      }
      signals(scene);
      for (const { path, column, told } of columns) {
        const here = pairOf(path);
        column.hidden = !here;
        column.classList.toggle("chosen", path === shown.path);
        Flight.arms.forEach((arm, i) => { told[i].textContent = here ? Flight.told(arm, here[arm]) : ""; });
      }
      ends(shown);
      redraw();
    };

    // The address tells what is shown, and shows what it tells.
    const tell = () => {
      const { scene, seed } = current();
      const parts = [["scene", scene], ["seed", seed], ["path", state.path], ["t", (state.step * data.dt_s).toFixed(2)]];
      history.replaceState(null, "", `#${parts.map(([key, value]) => `${key}=${encodeURIComponent(value)}`).join("&")}`);
    };
    const listen = () => {
      const asked = Object.fromEntries(new URLSearchParams(location.hash.slice(1)));
      const place = data.scenes.findIndex((s) => s.scene === asked.scene && (asked.seed === undefined || String(s.seed) === asked.seed));
      if (asked.scene === undefined || place < 0) return false;
      stop();
      state.scene = place;
      if (data.paths.some((p) => p.name === asked.path)) state.path = asked.path;
      reset(Number.isFinite(Number(asked.t ?? NaN)) ? Math.round(Number(asked.t) / data.dt_s) : undefined);
      document.getElementById("viewer").scrollIntoView({ block: "start" });
      get("play").focus({ preventScroll: true });
      return true;
    };

    const stop = () => { cancelAnimationFrame(state.playing); state.playing = 0; get("play").textContent = "Play"; };
    const show = (step) => { state.step = Math.min(Math.max(0, step), last()); redraw(); };
    const play = () => {
      let before = null, exact = state.step;
      const frame = (now) => {
        if (before !== null) exact += (now - before) / 1000 / data.dt_s;
        before = now;
        if (exact >= last()) { show(last()); stop(); tell(); return; }
        if (Math.floor(exact) !== state.step) show(Math.floor(exact));
        state.playing = requestAnimationFrame(frame);
      };
      get("play").textContent = "Pause";
      if (state.step >= last()) { exact = 0; show(0); }
      state.playing = requestAnimationFrame(frame);
    };
    const by = (steps) => () => { stop(); show(state.step + steps); tell(); };

    get("scene").addEventListener("change", (e) => { stop(); state.scene = Number(e.target.value); reset(); tell(); });
    get("paths").addEventListener("click", (e) => {
      const button = e.target.closest("button");
      if (button) { stop(); state.path = button.dataset.path; reset(state.step); tell(); }
    });
    get("signal").addEventListener("change", (e) => { state.plot = Number(e.target.value); signals(current()); redraw(); });
    get("time").addEventListener("input", (e) => { stop(); show(Number(e.target.value)); tell(); });
    get("back").addEventListener("click", by(-1));
    get("on").addEventListener("click", by(1));
    get("play").addEventListener("click", () => { if (state.playing) { stop(); tell(); } else play(); });
    addEventListener("hashchange", listen);
    // Drawn anew in the next frame, when sizes are known.
    let waiting = 0;
    addEventListener("resize", () => { cancelAnimationFrame(waiting); waiting = requestAnimationFrame(redraw); });
    addEventListener("beforeprint", redraw);
    document.getElementById("viewer").hidden = false;
    if (!listen()) reset();
    document.getElementById("viewer").dataset.ready = "";
  };

  const failed = (error) => { get("failed").hidden = false; get("failed").append(` (${error.message})`); };
  Unpacking.read(JSON.parse(document.getElementById("viewer-data").textContent).packed).then(begin).catch(failed);
}
