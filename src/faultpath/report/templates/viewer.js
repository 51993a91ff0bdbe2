// The controls of the viewer: scene, path and time, kept in the address; every change draws anew.
if (document.getElementById("viewer-data")) {
  const get = (id) => document.getElementById(`viewer-${id}`);
  const clear = (node, ...children) => { node.replaceChildren(...children); return node; };
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
    const number = (value, digits, unit) => (value === null || value === undefined ? "" : `${value.toFixed(digits)} ${unit}`);

    const name = (s) => {
      const title = s.title.includes(s.scene) ? s.title : s.scene + (s.title ? `, ${s.title}` : "");
      return several ? `${title}, seed ${s.seed}` : title;
    };
    const option = (place) => make("option", name(data.scenes[place]), { value: place });
    const group = (label, places) => {
      const made = make("optgroup", "", { label });
      made.append(...places.map(option));
      return made;
    };
    const all = data.scenes.map((_, place) => place);
    clear(get("scene"), ...(data.picked.length ? [group("Shown first", data.picked)] : []), group("All", all));

    // One column a path: a small picture for each arm, the plot of the signal, how both ended.
    const columns = data.paths.map(({ name: path, title }) => {
      const column = make("div", "", { class: "column", "data-path": path });
      const arms = Object.fromEntries(Flight.arms.map((arm) => [arm, { canvas: make("canvas", "", { role: "img" }), told: make("p", "", { class: `told ${arm}` }) }]));
      const plot = make("div", "", { class: "signal" });
      column.append(make("h3", title));
      for (const arm of Flight.arms) {
        const box = make("div", "", { class: "arm" });
        box.append(...(spatial ? [arms[arm].canvas] : []), arms[arm].told);
        column.append(box);
      }
      column.append(plot);
      return { path, title, column, arms, plot };
    });
    clear(get("across"), ...columns.map((c) => c.column));

    let range = null, bounds = null;
    const redraw = () => {
      const scene = current(), shown = pair();
      if (spatial) {
        drawPlan(get("plan"), scene, shown, state.step, data);
        drawHeight(get("height"), scene, shown, state.step, data);
      }
      for (const { path, title, arms, plot } of columns) {
        const here = pairOf(path);
        if (!here) continue;
        if (spatial) for (const arm of Flight.arms) Small.flight(arms[arm].canvas, scene, here[arm], arm, state.step, bounds);
        if (range) Small.plot(plot, `${data.plots[state.plot].title}, ${title}`, here, state.step, scene, state.plot, range, data);
      }
      const wind = Flight.drawn(shown).map((arm) => Flight.wind(shown[arm], state.step))[0];
      get("wind").textContent = wind ? `Wind at the vehicle: ${Math.hypot(...wind).toFixed(1)} m/s, drawn as the way of ${Flight.ARROW_S} s.` : "";
      get("clock").textContent = `${(state.step * data.dt_s).toFixed(2)} s`;
      get("time").value = String(state.step);
    };

    const term = (label, value, cls = "") => {
      const box = make("div");
      box.append(make("dt", label, { class: cls }), make("dd", value));
      return box;
    };
    const ends = (shown) => {
      const arms = Flight.arms.map((arm) => {
        const end = shown[arm], line = { baseline: "dashed", repair: "solid" }[arm];
        const label = `${arm}: ${data[arm]} (${line})`;
        if (!end) return term(label, "did not run", arm);
        const far = number(end.distance_m, 2, "m");
        const parts = [`${Small.signs[end.status] ?? "□"} ${end.ended}`, end.status === "failed" ? "" : number(end.time_s, 2, "s"), far && `${far} from the goal`, end.hit && `hit ${end.hit[0]}`];
        return term(label, parts.filter(Boolean).join(", "), arm);
      });
      const parting = shown.parting_step === null
        ? `never more than ${data.parting_m} m`
        : `□ more than ${data.parting_m} m from ${(shown.parting_step * data.dt_s).toFixed(2)} s on`;
      clear(get("ends"), ...arms, ...(spatial ? [term("apart", parting)] : []));
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
      if (spatial) bounds = Flight.bounds(scene);
      signals(scene);
      for (const { path, title, column, arms } of columns) {
        const here = pairOf(path);
        column.hidden = !here;
        column.classList.toggle("chosen", path === shown.path);
        for (const arm of Flight.arms) {
          const told = here ? Small.told(arm, here[arm]) : "";
          arms[arm].told.textContent = told;
          arms[arm].canvas.setAttribute("aria-label", `${title}, from above. ${told}`);
        }
      }
      ends(shown);
      redraw();
    };

    // Offers what was recorded of a scene; a choice that it has not got is another one there.
    const signals = (scene) => {
      const has = data.plots.map((_, place) => place).filter((place) => Small.range(scene, place, data));
      get("signals").hidden = !has.length;
      for (const { plot } of columns) { plot.replaceChildren(); plot.hidden = !has.length; }
      if (!has.length) { range = null; return; }
      if (!has.includes(state.plot)) state.plot = has[0];
      clear(get("signal"), ...has.map((place) => make("option", label(data.plots[place]), { value: place })));
      get("signal").value = String(state.plot);
      range = Small.range(scene, state.plot, data);
      const { lines } = data.plots[state.plot];
      clear(get("lines"), ...lines.map((line, n) => make("li", line, { class: `line-${Math.min(n, 3)}` })));
      get("lines").hidden = lines.length < 2;
    };
    const label = ({ title, unit }) => (unit && unit !== "1" ? `${title} (${unit})` : title);

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
        if (before !== null) exact += ((now - before) / 1000 / data.dt_s);
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
    // A picture that waits for a resize or for a change of colours is drawn in the next frame.
    let waiting = 0;
    const soon = () => { cancelAnimationFrame(waiting); waiting = requestAnimationFrame(redraw); };
    addEventListener("resize", soon);
    addEventListener("beforeprint", redraw);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", soon);
    document.getElementById("viewer").hidden = false;
    if (!listen()) reset();
    document.getElementById("viewer").dataset.ready = "";
  };

  const failed = (error) => { get("failed").hidden = false; get("failed").append(` (${error.message})`); };
  Unpacking.read(JSON.parse(document.getElementById("viewer-data").textContent).packed).then(begin).catch(failed);
}
